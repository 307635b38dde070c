"""The figures of a zig-zag are those of Nomoto's model in closed form, found from the commands alone."""

import math

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.imo import first_overshoot_limit, second_overshoot_limit
from swamp_rl.runs import Run, RunMeta
from tests.support.trial_runs import commanded, nomoto_first_overshoot, nomoto_zig_zag

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")


@pytest.mark.parametrize(("gain", "lag"), [(0.8, 1.5), (0.5, 4.0), (1.2, 0.7)])
def test_the_first_overshoot_is_that_of_nomotos_model(gain: float, lag: float) -> None:
    angle = math.radians(20.0)
    result = analyse_run(nomoto_zig_zag(gain, lag, angle, angle), BOAT)
    expected = math.degrees(nomoto_first_overshoot(gain, lag, angle, angle))
    # The second execute comes up to a sample late, with the yaw rate of that moment.
    late = math.degrees(gain * angle) * 0.05
    assert result.figures["first_overshoot"].value == pytest.approx(expected, abs=late)
    assert len(result.figures["overshoot"].each) == 5
    assert "none" in result.verdicts["bias"]


def test_initial_turning_is_the_way_sailed_to_ten_degrees() -> None:
    gain, lag, angle = 0.8, 1.5, math.radians(10.0)
    result = analyse_run(nomoto_zig_zag(gain, lag, angle, angle), BOAT)
    time = np.linspace(0.0, 20.0, 200_001)
    heading = gain * angle * (time - lag * (1.0 - np.exp(-time / lag)))
    expected = time[np.argmax(heading >= math.radians(10.0))]  # at 1 m/s
    assert result.figures["initial_turning"].value == pytest.approx(expected, abs=0.06)
    assert {c.name for c in result.criteria} == {
        *("initial turning", "first overshoot 10/10", "second overshoot 10/10")
    }


def test_mirrored_zig_zags_have_the_same_overshoots() -> None:
    run = nomoto_zig_zag(0.8, 1.5, 0.35, 0.35)
    flipped = ("heading", "east", *(name for name in run.columns if name.startswith("azimuth")))
    mirrored = Run("m", {name: -v if name in flipped else v for name, v in run.columns.items()})
    one, other = analyse_run(run, BOAT), analyse_run(mirrored, BOAT)
    assert other.figures["overshoot"].each == pytest.approx(one.figures["overshoot"].each, abs=1e-9)
    assert other.figures["overshoot_port"].each == pytest.approx(
        one.figures["overshoot_starboard"].each, abs=1e-9
    )


def with_rate(run: Run, rate: float, noise: float, seed: int = 0) -> Run:
    """The run with the steering of a servo of that rate [rad/s] in place of the orders; its motion stays."""
    rng, columns = np.random.default_rng(seed), dict(run.columns)
    for name in [one for one in columns if one.startswith("azimuth")]:
        ordered, angle = columns[name], np.zeros(len(columns[name]))
        for row in range(1, len(angle)):
            step = rate * (run.time[row] - run.time[row - 1])
            angle[row] = angle[row - 1] + np.clip(ordered[row] - angle[row - 1], -step, step)
        columns[name] = angle + noise * rng.standard_normal(len(angle))
    return Run(run.name, columns, run.meta)


@pytest.mark.parametrize("rate", [0.15, 0.3, 2.0])
def test_overshoots_are_the_same_where_the_steering_was_recorded_in_place_of_the_order(rate: float) -> None:
    run = nomoto_zig_zag(0.8, 1.5, 0.35, 0.35)
    ordered = analyse_run(run, BOAT).figures
    late = 0.1  # s, two samples, by which an execute may be found too early or too late
    errors = {"first_overshoot": math.degrees(0.8 * 0.35), "second_overshoot": math.degrees(0.8 * 0.35)}
    errors |= {"period": 2.0, "initial_turning": 1.0}  # a second, at 1 m/s and at the highest yaw rate
    for seed in range(3):
        measured = analyse_run(with_rate(run, rate, 0.002, seed), BOAT).figures
        for name, error in errors.items():
            assert measured[name].value == pytest.approx(ordered[name].value, abs=late * error + 1e-3), name


@pytest.mark.parametrize("executes", [3, 4, 5])
def test_a_zig_zag_of_three_executes_is_one(executes: int) -> None:
    run = nomoto_zig_zag(0.8, 1.5, 0.35, 0.35)
    changes = np.flatnonzero(np.diff(np.sign(run.columns["azimuth_bs"])) != 0.0)
    end = int(changes[executes]) if executes < len(changes) else len(run.time)
    short = Run("short", {name: values[:end] for name, values in run.columns.items()}, run.meta)
    assert len(analyse_run(short, BOAT).figures["overshoot"].each) >= executes - 2


def test_the_limits_of_msc_137_76_have_their_ends_and_middle() -> None:
    assert [first_overshoot_limit(t) for t in (5.0, 10.0, 20.0, 30.0, 50.0)] == [10, 10, 15, 20, 20]
    assert [second_overshoot_limit(t) for t in (5.0, 10.0, 20.0, 30.0, 50.0)] == [25, 25, 32.5, 40, 40]


def test_a_run_without_a_manoeuvre_is_refused_in_one_line() -> None:
    time = np.arange(100) * 0.1
    still = {name: np.zeros(100) for name in ("north", "east", "heading")}
    run = Run("idle", {"time": time, **still, **commanded(np.zeros(100))})
    with pytest.raises(UserError, match="idle: no turning circle or zig-zag found"):
        analyse_run(run, BOAT)


def test_a_run_whose_manoeuvre_is_unknown_names_the_known_ones() -> None:
    run = nomoto_zig_zag(0.8, 1.5, 0.35, 0.35)
    odd_run = Run("odd", run.columns, run.meta.model_copy(update={"manoeuvre": "waltz"}))
    with pytest.raises(UserError, match="'waltz' is none of turning-circle, zig-zag"):
        analyse_run(odd_run, BOAT)


def test_marks_without_an_angle_are_refused_in_one_line() -> None:
    run = nomoto_zig_zag(0.8, 1.5, 0.35, 0.35)
    entries = {"manoeuvre": "zig-zag", "marks": [{"time": 1.0, "phase": "execute"}]}
    with pytest.raises(UserError, match="odd: marks of a zig-zag need the angle"):
        analyse_run(Run("odd", run.columns, RunMeta.model_validate(entries)), BOAT)


def test_marks_that_are_none_are_refused_in_one_line() -> None:
    run = nomoto_zig_zag(0.8, 1.5, 0.35, 0.35)
    entries = {"manoeuvre": "zig-zag", "marks": [{"at": 1.0}]}
    with pytest.raises(UserError, match="odd: marks must be mappings with time"):
        analyse_run(Run("odd", run.columns, RunMeta.model_validate(entries)), BOAT)
