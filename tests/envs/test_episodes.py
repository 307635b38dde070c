"""Same seed, same episode, bit for bit, alone or in a batch, and what happens when an episode ends."""

from typing import Any

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.fleet import PARALLEL_FROM
from swamp_rl.envs.single import GatesEnv

from swamp_rl.course import Course, load_course

STEPS = 120


def levers(episode: int) -> np.ndarray:
    """Commands (STEPS, 2) of an unsteady hand, other ones for each episode."""
    rng = np.random.default_rng([7, episode])
    return np.column_stack([rng.uniform(0.3, 1.0, STEPS), rng.uniform(-1.0, 1.0, STEPS)])


def track_alone(seed: int, level: str) -> np.ndarray:
    """Observations and rewards (STEPS, 13) of one boat, until it ends and zero from then on."""
    env = GatesEnv(disturbances=level)
    env.reset(seed=seed)
    rows = np.zeros((STEPS, 13))
    for row, lever in zip(rows, levers(seed), strict=True):
        observation, reward, terminated, truncated, _ = env.step(lever)
        row[:] = [*observation, reward]
        if terminated or truncated:
            break
    return rows


def tracks_together(seeds: np.ndarray, level: str) -> np.ndarray:
    """As `track_alone`, (n, STEPS, 13), of all the episodes in one batch."""
    boats = GatesVectorEnv(len(seeds), disturbances=level)
    boats.reset(options={"episodes": seeds})
    hands = np.stack([levers(int(seed)) for seed in seeds])
    rows = np.zeros((len(seeds), STEPS, 13))
    running = np.ones(len(seeds), dtype=bool)
    for j in range(STEPS):
        observation, reward, terminated, truncated, _ = boats.step(hands[:, j])
        rows[running, j] = np.column_stack([observation, reward])[running]
        running &= ~(terminated | truncated)
    return rows


@pytest.mark.parametrize("level", ["standard", "severe"])
def test_an_episode_is_the_same_bit_for_bit_alone_and_in_batches_of_3_and_300(level: str) -> None:
    seeds = np.arange(100, 400)
    many = tracks_together(seeds, level)
    few = tracks_together(seeds[[0, 150, 299]], level)
    assert np.array_equal(few, many[[0, 150, 299]])
    for i in (0, 150, 299):
        assert np.array_equal(track_alone(int(seeds[i]), level), many[i])


def test_the_threads_of_a_large_batch_change_no_bit() -> None:
    seeds = np.arange(PARALLEL_FROM + 3)
    parallel = tracks_together(seeds, "severe")
    assert np.array_equal(tracks_together(seeds[-5:], "severe"), parallel[-5:])


def test_boat_i_of_a_seeded_batch_is_the_single_boat_of_seed_plus_i() -> None:
    boats = GatesVectorEnv(4, disturbances="standard")
    observation, _ = boats.reset(seed=20)
    for i in range(4):
        alone, _ = GatesEnv(disturbances="standard").reset(seed=20 + i)
        assert np.array_equal(observation[i], alone)


def test_different_seeds_give_different_episodes() -> None:
    boats = GatesVectorEnv(50, disturbances="standard")
    observation, _ = boats.reset(seed=0)
    assert len(np.unique(observation[:, 0])) == 50
    assert len(np.unique(boats.fleet.params["wind_speed"])) == 50
    assert len(np.unique(boats.fleet.boats["gust_seed"])) == 50


def brief(seconds: float) -> Course:
    return load_course("camogli").model_copy(update={"time_limit": seconds})


def test_following_episodes_of_a_batch_are_those_of_the_single_boats() -> None:
    course, idle = brief(0.5), np.array([0.0, 0.0])
    boats = GatesVectorEnv(3, course=course, disturbances="standard", autoreset_mode=AutoresetMode.SAME_STEP)
    observation, _ = boats.reset(seed=5)
    for i in range(3):
        env = GatesEnv(course=course, disturbances="standard")
        alone = [env.reset(seed=5 + i)[0]] + [env.reset()[0] for _ in range(2)]
        batch = [np.array(boats.reset(seed=5)[0][i])]
        for _ in range(2):
            for _ in range(5):
                observation, *_ = boats.step(np.tile(idle, (3, 1)))
            batch.append(observation[i])
        assert np.array_equal(alone, batch)


def test_in_the_next_step_mode_the_end_stays_in_sight_for_one_step() -> None:
    boats = GatesVectorEnv(2, course=brief(0.3), disturbances="standard")
    boats.reset(seed=1)
    full = np.array([[1.0, 0.5], [1.0, -0.5]])
    for _ in range(2):
        assert boats.step(full)[4] == {}
    observation, _, terminated, truncated, info = boats.step(full)
    assert truncated.all() and not terminated.any()
    assert info["outcome"].tolist() == ["timeout", "timeout"]
    assert info["time"] == pytest.approx([0.3, 0.3])
    assert boats.pose[:, :2] == pytest.approx(observation[:, :2])
    observation, reward, terminated, truncated, info = boats.step(full)
    assert reward.tolist() == [0.0, 0.0] and not (terminated | truncated).any() and info == {}
    assert (boats.velocity == 0.0).all() and (observation[:, 4:7] == 0.0).all()
    assert (boats.step(full)[0][:, 4] != 0.0).all()


def test_a_boat_that_starts_anew_ignores_levers_however_long_they_are_held() -> None:
    boats, other = (GatesVectorEnv(1, time_limit=1.0) for _ in range(2))
    boats.reset(seed=0)
    ahead = np.array([[1.0, 0.0]])
    assert boats.step_held(ahead, 10)[3].all()
    seen, rewards, *_ = boats.step_held(ahead, 6)
    other.reset(seed=0)
    assert np.array_equal(seen, other.reset()[0])
    assert rewards.tolist() == [0.0]


@pytest.mark.parametrize(("mode", "anew"), [("NextStep", 1), ("SameStep", 10)])
def test_no_step_is_simulated_once_no_boat_sails(
    mode: str, anew: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    boats = GatesVectorEnv(2, time_limit=1.0, autoreset_mode=mode)
    boats.reset(seed=0)
    sail, steps = boats.fleet.sail, []
    monkeypatch.setattr(boats.fleet, "sail", lambda *given: steps.append(1) or sail(*given))
    assert boats.step_held(np.zeros((2, 2)), 10**9)[3].all()
    assert len(steps) == 10
    boats.step_held(np.zeros((2, 2)), 10**9)
    assert len(steps) == 10 + anew


def test_in_the_same_step_mode_the_last_observation_is_in_the_info() -> None:
    later = GatesVectorEnv(2, course=brief(0.3), disturbances="standard")
    at_once = GatesVectorEnv(2, course=brief(0.3), disturbances="standard", autoreset_mode="SameStep")
    full = np.array([[1.0, 0.5], [1.0, -0.5]])
    for boats in (later, at_once):
        boats.reset(seed=1)
        for _ in range(2):
            boats.step(full)
    last, *_ = later.step(full)
    anew, _, _, truncated, info = at_once.step(full)
    assert truncated.all() and info["_final_obs"].all()
    assert np.array_equal(info["final_obs"], last)
    assert info["final_info"]["outcome"].tolist() == ["timeout", "timeout"]
    assert np.array_equal(anew, later.step(full)[0])


def test_one_boat_that_ends_leaves_the_others_as_they_would_be() -> None:
    # The first boat is put next to a buoy.
    hands = {seed: levers(seed) for seed in (3, 4)}
    alone = tracks_together(np.array([4]), "severe")[0]
    boats = GatesVectorEnv(2, disturbances="severe", autoreset_mode="SameStep")
    boats.reset(options={"episodes": [3, 4]})
    boats.fleet.boats["state"][0, :2] = [7.5, 2.0]
    ended = []
    for j in range(STEPS):
        observation, _, terminated, truncated, info = boats.step(np.stack([hands[3][j], hands[4][j]]))
        ended.append(bool(terminated[0]))
        if j == 0:
            assert info["final_info"]["outcome"].tolist() == ["buoy", None]
        if terminated[1] or truncated[1]:
            break
        assert np.array_equal(observation[1], alone[j, :12])
    assert ended[0]


def test_what_was_drawn_for_an_episode_reads_as_the_effects_of_a_boat_file() -> None:
    boats = GatesVectorEnv(3, disturbances="severe")
    boats.reset(seed=0)
    drawn: dict[str, Any] = boats.fleet.drawn(1)
    again = GatesVectorEnv(1, disturbances=drawn["effects"])
    again.reset(seed=0)
    assert again.fleet.params[0] == boats.fleet.params[1]
    assert drawn["gust_seed"] == boats.fleet.boats["gust_seed"][1]
