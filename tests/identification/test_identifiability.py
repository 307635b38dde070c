"""`identify` refuses, number by number, what the runs do not show, and says what to record."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from swamp_rl.boat import load_boat
from swamp_rl.identification.deduction import Point, point_doubt
from swamp_rl.identification.elementary import identify_surge, identify_yaw, surge_doubts, yaw_doubts
from swamp_rl.identification.estimate import Estimate, blocks_of, pseudo_inverse, with_intervals
from swamp_rl.identification.identifiability import doubt, doubts, roughness
from swamp_rl.identification.motion import motion_of
from swamp_rl.identification.simulated import ahead_by_steps, on_the_spot, record_run, straights, zigzag
from swamp_rl.identification.yaw_model import PUBLISHED, by_pseudo_inverse, regressors, yaw_model_doubts
from swamp_rl.runs import Run
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture
from tests.support.identification import NOISY, QUIET, folder_of, own_motion

pytestmark = pytest.mark.numerical

Array = NDArray[np.float64]

BOAT = load_boat("swamp-thesis")
NAMES = ("a", "b")
TIME = np.arange(2000) * 0.1
SLOW, FAST = np.sin(0.3 * TIME), np.sin(1.1 * TIME)


def judged(X: Array, y: Array) -> list[str | None]:
    """The doubts about a regression of two parameters on one run."""
    found = with_intervals(X, y, blocks_of([len(y)], 50), pseudo_inverse, ("1", "1"))
    return doubts(X, found, [len(y)], NAMES)


def recorded(rows: Array, noise: Array = QUIET, name: str = "run") -> Run:
    """A run of SWAMP under commands (T, 8) at 10 Hz."""
    return record_run(BOAT, rows, 0.1, noise, np.random.default_rng(0), name)


def circle() -> Array:
    """(T, 8) commands of one circle of two minutes, 20 deg at 60 %."""
    rows = zigzag(BOAT, 0.1, 0.35)
    rows[:, :4] = np.abs(rows[:, :4]) * np.sign(rows[0, :4])
    return rows


def test_white_noise_has_a_roughness_of_one_and_a_slow_motion_of_none() -> None:
    noise = np.random.default_rng(0).standard_normal(20_000)
    assert roughness(noise, [10_000, 10_000]) == pytest.approx(1.0, abs=0.05)
    assert roughness(SLOW, [len(SLOW)]) < 1e-4
    assert roughness(np.repeat([1.0, -1.0], 500), [500, 500]) == 0.0  # the step between two runs is none


def test_two_motions_of_their_own_determine_both_parameters() -> None:
    noise = 0.1 * np.random.default_rng(0).standard_normal(len(TIME))
    assert judged(np.column_stack([SLOW, FAST]), 2.0 * SLOW - 3.0 * FAST + noise) == [None, None]


def test_a_regressor_that_follows_another_determines_neither() -> None:
    first, second = judged(np.column_stack([SLOW, 2.0 * SLOW]), SLOW)
    assert first == "its regressor varies with that of b alone"
    assert second == "its regressor varies with that of a alone"


def test_a_regressor_that_is_noise_is_refused_and_the_other_is_not() -> None:
    noise = 0.1 * np.random.default_rng(0).standard_normal(len(TIME))
    assert judged(np.column_stack([SLOW, noise]), 2.0 * SLOW + noise) == [
        None,
        "its regressor, less what the others explain, is noise",
    ]
    assert judged(np.column_stack([SLOW, 0.0 * SLOW]), SLOW)[1] == "its regressor is zero throughout"


def test_an_interval_beyond_half_of_its_value_is_refused() -> None:
    assert doubt(Estimate(2.0, 1.1, 2.9, "1")) is None
    assert doubt(Estimate(-2.0, -2.9, -1.1, "1")) is None
    assert doubt(Estimate(29.2, 5e-12, 29.5, "kg m2")) is not None
    assert doubt(Estimate(0.0, -0.1, 0.1, "1")) is not None


def test_elementary_motions_determine_mass_and_drag() -> None:
    ahead, spot = (motion_of(recorded(rows(BOAT, 0.1)), BOAT) for rows in (ahead_by_steps, on_the_spot))
    assert surge_doubts(ahead, identify_surge(ahead, BOAT)) == [None, None]
    assert yaw_doubts(spot, identify_yaw(spot, BOAT)) == [None, None]


def test_a_mass_that_noise_has_shrunk_is_refused_and_the_drag_is_not() -> None:
    motion = motion_of(recorded(ahead_by_steps(BOAT, 0.1), NOISY), BOAT)
    mass, drag = surge_doubts(motion, identify_surge(motion, BOAT))
    assert mass is not None
    assert drag is None


def test_a_zig_zag_at_changing_speed_determines_the_yaw_models_damping_and_steering() -> None:
    motion = own_motion(0.01)
    k_r, c_ru, _, b_r = yaw_model_doubts(motion, by_pseudo_inverse(motion, PUBLISHED.inertia)[1])
    assert (k_r, c_ru, b_r) == (None, None, None)


def test_a_steady_circle_determines_nothing_of_the_yaw_model() -> None:
    """All of its rows are alike, so the intervals have no width."""
    motion = own_motion(0.0)
    rate = PUBLISHED.steady_rate(0.35, 0.8)
    same = np.ones((3000, 1))
    steady = motion._replace(velocity=same * [0.8, 0.05, rate], derivative=0.0 * motion.velocity)
    steady = steady._replace(steering=np.full(3000, 0.35))
    X = regressors(steady)
    blocks = blocks_of([3000], 250)
    found = with_intervals(X, 0.0 * same[:, 0], blocks, pseudo_inverse, ("1",) * 4)
    assert all(why is not None for why in yaw_model_doubts(steady, found))


def test_straight_trials_show_surge_and_refuse_yaw(call: Call) -> None:
    words = ["--throttle", "0.3", "--throttle", "0.8", "--duration", "5"]
    assert call("trial", "straight", *words, "--boat", "swamp-light", "--out", "runs")[0] == 0
    code, out, error = call("identify", "elementary", "runs")
    assert (code, error) == (0, "")
    lines = out.splitlines()
    assert any(line.startswith("surge drag") and "95 %" in line for line in lines)
    assert [line for line in lines if line.startswith("yaw")] == [
        line for line in lines if "not identifiable" in line and "record turns on the spot" in line
    ]


@pytest.mark.parametrize("noise", [QUIET, NOISY], ids=["clean", "noisy"])
@pytest.mark.parametrize(
    ("verb", "rows", "parts"),
    [
        (
            "elementary",
            np.zeros((600, 8)),
            ["nothing can be identified", "record runs straight ahead", "turns on the spot"],
        ),
        ("yaw-model", np.zeros((600, 8)), ["no steering", "0.0 deg", "record zig-zags"]),
        ("thrust-deduction", np.zeros((600, 8)), ["no straight run", "record straight runs"]),
        (
            "elementary",
            circle(),
            ["nothing can be identified", "record runs straight ahead", "turns on the spot"],
        ),
        ("yaw-model", circle(), ["no steering", "20.1 deg", "record zig-zags"]),
        ("thrust-deduction", circle(), ["no straight run"]),
        ("yaw-model", straights(BOAT, 0.1, (0.4, 0.8), True), ["no steering", "record zig-zags"]),
        ("yaw-model", zigzag(BOAT, 0.1, 0.35, seconds=9.0), ["shorter than", "10 s"]),
    ],
)
def test_runs_that_show_nothing_are_refused_in_one_line(
    call: Call, tmp_path: Path, noise: Array, verb: str, rows: Array, parts: list[str]
) -> None:
    folder = folder_of(tmp_path / "runs", BOAT, [recorded(rows, noise)])
    assert_complains(call("identify", verb, folder), str(folder), *parts)


def test_a_thrust_deduction_is_refused_outside_the_resistance_and_against_the_jets() -> None:
    point = Point(0.7, True, 1.0, 30.0, 0.6, 0.59, 0.61)
    assert point_doubt(point, BOAT) is None
    assert "known up to 1.74 m/s" in str(point_doubt(point._replace(speed=1.9), BOAT))
    assert "against its jets" in str(point_doubt(point._replace(speed=-0.1), BOAT))
    assert "95 % interval" in str(point_doubt(point._replace(low=0.2), BOAT))
    assert point_doubt(point._replace(ahead=False, speed=-1.0), BOAT) is None


def test_one_direction_alone_gets_a_note_on_the_current(call: Call, tmp_path: Path) -> None:
    ahead, astern = (recorded(straights(BOAT, 0.1, (0.6,), way), name=f"r{way}") for way in (True, False))
    one = call("identify", "thrust-deduction", folder_of(tmp_path / "one", BOAT, [ahead]))
    both = call("identify", "thrust-deduction", folder_of(tmp_path / "both", BOAT, [ahead, astern]))
    assert "note: a current along the course" in one[1]
    assert "note" not in both[1]
    assert math.isclose(float(one[1].split("1 - t = ")[1][:5]), float(both[1].split("1 - t = ")[1][:5]))
