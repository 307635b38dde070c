"""Allocation to propellers with rudders, against the forces of the simulator."""

import numpy as np
import pytest

from swamp_rl.allocation import propellers_of
from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.physics.propulsion import propeller_with_rudder
from swamp_rl.simulator import parameters

OSAKA = load_boat("esso_osaka")
RECORD = parameters(OSAKA)[0]


@pytest.mark.parametrize("speed", [0.0, 0.3, 0.6, -0.2])
@pytest.mark.parametrize("angle", [-0.5, 0.0, 0.2])
@pytest.mark.parametrize("revolutions", [8.0, 14.0])
def test_the_commands_that_made_a_force_are_found_again(
    speed: float, angle: float, revolutions: float
) -> None:
    velocity = np.array([speed, 0.02, -0.01])
    made = np.array(propeller_with_rudder(angle, revolutions, *velocity, 0, RECORD))
    found = propellers_of(OSAKA).allocate(made, velocity, np.zeros(1))
    assert found.attainable
    assert found.achieved[[0, 2]] == pytest.approx(made[[0, 2]], abs=1e-6)
    again = propeller_with_rudder(found.azimuth[0], found.throttle[0], *velocity, 0, RECORD)
    assert again == pytest.approx(found.achieved)


def test_more_than_it_has_is_answered_by_its_most() -> None:
    found = propellers_of(OSAKA).allocate(np.array([1e3, 0.0, 0.0]), np.zeros(3), np.zeros(1))
    assert not found.attainable
    assert found.throttle[0] == pytest.approx(OSAKA.thrusters[0].throttle_max)
    hard = propellers_of(OSAKA).allocate(np.array([2.0, 0.0, 1e3]), np.array([0.5, 0.0, 0.0]), np.zeros(1))
    assert hard.azimuth[0] == pytest.approx(RECORD["azimuth_max"][0])


def test_astern_is_asked_for_by_revolutions_astern() -> None:
    found = propellers_of(OSAKA).allocate(np.array([-0.8, 0.0, 0.0]), np.zeros(3), np.zeros(1))
    assert found.throttle[0] < 0.0
    assert found.achieved[0] == pytest.approx(-0.8, abs=1e-6)


def test_the_rudder_goes_no_farther_than_its_rate_allows() -> None:
    wanted, velocity = np.array([2.0, 0.0, 1e3]), np.array([0.5, 0.0, 0.0])
    found = propellers_of(OSAKA).allocate(wanted, velocity, np.array([0.1]), step=0.5)
    assert found.azimuth[0] == pytest.approx(0.1 + 0.5 * RECORD["azimuth_rate"][0])


def test_a_boat_with_jets_is_refused() -> None:
    with pytest.raises(UserError, match=r"swamp: thrusters\.bs is not a propeller with a rudder"):
        propellers_of(load_boat("swamp"))
