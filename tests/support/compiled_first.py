"""What nearly every test runs, compiled by one process before the others need it."""

import gymnasium
import numpy as np

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.simulator.reference import reference_of
from tests.support.criticism import simulated_runs


def compile_first() -> None:
    """Compile one boat's step, its environment and its windows: 14 s of processor time in a new checkout."""
    reference_of(load_boat("swamp"))
    boats = gymnasium.make_vec("swamp/Gates-v1", num_envs=2, vectorization_mode="vector_entry_point")
    boats.reset(seed=0)
    boats.step(boats.action_space.sample())
    runs = simulated_runs([])
    problem = Shooting(runs, weights(runs, noise_levels(runs)), 5.0)
    problem.track(Hypothesis(), np.zeros(0), problem.initial_states())
