"""SAC, the check of PPO: what it leaves behind drives as its policy does."""

import numpy as np

from envs.batched import GatesVectorEnv
from envs.sb3 import GatesVecEnv
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.sac import SACSettings, _learner, _pilot, train_sac


def boats_of(settings: SACSettings) -> GatesVecEnv:
    boats = GatesVectorEnv(settings.boats, observation=settings.senses, autoreset_mode="SameStep")
    return GatesVecEnv(boats, settings.hold)


def test_the_pilot_drives_as_the_policy_without_its_noise() -> None:
    from stable_baselines3.common.vec_env import VecNormalize

    settings = SACSettings(boats=2)
    scaled = VecNormalize(boats_of(settings), norm_reward=False)
    learner = _learner(scaled, settings)
    seen = np.random.default_rng(0).normal(size=(40, len(settings.senses))).astype(np.float32)
    asked, _ = learner.predict(seen, deterministic=True)
    levers = _pilot(learner, scaled, settings).act(seen)
    np.testing.assert_allclose(levers, asked * [0.5, 1.0] + [0.5, 0.0], atol=1e-5)


def test_it_learns_the_same_from_the_same_seed_and_tells_its_curve() -> None:
    def learned(seed: int) -> tuple[NetworkPilot, list[int]]:
        quick = SACSettings(boats=32, decisions=1600, random=640, updates=1, hidden=(8,), seed=seed)
        steps: list[int] = []
        pilot = train_sac(boats_of(quick), quick, log=lambda step, values: steps.append(step))
        return pilot, steps

    (first, steps), (second, _), (other, _) = learned(0), learned(0), learned(1)
    assert steps == sorted(set(steps)) and 0 < steps[0] <= steps[-1] <= 1600
    for name, value in first.weights().items():
        np.testing.assert_array_equal(value, second.weights()[name])
    assert (first.weights()["weight_0"] != other.weights()["weight_0"]).any()
