"""Forces that lead a wrong model along what was measured."""

import itertools

import numpy as np

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.force_fit import fit_forces
from swamp_rl.criticism.likelihood.force_sensitivity import force_grid
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options

DT, ROWS = 0.1, 135
SIGMAS = np.array([0.009, 0.005, 0.001, 0.02, 0.056, 1e-4])


def steady(velocities: np.ndarray) -> np.ndarray:
    """(ROWS, 6) of a ship of constant surge, sway [m/s] and yaw rate [rad/s]."""
    surge, sway, rate = velocities
    heading = 0.9 + rate * DT * np.arange(ROWS)
    north = np.cumsum(surge * np.cos(heading) - sway * np.sin(heading)) * DT
    east = np.cumsum(surge * np.sin(heading) + sway * np.cos(heading)) * DT
    return np.column_stack([north, east, heading, np.tile(velocities, (ROWS, 1))])


def test_forces_follow_a_ship_that_backs_slowly_whatever_her_propeller_and_rudder_do() -> None:
    # beside no force, the likeliest initial state of some of these goes ahead
    rng, ship = np.random.default_rng(0), load_boat("esso_osaka")
    commands = ([0.0, 10.0], [0.0, 0.0], [-0.6, 10.0], [0.0, -10.0])
    motions = ([-0.037, 0.04, -0.012], [-0.04, 0.035, -0.005])
    for command, velocities in itertools.product(commands, motions):
        track = steady(np.array(velocities)) + SIGMAS * rng.standard_normal((ROWS, 6))
        runs = RunSet(ship, DT, ["slow"], np.tile(command, (1, ROWS, 1)), track[None], np.array([ROWS]))
        problem = Shooting(runs, np.broadcast_to(1.0 / SIGMAS, (1, ROWS, 6)).copy(), 10.0, before=DT)
        found = fit_forces(
            problem, Hypothesis(), np.zeros(0), force_grid(problem, 2.5), options().regression_reach
        )
        assert (problem.residuals(found.track) ** 2).mean() < 1.3
