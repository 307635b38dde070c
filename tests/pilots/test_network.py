"""Networks as pilots: the same in NumPy as in torch, cloned from runs or learned by trying."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.errors import UserError
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.demonstrations import observed
from swamp_rl.pilots.network import NetworkPilot, layers_of
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from tests.support.patience import PATIENCE
from tests.support.steering_runs import RUNS, wandering

POSE = ("north", "east", "cos_heading", "sin_heading")


def test_levers_are_those_of_the_torch_network_within_the_levers_ways() -> None:
    torch.manual_seed(0)
    network = torch.nn.Sequential(torch.nn.Linear(4, 16), torch.nn.Tanh(), torch.nn.Linear(16, 2))
    mean, scale = np.array([1.0, 2.0, 0.0, 0.0]), np.array([5.0, 4.0, 1.0, 1.0])
    pilot = NetworkPilot("cloning", POSE, {"mean": mean, "scale": scale, **layers_of(network)})
    seen = np.random.default_rng(0).uniform(-9.0, 9.0, size=(200, 4))
    with torch.no_grad():
        expected = network(torch.tensor((seen - mean) / scale, dtype=torch.float32)).numpy()
    assert (np.abs(expected) < 1.0).any() and (expected[:, 0] < 0.0).any()
    np.testing.assert_allclose(pilot.act(seen), np.clip(expected, [0.0, -1.0], [1.0, 1.0]), atol=1e-6)


def test_weights_that_do_not_fit_each_other_are_refused() -> None:
    good = layers_of([torch.nn.Linear(4, 2)]) | {"mean": np.zeros(4), "scale": np.ones(4)}
    NetworkPilot("cloning", POSE, good)
    with pytest.raises(ValueError, match="weight_0 has the shape"):
        NetworkPilot("cloning", POSE[:3], good | {"mean": np.zeros(3), "scale": np.ones(3)})
    with pytest.raises(ValueError, match="two outputs"):
        NetworkPilot("cloning", POSE, good | layers_of([torch.nn.Linear(4, 3)]))


def test_a_decision_is_held_and_a_boat_that_starts_anew_decides_at_once() -> None:
    layers = layers_of([torch.nn.Linear(4, 2)])
    scaling = {"mean": np.zeros(4), "scale": np.ones(4)}
    now = NetworkPilot("ppo", POSE, {**scaling, **layers})
    held = NetworkPilot("ppo", POSE, {**scaling, **layers}, hold=3)
    seen = 0.3 * np.random.default_rng(0).normal(size=(8, 2, 4))
    held.reset(2)
    decided = [now.act(observation) for observation in seen]
    driven = [held.act(observation) for observation in seen[:5]]
    held.reset_boats(np.array([False, True]))
    driven += [held.act(observation) for observation in seen[5:]]
    first, second = ([step[boat] for step in driven] for boat in (0, 1))
    np.testing.assert_allclose(first, [decided[t][0] for t in (0, 0, 0, 3, 3, 3, 6, 6)], rtol=1e-6)
    np.testing.assert_allclose(second, [decided[t][1] for t in (0, 0, 0, 3, 3, 5, 5, 5)], rtol=1e-6)
    held.reset(1)
    np.testing.assert_allclose(held.act(seen[7][:1]), decided[7][:1], rtol=1e-6)


@pytest.mark.parametrize("hold", [0, 2.0, True])
def test_a_hold_that_is_no_count_of_steps_is_refused(hold: int) -> None:
    weights = layers_of([torch.nn.Linear(4, 2)]) | {"mean": np.zeros(4), "scale": np.ones(4)}
    with pytest.raises(ValueError, match="hold"):
        NetworkPilot("ppo", POSE, weights, hold)


def test_cloning_learns_what_the_levers_did_on_runs_it_has_not_seen() -> None:
    quick = CloningSettings(senses=POSE, reaction=0.0, epochs=40, batch_size=64, hidden=(32, 32))
    now = [wandering(seed, lag=0) for seed in range(8)]
    heard: list[float] = []
    pilot = fit_cloning(now, quick, heard.append)
    unseen = wandering(99, lag=0)
    error = pilot.act(observed(unseen, POSE)) - unseen.joypad
    assert np.sqrt(np.mean(error**2, axis=0)).max() < 0.2 * unseen.joypad[:, 1].std()
    np.testing.assert_allclose(heard, np.arange(1, 41) / 40)


def test_a_clone_does_at_once_what_the_logged_pilot_did_a_reaction_later() -> None:
    quick = CloningSettings(senses=POSE, reaction=0.3, epochs=40, batch_size=64, hidden=(32, 32))
    pilot = fit_cloning([wandering(seed, lag=3) for seed in range(8)], quick)
    unseen, prompt = wandering(99, lag=3), wandering(99, lag=0)
    error = pilot.act(observed(unseen, POSE)) - prompt.joypad
    assert np.sqrt(np.mean(error**2, axis=0)).max() < 0.2 * prompt.joypad[:, 1].std()


def test_a_reaction_longer_than_a_run_is_refused() -> None:
    with pytest.raises(UserError, match=r"run-0: lasts 0\.9 s"):
        fit_cloning([wandering(0, rows=10)], CloningSettings(senses=POSE, reaction=1.0))


def test_runs_without_the_gates_cannot_be_cloned_by_a_pilot_that_senses_them() -> None:
    with pytest.raises(UserError, match="gate_ahead"):
        fit_cloning(RUNS, CloningSettings(senses=("north", "gate_ahead")))


def test_cloning_with_the_same_seed_gives_the_same_pilot_and_leaves_torch_s_chance_alone() -> None:
    quick = CloningSettings(senses=POSE, epochs=2, noise=0.1)
    torch.manual_seed(7)
    first = fit_cloning(RUNS, quick).weights()
    drawn = torch.rand(1)
    second = fit_cloning(RUNS, quick).weights()
    other = fit_cloning(RUNS, quick.model_copy(update={"seed": 1})).weights()
    for name in first:
        np.testing.assert_array_equal(first[name], second[name])
    assert (first["weight_0"] != other["weight_0"]).any()
    torch.manual_seed(7)
    assert torch.rand(1) == drawn


def learned(seed: int) -> tuple[NetworkPilot, list[float]]:
    settings = PPOSettings(boats=8, decisions=1024, horizon=64, batch_size=128, epochs=2, seed=seed)
    boats = GatesVectorEnv(8, observation=settings.senses, autoreset_mode="SameStep")
    heard: list[float] = []
    return train_ppo(GatesVecEnv(boats, settings.hold), settings, heard.append), heard


def test_ppo_learns_the_same_from_the_same_seed_and_tells_how_far_it_is() -> None:
    (first, heard), (second, _), (other, _) = learned(0), learned(0), learned(1)
    assert heard[-1] == 1.0 and np.all(np.diff(heard) > 0.0)
    for name, value in first.weights().items():
        np.testing.assert_array_equal(value, second.weights()[name])
    seen = np.random.default_rng(0).normal(size=(20, len(first.senses)))
    assert np.isfinite(first.act(seen)).all()
    assert (first.act(seen) != other.act(seen)).any()


def test_ppo_drives_as_its_policy_does_and_holds_what_it_decides() -> None:
    from stable_baselines3 import PPO

    from swamp_rl.pilots.ppo import mean_layers

    boats = GatesVectorEnv(2, observation=PPOSettings().senses, autoreset_mode="SameStep")
    policy = PPO("MlpPolicy", GatesVecEnv(boats), n_steps=8, batch_size=8, seed=0, device="cpu").policy
    neutral = {"mean": np.zeros(12), "scale": np.ones(12)}
    pilot = NetworkPilot("ppo", PPOSettings().senses, {**neutral, **mean_layers(policy)})
    seen = np.random.default_rng(0).normal(size=(30, 12)).astype(np.float32)
    asked, _ = policy.predict(seen, deterministic=True)
    np.testing.assert_allclose(
        pilot.act(seen), np.clip(asked, -1.0, 1.0) * [0.5, 1.0] + [0.5, 0.0], atol=1e-5
    )
    assert learned(0)[0].hold == PPOSettings().hold > 1


def test_ppo_leaves_torch_with_the_threads_it_had() -> None:
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    try:
        learned(0)
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)


def test_an_optimiser_leaves_nothing_in_the_temporary_directory(tmp_path: Path) -> None:
    temporary, cache = tmp_path / "temporary", tmp_path / "cache"
    temporary.mkdir()
    environment = os.environ | {"TMPDIR": str(temporary), "XDG_CACHE_HOME": str(cache)}
    environment.pop("TORCHINDUCTOR_CACHE_DIR", None)
    script = "import swamp_rl.pilots, torch\ntorch.optim.AdamW([torch.zeros(1, requires_grad=True)])"
    subprocess.run([sys.executable, "-c", script], env=environment, check=True, timeout=PATIENCE)
    assert list(temporary.iterdir()) == []
    assert (cache / "torchinductor").is_dir()
