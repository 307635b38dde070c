"""SAC, the check of PPO: what it leaves behind drives as its policy does."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.errors import UserError
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.sac import SACSettings, learner_of, pilot_of, train_sac
from tests.support import forks
from tests.support.killed import assert_same_weights, killed_training
from tests.support.killed_sac import SETTINGS, trained

pytestmark = pytest.mark.slow


def boats_of(settings: SACSettings) -> GatesVecEnv:
    boats = GatesVectorEnv(settings.boats, observation=settings.senses, autoreset_mode="SameStep")
    return GatesVecEnv(boats, settings.hold)


def test_the_pilot_drives_as_the_policy_without_its_noise() -> None:
    from stable_baselines3.common.vec_env import VecNormalize

    settings = SACSettings(boats=2)
    scaled = VecNormalize(boats_of(settings), norm_reward=False)
    learner = learner_of(scaled, settings)
    seen = np.random.default_rng(0).normal(size=(40, len(settings.senses))).astype(np.float32)
    asked, _ = learner.predict(seen, deterministic=True)
    levers = pilot_of(learner, scaled, settings).act(seen)
    np.testing.assert_allclose(levers, asked * [0.5, 1.0] + [0.5, 0.0], atol=1e-5)


def test_it_learns_the_same_from_the_same_seed_and_tells_its_curve() -> None:
    def learned(seed: int) -> tuple[NetworkPilot, list[int]]:
        quick = SACSettings(boats=32, decisions=1600, random=640, updates=1, hidden=(8,), leg=25, seed=seed)
        steps: list[int] = []
        pilot = train_sac(boats_of(quick), quick, log=lambda step, values: steps.append(step))
        return pilot, steps

    (first, steps), (second, _), (other, _) = learned(0), learned(0), learned(1)
    assert steps == sorted(set(steps)) and 0 < steps[0] <= steps[-1] <= 1600
    assert_same_weights(first, second)
    assert (first.weights()["weight_0"] != other.weights()["weight_0"]).any()


def test_a_training_without_a_checkpoint_writes_nothing(temporary: Path) -> None:
    short = SACSettings(boats=4, decisions=16, random=8, updates=1, hidden=(8,), leg=2)
    train_sac(boats_of(short), short)
    assert not list(temporary.iterdir())


@forks.GROUP
@pytest.mark.timed
def test_a_training_killed_at_random_instants_ends_with_the_same_bits(tmp_path: Path) -> None:
    kills, resumed = killed_training("sac", tmp_path)
    assert kills >= 2
    assert_same_weights(trained(None), resumed)


def test_a_checkpoint_holds_what_was_seen_and_is_refused_with_other_settings(tmp_path: Path) -> None:
    from safetensors.numpy import load_file

    path = tmp_path / "checkpoint"
    trained(path)
    decisions = -(-SETTINGS.decisions // SETTINGS.boats)
    held = load_file(path)
    assert held["buffer.actions"].shape == (decisions, SETTINGS.boats, 2)
    assert held["buffer.rewards"].any(axis=1).all()
    with pytest.raises(UserError, match=r"other settings \(updates\)"):
        trained(path, SETTINGS.model_copy(update={"updates": 2}))
