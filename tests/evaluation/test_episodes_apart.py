"""An episode is the same whatever is driven beside it, and boats that have ended are let go."""

import copy

import numpy as np
import pytest
from hypothesis import given, settings, strategies
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.boat import load_boat
from swamp_rl.evaluation import drive, episode_table
from swamp_rl.evaluation.rollout import WORTH_DROPPING
from swamp_rl.pilots import Pilot
from swamp_rl.pilots.arrays import Array, times
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.takeover import TakeoverPilot
from tests.support.random_pilots import gru, network, reservoir

SEEDS = np.arange(700, 740)
ENDS = ("success", "buoy", "out_of_bounds", "timeout")
BOAT = load_boat("swamp")


def pilots() -> dict[str, Pilot]:
    """One of every kind, and of those that hold, remember or take over; widths as they are learned with."""
    rng = np.random.default_rng(0)
    return {
        "scripted": ScriptedPilot(3),
        "reservoir": reservoir(rng, 200),
        "cloning": network(rng, hidden=64),
        "remembering ppo": network(rng, hold=5, memory=3, hidden=64),
        "gru": gru(rng, 32),
        "takeover": TakeoverPilot(ScriptedPilot(5), reservoir(rng), 3.0),
    }


class Some:
    """A pilot of many boats that is given those of some places only; counts how often it is asked."""

    def __init__(self, pilot: Pilot, places: Array) -> None:
        self.pilot, self.places, self.asked = pilot, places, 0
        self.senses = pilot.senses

    def reset(self, n: int) -> None:
        assert n == len(self.places)
        self.pilot.reset(len(SEEDS))
        self.pilot.keep(self.places)

    def keep(self, boats: Array) -> None:
        self.pilot.keep(boats)

    def act(self, observation: Array) -> Array:
        self.asked += len(observation)
        return self.pilot.act(observation)


def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
    return GatesVectorEnv(n, disturbances="standard", observation=senses)


@pytest.mark.parametrize("name", pilots())
def test_an_episode_has_the_same_bits_alone_among_few_and_among_all(name: str) -> None:
    pilot = pilots()[name]
    everyone = Some(pilot, np.arange(len(SEEDS)))
    together = drive(everyone, boats, SEEDS)
    assert len(set(together.steps)) > 3
    assert everyone.asked <= together.steps.sum() / (1.0 - WORTH_DROPPING)
    table = episode_table(together, BOAT, 0.1)
    longest = np.argsort(together.steps)
    for places in (np.arange(1, 40, 3), longest[[0, -1]], longest[-1:], longest[:1]):
        apart = drive(Some(pilot, places), boats, SEEDS[places])
        for column, values in episode_table(apart, BOAT, 0.1).items():
            np.testing.assert_array_equal(values, table[column][places])
        for i, place in enumerate(places):
            np.testing.assert_array_equal(apart.track(i), together.track(place))
            np.testing.assert_array_equal(apart.levers(i), together.levers(place))


@settings(max_examples=10)
@given(seed=strategies.integers(0, 2**31))
@pytest.mark.parametrize("name", pilots())
def test_boats_that_are_kept_go_on_as_if_the_others_were_there(name: str, seed: int) -> None:
    rng, whole = np.random.default_rng(seed), pilots()[name]
    n = int(rng.integers(1, 70))
    seen = rng.normal(size=(30, n, len(whole.senses))).astype(np.float32)
    whole.reset(n)
    for observation in seen[:12]:
        whole.act(observation)
    part, left = copy.deepcopy(whole), rng.permutation(n)[: rng.integers(1, n + 1)]
    part.keep(left)
    for observation in seen[12:]:
        again = rng.random(n) < 0.1
        whole.reset_boats(again)
        part.reset_boats(again[left])
        np.testing.assert_array_equal(part.act(observation[left]), whole.act(observation)[left])


@given(n=strategies.integers(0, 40), d=strategies.integers(1, 9), single=strategies.booleans())
def test_a_product_row_by_row_is_the_product(n: int, d: int, single: bool) -> None:
    kind = np.float32 if single else np.float64
    rng = np.random.default_rng(n)
    rows, matrix = rng.normal(size=(n, d)).astype(kind), rng.normal(size=(d, 5)).astype(kind)
    found = times(rows, matrix)
    assert found.dtype == kind and found.shape == (n, 5)
    limit = 1e-5 if single else 1e-13
    np.testing.assert_allclose(found, np.array([row @ matrix for row in rows]).reshape(n, 5), atol=limit)


def test_boats_that_are_to_sail_once_lie_still_after_their_end_and_stay_over() -> None:
    once, anew = boats(6, ("north",)), boats(6, ("north",))
    once.reset(options={"episodes": SEEDS[:6], "once": True})
    anew.reset(options={"episodes": SEEDS[:6]})
    levers, over = np.tile([1.0, 0.3], (6, 1)), np.zeros(6, dtype=bool)
    while not over.all():
        before = once.pose.copy()
        _, rewards, terminated, truncated, info = once.step(levers)
        anew.step(levers)
        np.testing.assert_array_equal(once.pose[over], before[over])
        np.testing.assert_array_equal(once.pose[~over], anew.pose[~over])
        assert not rewards[over].any()
        assert (terminated | truncated)[over].all()
        over = terminated | truncated
        assert all(info["outcome"][i] in ENDS for i in np.flatnonzero(over))
    observation, _ = once.reset(options={"episodes": SEEDS[:6]})
    np.testing.assert_array_equal(observation, anew.reset(options={"episodes": SEEDS[:6]})[0])
    while not once.step(levers)[2].any():
        pass
    assert not once.step(levers)[2].all()
