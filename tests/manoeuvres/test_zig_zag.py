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
