"""Positions that were imported in degrees."""

import numpy as np
import pytest

from swamp_rl.boat import Boat
from swamp_rl.runs import Run
from tests.support.doctored import faults

METRES_PER_DEGREE = 111_195.0


def in_degrees(run: Run, latitude: float, longitude: float) -> dict[str, np.ndarray]:
    """The positions of a run about a place on a sphere of 6371 km."""
    shorter = METRES_PER_DEGREE * np.cos(np.radians(latitude))
    north, east = run.columns["north"] / METRES_PER_DEGREE, run.columns["east"] / shorter
    return {"north": latitude + north, "east": longitude + east}


@pytest.mark.parametrize("place", [(44.35, 9.15), (-33.9, 151.2), (25.65, -100.29)])
def test_latitude_and_longitude_as_north_and_east_are_named_and_nothing_else(
    sound: list[Run], twin: Boat, place: tuple[float, float]
) -> None:
    (found,) = faults([Run(run.name, run.columns | in_degrees(run, *place)) for run in sound], twin)
    assert (found.code, found.columns) == ("unit", ("north", "east"))
    assert "as latitude and longitude" in found.advice


def test_a_run_without_positions_or_at_rest_hides_the_degrees_of_no_other(
    sound: list[Run], twin: Boat
) -> None:
    moving = [Run(run.name, run.columns | in_degrees(run, 44.35, 9.15)) for run in sound]
    rows = len(sound[0].time)
    others = [
        Run(name, moving[0].columns | {"north": np.full(rows, north), "east": np.full(rows, 9.15)})
        for name, north in (("lost", np.nan), ("still", 44.35))
    ]
    assert "unit" in [one.code for one in faults([*moving, *others], twin)]


def test_longitude_as_north_is_told_by_its_size(sound: list[Run], twin: Boat) -> None:
    places = [(run, in_degrees(run, 25.65, -100.29)) for run in sound]
    turned = [Run(run.name, run.columns | {"north": at["east"], "east": at["north"]}) for run, at in places]
    found = next(one for one in faults(turned, twin) if one.code == "unit")
    assert "map them as longitude and latitude" in found.advice


def test_a_boat_that_is_made_fast_far_from_the_origin_is_not_in_degrees(twin: Boat) -> None:
    rng, time = np.random.default_rng(3), 0.1 * np.arange(601)
    columns = {name: 40.0 + 0.02 * rng.standard_normal(601) for name in ("north", "east")}
    throttles = {f"throttle_{side}": np.zeros(601) for side in ("port", "starboard")}
    moored = Run("moored", columns | throttles | {"time": time, "heading": 0.01 * rng.standard_normal(601)})
    assert "unit" not in [one.code for one in faults([moored], twin)]
