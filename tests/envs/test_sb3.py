"""The batch as stable-baselines3 sees it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from gymnasium.wrappers.vector import RecordEpisodeStatistics
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.single import GatesEnv

from swamp_rl.course import Course, load_course
from swamp_rl.errors import UserError

sb3 = pytest.importorskip("swamp_rl.envs.sb3")


def boats(n: int, course: Course | str = "camogli") -> GatesVectorEnv:
    return GatesVectorEnv(n, course=course, disturbances="standard", autoreset_mode="SameStep")


def test_it_steps_as_the_single_boats_and_starts_anew_by_itself() -> None:
    course = load_course("camogli").model_copy(update={"time_limit": 0.4})
    together = sb3.GatesVecEnv(boats(2, course))
    together.seed(11)
    start = together.reset()
    for i in range(2):
        env = GatesEnv(course=course, disturbances="standard")
        assert np.array_equal(start[i], env.reset(seed=11 + i)[0])
    alone = GatesEnv(course=course, disturbances="standard")
    alone.reset(seed=12)
    full = np.array([[1.0, 0.2], [1.0, -0.2]], dtype=np.float32)
    for j in range(4):
        observation, rewards, dones, infos = together.step(full)
        expected, reward, _, _, _ = alone.step(full[1])
        assert dones.tolist() == [j == 3] * 2
        assert rewards[1] == np.float32(reward)
    assert np.array_equal(infos[1]["terminal_observation"], expected)
    assert infos[1]["TimeLimit.truncated"] is True and infos[1]["outcome"] == "timeout"
    assert np.array_equal(observation[1], alone.reset()[0])


def test_actions_reach_over_the_whole_way_of_each_lever() -> None:
    together = sb3.GatesVecEnv(boats(3))
    together.reset()
    together.step(np.array([[-1.0, -1.0], [0.0, 0.0], [1.0, 1.0]], dtype=np.float32))
    assert np.array_equal(together.boats.fleet.boats["lever"], [[0.0, -1.0], [0.5, 0.0], [1.0, 1.0]])


def test_options_that_were_set_count_for_the_next_reset_alone() -> None:
    together, alone = sb3.GatesVecEnv(boats(2)), boats(2)
    together.set_options({"episodes": [8, 5]})
    assert np.array_equal(together.reset(), alone.reset(options={"episodes": [8, 5]})[0])
    assert np.array_equal(together.reset(), alone.reset()[0])
    together.set_options([{"episodes": [8, 5]}, {"episodes": [1, 2]}])
    with pytest.raises(UserError, match="give one dict for all"):
        together.reset()


def test_a_held_action_is_as_many_steps_whose_rewards_add_up() -> None:
    held, stepped = sb3.GatesVecEnv(boats(2), hold=3), boats(2)
    held.seed(11)
    held.reset()
    stepped.reset(seed=11)
    for levers in ([1.0, 0.2], [0.5, -0.6]):
        asked = np.tile(np.array(levers, dtype=np.float32), (2, 1))
        observation, rewards, _, _ = held.step(asked * [2.0, 1.0] - [1.0, 0.0])
        alone = [stepped.step(asked) for _ in range(3)]
        assert np.array_equal(observation, alone[-1][0])
        np.testing.assert_allclose(rewards, sum(step[1] for step in alone), rtol=1e-6)


def test_a_boat_that_ends_while_an_action_is_held_is_paid_once_and_starts_afresh() -> None:
    held, once = sb3.GatesVecEnv(boats(1), hold=5), sb3.GatesVecEnv(boats(1))
    paid, began = [], []
    for together in (held, once):
        together.seed(4)
        together.reset()
        together.boats.fleet.boats["state"][0, :2] = [8.0, 2.0]
        observation, rewards, dones, _ = together.step(np.array([[-1.0, 0.0]]))
        assert dones[0]
        paid.append(rewards[0])
        began.append(observation[0])
    assert paid[0] == paid[1]
    assert np.array_equal(began[0], began[1])


def test_a_failure_is_no_time_out() -> None:
    together = sb3.GatesVecEnv(boats(1))
    together.reset()
    together.boats.fleet.boats["state"][0, :2] = [8.0, 2.0]
    _, rewards, dones, infos = together.step(np.array([[-1.0, 0.0]]))
    assert dones[0] and infos[0]["outcome"] == "buoy" and infos[0]["TimeLimit.truncated"] is False
    assert rewards[0] < -1.0


@pytest.mark.parametrize("boats", [lambda: GatesVectorEnv(2), GatesEnv, lambda: "swamp/Gates-v1"])
def test_boats_that_do_not_start_anew_in_the_same_step_are_refused(boats: Callable[[], Any]) -> None:
    with pytest.raises(UserError, match='autoreset_mode="SameStep"'):
        sb3.GatesVecEnv(boats())


def test_a_wrapper_of_gymnasium_is_named_with_what_to_use_instead() -> None:
    wrapped = RecordEpisodeStatistics(boats(3))
    with pytest.raises(UserError, match=r"not Gymnasium's wrapper RecordEpisodeStatistics; .*VecMonitor"):
        sb3.GatesVecEnv(wrapped)


@pytest.mark.parametrize("hold", [0, -1, 2.5, None, True])
def test_a_number_of_held_steps_that_cannot_be_is_refused_at_once(hold: Any) -> None:
    with pytest.raises(UserError, match="hold must be a whole number from 1 to"):
        sb3.GatesVecEnv(boats(2), hold)


def test_ppo_learns_on_it_for_a_moment() -> None:
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import VecMonitor

    monitored = VecMonitor(sb3.GatesVecEnv(boats(8)))
    model = PPO("MlpPolicy", monitored, n_steps=16, batch_size=64, n_epochs=1, seed=0, device="cpu")
    model.learn(256)
    action, _ = model.predict(monitored.reset())
    assert action.shape == (8, 2) and np.isfinite(action).all()
