"""Which models of stable-baselines3 drive, and for how many steps they hold an action."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Discrete, MultiDiscrete
from gymnasium.wrappers import NormalizeObservation, RescaleAction, TransformAction
from stable_baselines3 import PPO
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.errors import UserError
from swamp_rl.pilots.arguments import Asked, asked_pilot, opened
from swamp_rl.pilots.own import model_file
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.store import load_pilot, save_pilot


def stored(folder: Path, env: Any) -> Path:
    """The zip of a model of `env`, not trained."""
    PPO("MlpPolicy", env, device="cpu").save(folder / "model.zip")
    return folder / "model.zip"


def pilot(file: Path, **options: Any) -> Pilot:
    return opened(Asked("model", kind="sb3", options={"file": str(file), **options}))


@pytest.mark.parametrize("low, high", [(0.0, 1.0), (-2.0, 2.0), (np.array([0.0, -1.0]), np.ones(2) * 2.0)])
def test_a_model_of_actions_of_other_bounds_is_refused(tmp_path: Path, low: Any, high: Any) -> None:
    file = stored(tmp_path, RescaleAction(gymnasium.make("swamp/Gates-v1"), low, high))
    with pytest.raises(
        UserError, match=r"model's actions are Box\(.*Box\(-1, 1, \(2,\)\) are needed"
    ) as error:
        opened(asked_pilot(f"sb3:{file}"))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("space", [MultiDiscrete([3, 3]), Discrete(4)])
def test_a_model_of_discrete_actions_is_refused(tmp_path: Path, space: Any) -> None:
    env = TransformAction(gymnasium.make("swamp/Gates-v1"), lambda action: action, space)
    with pytest.raises(UserError, match=r"model's actions are .*Discrete"):
        pilot(stored(tmp_path, env))


def test_a_model_of_actions_from_minus_1_to_1_drives_as_in_its_training(tmp_path: Path) -> None:
    env = RescaleAction(gymnasium.make("swamp/Gates-v1"), -1.0, 1.0)
    file = stored(tmp_path, env)
    seen, _ = env.reset(seed=3)
    action, _ = PPO.load(file).predict(seen, deterministic=True)
    np.testing.assert_allclose(pilot(file).act(seen[None])[0], env.action(action), atol=1e-6)


def test_a_model_of_a_scaled_observation_is_refused(tmp_path: Path) -> None:
    file = stored(tmp_path, NormalizeObservation(gymnasium.make("swamp/Gates-v1")))
    with pytest.raises(
        UserError, match="observes cos_heading from -inf to inf, which are not the environment"
    ):
        pilot(file)


def test_a_model_of_another_time_limit_drives(tmp_path: Path) -> None:
    senses = ["gates_passed", "time_left"]
    env = gymnasium.make("swamp/Gates-v1", time_limit=40.0, observation=senses)
    assert pilot(stored(tmp_path, env), senses=senses).senses == tuple(senses)


def test_a_model_holds_an_action_for_as_many_steps_as_it_is_told_for_each_boat(tmp_path: Path) -> None:
    boats = GatesVecEnv(GatesVectorEnv(2, autoreset_mode="SameStep"), hold=3)
    file = stored(tmp_path, boats)
    held, free = pilot(file, hold=3), pilot(file)
    seen = np.random.default_rng(0).normal(size=(6, 2, 12))
    held.reset(2)
    free.reset(2)
    decided = [free.act(row) for row in seen]
    given = [held.act(row) for row in seen[:4]]
    np.testing.assert_allclose(given, [decided[0]] * 3 + [decided[3]], atol=1e-6)
    held.reset_boats(np.array([False, True]))
    np.testing.assert_allclose(held.act(seen[4]), [decided[3][0], decided[4][1]], atol=1e-6)
    save_pilot(held, tmp_path / "kept")
    assert load_pilot(tmp_path / "kept").settings()["options"]["hold"] == 3


def test_a_stored_model_imports_no_term_that_was_not_named(tmp_path: Path) -> None:
    from swamp_rl.envs.sb3_zip import SB3Zip, ZipSettings

    file = stored(tmp_path, gymnasium.make("swamp/Gates-v1"))
    model_file(str(file))
    settings = ZipSettings(file=str(file), senses=("their_unnamed:term",))
    with pytest.raises(UserError, match="if it is yours, name it: their_unnamed:term=FOLDER"):
        SB3Zip.load(tmp_path, settings)
