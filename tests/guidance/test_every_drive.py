"""Path following by boats of every kind of drive and of several sizes."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import KINDS, Kind
from swamp_rl.guidance.drive import drive_of
from swamp_rl.guidance.following import PathFollower
from swamp_rl.guidance.line_of_sight import Waypoint, offset
from swamp_rl.guidance.loop import drive
from swamp_rl.guidance.servo import BANDWIDTH, servo_of
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import EAST, NORTH
from tests.support.new_boats import new_boat

pytestmark = pytest.mark.numerical


def followed(boat: Boat, lengths: float) -> list[float]:
    """Distances [lengths] from a line at whose side the boat begins, once it has come so many lengths."""
    speed, size = 0.5 * reference_of(boat).speed, boat.length
    start, end = Waypoint(0.0, 0.0), Waypoint(100.0 * size, 50.0 * size)
    follower = PathFollower(drive_of(boat), servo_of(boat), [start, end], speed, size)
    track = drive(boat, follower, (0.0, 2.0 * size, 0.0), 1.3 * lengths * size / speed)
    places = [offset(Waypoint(*row), start, end) for row in track[:, [NORTH, EAST]]]
    return [abs(place.across) / size for place in places if place.along > 0.8 * lengths * size]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("length", [0.3, 5.0])
def test_a_boat_of_any_kind_comes_onto_its_line_and_stays(tmp_path: Path, kind: Kind, length: float) -> None:
    away = followed(new_boat(tmp_path, kind, length), 40.0)
    assert away and max(away) < 0.7


def test_a_tanker_comes_onto_its_line_by_its_rudder() -> None:
    away = followed(load_boat("esso_osaka"), 40.0)
    assert away and max(away) < 0.5


def test_the_bandwidth_of_a_large_boat_is_lower_by_froudes_law(tmp_path: Path) -> None:
    large = servo_of(new_boat(tmp_path, "azimuth", 4.0 * 1.24))
    assert large.bandwidth == pytest.approx(np.array(BANDWIDTH) / 2.0)
    assert servo_of(load_boat("swamp")).bandwidth.tolist() == list(BANDWIDTH)
    assert large.bandwidth_at(0.1) == pytest.approx(large.bandwidth)
    assert large.bandwidth_at(4.0)[2] == pytest.approx(2.0 * large.bandwidth_at(2.0)[2])
    assert math.isfinite(float(large.inertia.min()))
