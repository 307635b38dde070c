"""A reservoir that swings its levers as far as its teachers did keeps its way among disturbances."""

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.boat import load_boat
from swamp_rl.evaluation import Rollout, drive
from swamp_rl.pilots.record import drive_episodes
from swamp_rl.pilots.reservoir import ReservoirPilot, ReservoirSettings, fit_reservoir
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.runs import Run

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

PILOT_SEEDS, EPISODES = (0, 1), np.arange(1_500_000, 1_500_100)


def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
    return GatesVectorEnv(n, boat="swamp-thesis", disturbances="standard", observation=senses)


@pytest.fixture(scope="module")
def logged() -> list[Run]:
    """Those of 16 scripted runs at `standard` that succeeded."""
    pilot = ScriptedPilot(0)
    pilot.reset(16)
    seeds = 2**31 + np.arange(16)
    runs = drive_episodes(boats(16, pilot.senses), pilot, load_boat("swamp-thesis"), seeds, 0.1)
    return [run for run in runs if run.meta.outcome == "success"]


def fitted(runs: list[Run], seed: int, matched: bool) -> ReservoirPilot:
    return fit_reservoir(runs, ReservoirSettings(seed=seed, matched=matched))


def driven(runs: list[Run], matched: bool) -> list[Rollout]:
    return [drive(fitted(runs, seed, matched), boats, EPISODES) for seed in PILOT_SEEDS]


def test_it_loses_fewer_runs_than_half_of_those_that_the_mere_ridge_readout_loses(logged: list[Run]) -> None:
    lost, of_ridge = (
        sum(int((rollout.outcome != "success").sum()) for rollout in driven(logged, matched))
        for matched in (True, False)
    )
    assert lost < 0.5 * of_ridge


def test_nothing_but_the_levers_swing_differs(logged: list[Run]) -> None:
    matched, ridge = (fitted(logged, 0, swings).weights() for swings in (True, False))
    gain = matched["out"] / ridge["out"]
    np.testing.assert_allclose(matched["Wout"], gain * ridge["Wout"], rtol=1e-9)
    for name in ("centre", "scale", "W", "Win", "bias", "leak"):
        np.testing.assert_array_equal(matched[name], ridge[name])
    # the throttle was nearly always full, so there is little to make up for
    assert 1.0 < gain[0] < 1.05 < gain[1]
