"""Paper 003's identification on a twin whose numbers are known."""

import numpy as np
import pytest

from swamp_rl.identification.square_twin import Vehicle, load_vehicle, moved, sail
from swamp_rl.identification.waypoint_square import identify, replay, track_error

TYPHOON = load_vehicle("typhoon")


def changed(**numbers: float) -> Vehicle:
    return TYPHOON.model_copy(update=numbers)


def test_a_steady_force_reaches_the_speed_at_which_the_drag_equals_it() -> None:
    pose, velocity = np.zeros(4), np.zeros(3)
    for _ in range(600):
        moved(pose, velocity, np.array([40.0, 0.0, 40.0]), TYPHOON.masses, TYPHOON.drags, 0.0)
    assert velocity[0] == pytest.approx((40.0 / 58.7) ** 0.5, rel=1e-3)
    assert velocity[2] == pytest.approx((40.0 / 1830.0) ** 0.5, rel=1e-3)


def test_the_square_comes_back_near_its_start_after_four_sides() -> None:
    log = sail(changed(current=0.0), 0)
    assert log.length == pytest.approx(4 * 16.0 + 2 * 3.0, abs=1.5)
    assert np.hypot(*log.pose[-1, :2]) < 1.5
    assert log.pose[:, 2].max() == pytest.approx(3.0, abs=0.3)


def test_table_i_comes_back_and_the_replay_stays_within_the_printed_error() -> None:
    log = sail(TYPHOON, 1)
    found = identify(TYPHOON, log)
    for one, mass, drag in zip(found, (180.0, 180.0, 279.0), (58.7, 1230.0, 1830.0), strict=True):
        assert one.shown and one.estimates is not None
        assert one.estimates[0].value == pytest.approx(mass, rel=0.1)
        assert one.estimates[1].value == pytest.approx(drag, rel=0.05)
    assert track_error(log, replay(TYPHOON, log, found)).mean() <= 1.2


def test_without_noise_and_error_the_replay_is_exact_to_decimetres() -> None:
    clean = changed(current=0.0, thrust_error=0.0, velocity_noise=0.0, yaw_rate_noise=0.0)
    log = sail(clean, 0)
    assert track_error(log, replay(clean, log, identify(clean, log))).max() < 0.6


def test_a_square_that_does_not_dive_cannot_show_the_heave() -> None:
    flat = changed(depth=0.0)
    surge, heave, yaw = identify(flat, sail(flat, 0))
    assert surge.shown and yaw.shown
    assert not heave.shown
    assert heave.estimates is None
    assert all(
        why is not None and why.startswith("no elementary heave motion: 0 rows") for why in heave.doubts
    )


def test_noise_that_hides_the_acceleration_is_said_to() -> None:
    loud = changed(velocity_noise=0.5)
    assert any(not one.shown for one in identify(loud, sail(loud, 0))[:2])


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"surge_force": 1e-300}, "surge: force and drag give"),
        ({"yaw_drag": 1e-9}, "yaw: force and drag give"),
        ({"heave_mass": 1e-6}, "heave: gathers speed within"),
        ({"side": 1000.0, "surge_force": 0.1}, "side: may take"),
    ],
)
def test_a_vehicle_that_no_square_ends_with_is_refused(numbers: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Vehicle.model_validate(TYPHOON.model_dump() | numbers)
