"""Forces out of reach of a boat whose thrusters give thousands of newtons."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.allocation import Wish, allocate, jets_of
from tests.support.new_boats import new_boat

pytestmark = pytest.mark.numerical


@pytest.mark.parametrize("moment", [1.0, 5.0, 10.0])
@pytest.mark.parametrize("times", [1.5, 5.0, 20.0])
def test_no_full_thrust_of_a_large_boat_comes_nearer_to_a_force_out_of_reach(
    tmp_path: Path, times: float, moment: float
) -> None:
    jets = jets_of(new_boat(tmp_path, "four-azimuths", 20.0))
    thrust = float(jets.thrust_max.sum())
    weight = np.array([1.0, 1.0, moment / jets.lever])
    wanted = times * thrust * np.array([1.0, 0.0, 0.05 * jets.lever])
    found = allocate(jets, wanted, wish=Wish(moment=moment))
    angles = np.random.default_rng(1).uniform(-1.0, 1.0, (20000, len(jets.names)))
    forces = np.stack([np.cos(angles), np.sin(angles)], axis=2) * jets.thrust_max[:, None]
    tried = wanted - forces.reshape(len(angles), -1) @ jets.geometry.T
    nearest = np.linalg.norm(tried * weight, axis=1).min()
    assert np.linalg.norm((wanted - found.achieved) * weight) <= nearest * (1.0 + 1e-6)
