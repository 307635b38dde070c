"""The wind on a real pond, named by the diagnosis of a model ship's motion and held against an anemometer."""

import math

import numpy as np
import pytest

from benchmarks.esso_osaka.diagnosis import Diagnosed, diagnosed, measured_wind
from benchmarks.esso_osaka.pond import BOAT, DATA, pond
from benchmarks.esso_osaka.sway import errors, sway_scales, with_sway_drag
from benchmarks.esso_osaka.wind import anemometer, apart, named
from swamp_rl.constants import Z95
from swamp_rl.runs import Run

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("pond")]  # what they share is made once

on_the_pond = pytest.mark.skipif(not DATA.is_dir(), reason="the pond data are not beside this checkout")
BEGINNING = 100.0  # s of each run; whole runs take six times as long to diagnose
HELD = 0.9  # share of the intervals that hold the anemometer's value


@pytest.fixture(scope="module")
def pond_result() -> Diagnosed:
    """What is diagnosed from the beginnings of a day's runs."""
    names = sorted(path.name for path in (DATA / "random").glob("*_06-Aug-2020_*.csv"))
    return diagnosed(BOAT, [beginning(pond(f"random/{name}")) for name in names])


@on_the_pond
def test_the_wind_is_among_what_is_named_and_blows_as_the_anemometer_says(pond_result: Diagnosed) -> None:
    assert len(pond_result.runs) == 5
    assert pond_result.speed is not None and pond_result.angle is not None
    speed, angle = measured_wind(pond_result.runs)
    # within the worst of nine runs that an independent program was given one by one
    assert abs(apart(pond_result.angle.value, angle)) < 30.0  # degrees
    assert 0.63 < pond_result.speed.value / speed < 1.38
    # much of the ship's motion stays unexplained, and the verdict is so
    assert pond_result.diagnosis.verdict == "unexplained"


@on_the_pond
def test_the_winds_of_each_run_have_intervals_that_hold_the_anemometer(pond_result: Diagnosed) -> None:
    (wind,) = (cause for cause in pond_result.diagnosis.causes if cause.effect == "wind")
    assert wind.scope == "run"
    held = []
    for run in pond_result.runs:
        speed, angle = anemometer(run)
        numbers = wind.groups[run.name]
        held.append(abs(numbers["speed"].value - speed) < Z95 * numbers["speed"].standard_error)
        away = math.remainder(numbers["from"].value - angle, 2.0 * math.pi)
        held.append(abs(away) < Z95 * numbers["from"].standard_error)
    assert np.mean(held) >= HELD


@on_the_pond
def test_circles_of_other_months_come_out_nearer_with_the_sway_drag_that_a_random_run_tells() -> None:
    diagnosed_run = named(BOAT, pond("random/random_06-Aug-2020_16_24_25_5.csv"))
    (scale,) = sway_scales([diagnosed_run])
    assert 0.3 < scale < 0.8
    circles = [pond(f"turning/{path.name}") for path in sorted((DATA / "turning").glob("*.csv"))]
    assert len(circles) == 7
    before, after = (errors(boat, circles) for boat in (BOAT, with_sway_drag(BOAT, scale)))
    for figure in ("tactical diameter", "speed", "drift angle", "yaw rate"):
        assert np.median(np.abs(after[figure])) < 0.75 * np.median(np.abs(before[figure])), figure


def beginning(run: Run) -> Run:
    """The run's first part, beginning with its first sample."""
    kept = run.time < run.time[0] + BEGINNING
    return Run(run.name, {name: np.asarray(values)[kept] for name, values in run.columns.items()}, run.meta)
