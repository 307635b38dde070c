"""What an environment refuses, in plain words, and that it then goes on as if it had not been asked."""

from typing import Any

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.single import GatesEnv

from swamp_rl.course import load_course
from swamp_rl.course.schema import Course
from swamp_rl.errors import UserError

GOOD = np.array([0.7, 0.2])
BAD_ACTIONS: list[tuple[Any, str]] = [
    ([np.nan, 0.0], "are not numbers"),
    ([0.5, np.inf], "are not numbers"),
    (0.5, r"must have the shape \(2,\), not \(\)"),
    ([0.1, 0.2, 0.3], r"must have the shape \(2,\), not \(3,\)"),
    ([[0.1, 0.2]], r"must have the shape \(2,\)"),
    ([[0.1], [0.2, 0.3]], "must have the shape"),
    (["full", "port"], "must be of numbers"),
    ([1 + 2j, 0.0], "must be of numbers"),
    ([None, 0.0], "must be of numbers"),
    (None, "must have the shape"),
]


@pytest.mark.parametrize(("action", "message"), BAD_ACTIONS)
def test_a_refused_action_leaves_the_episode_as_it_was(action: Any, message: str) -> None:
    asked, spared = GatesEnv(disturbances="standard"), GatesEnv(disturbances="standard")
    for env in (asked, spared):
        env.reset(seed=3)
        env.step(GOOD)
    with pytest.raises(UserError, match=message):
        asked.step(action)
    for _ in range(3):
        one, other = asked.step(GOOD), spared.step(GOOD)
        np.testing.assert_array_equal(one[0], other[0])
        assert one[1:] == other[1:]


@pytest.mark.parametrize("boat", [0, 2])
def test_one_bad_action_of_a_batch_leaves_all_boats_where_they_are(boat: int) -> None:
    asked, spared = GatesVectorEnv(3), GatesVectorEnv(3)
    for env in (asked, spared):
        env.reset(seed=3)
        env.step(np.tile(GOOD, (3, 1)))
    wrong = np.tile(GOOD, (3, 1))
    wrong[boat, 1] = np.nan
    with pytest.raises(UserError, match=f"boat {boat}: the levers .* are not numbers"):
        asked.step(wrong)
    np.testing.assert_array_equal(asked.pose, spared.pose)
    one, other = asked.step(np.tile(GOOD, (3, 1))), spared.step(np.tile(GOOD, (3, 1)))
    np.testing.assert_array_equal(one[0], other[0])
    np.testing.assert_array_equal(one[1], other[1])


def test_levers_of_a_boat_that_has_ended_are_not_looked_at() -> None:
    course = load_course("camogli").model_copy(update={"time_limit": 0.2})
    boats = GatesVectorEnv(2, course=course)
    boats.reset(seed=1)
    for _ in range(2):
        *_, truncated, _ = boats.step(np.zeros((2, 2)))
    assert truncated.all()
    boats.step(np.full((2, 2), np.nan))
    assert (boats.fleet.time == 0.0).all()


@pytest.mark.parametrize("kind", [GatesEnv, GatesVectorEnv])
def test_a_step_before_the_first_reset_is_refused(kind: Any) -> None:
    env = kind()
    with pytest.raises(UserError, match="call reset first"):
        env.step(np.zeros(env.action_space.shape))


@pytest.mark.parametrize("seed", [-1, 1.5, "one", True])
def test_a_seed_that_is_none_is_refused(seed: Any) -> None:
    for env in (GatesEnv(), GatesVectorEnv(2)):
        with pytest.raises(UserError, match="seed must be a whole number"):
            env.reset(seed=seed)


@pytest.mark.parametrize("step", [1e-320, 0.0, -0.1, 1e300, float("nan"), "0.1", True])
def test_a_step_that_cannot_be_sailed_is_refused(step: Any) -> None:
    with pytest.raises(UserError, match=r"step: must be a time from 0.001 to 1 s"):
        GatesEnv(step=step)


@pytest.mark.parametrize("limit", [1e300, 1e-320, 0.0, float("inf")])
def test_a_time_limit_beyond_a_day_or_below_a_second_is_refused(limit: float) -> None:
    with pytest.raises(ValueError, match="time_limit"):
        Course.model_validate(load_course("camogli").model_dump() | {"time_limit": limit})


@pytest.mark.parametrize("count", [0, -1, 10**12, 2.0, True])
def test_a_number_of_boats_that_cannot_be_is_refused(count: Any) -> None:
    with pytest.raises(UserError, match="num_envs: must be a whole number from 1 to"):
        GatesVectorEnv(count)


@pytest.mark.parametrize("options", [3, True, "once", [], np.zeros(2), {"nope": 1}, {1: 2}])
def test_options_that_are_none_are_refused(options: Any) -> None:
    for env in (GatesEnv(), GatesVectorEnv(2)):
        with pytest.raises(UserError, match=r"reset: (options must be None or a dict|unknown option)"):
            env.reset(options=options)


@pytest.mark.parametrize("once", ["no", [1], np.zeros(2), 2])
def test_once_is_true_or_false(once: Any) -> None:
    with pytest.raises(UserError, match="once must be True or False"):
        GatesVectorEnv(2).reset(options={"once": once})


@pytest.mark.parametrize("seeds", [[1, 2], (1, 2), np.array([1, 2])])
def test_several_seeds_are_answered_with_the_option_that_takes_them(seeds: Any) -> None:
    with pytest.raises(UserError, match=r'options=\{"episodes": seeds\}'):
        GatesVectorEnv(2).reset(seed=seeds)


@pytest.mark.parametrize("episodes", [3, [1], [[1, 2], [3]], [1, -2], [1.0, 2.0], ["a", "b"], [2**70, 1]])
def test_episodes_that_are_no_seeds_are_refused(episodes: Any) -> None:
    with pytest.raises(UserError, match="episodes must be 2 seeds"):
        GatesVectorEnv(2).reset(options={"episodes": episodes})


@pytest.mark.parametrize("steps", [0, -1, 1.5, None, "a", True, 2**70])
def test_a_number_of_held_steps_that_cannot_be_is_refused(steps: Any) -> None:
    boats = GatesVectorEnv(2)
    boats.reset(seed=0)
    with pytest.raises(UserError, match="steps must be a whole number from 1 to"):
        boats.step_held(np.zeros((2, 2)), steps)


@pytest.mark.parametrize("name", ["boat", "course"])
@pytest.mark.parametrize("given", [3, None, {}, [], b"x"])
def test_a_boat_or_course_that_is_no_name_is_refused(name: str, given: Any) -> None:
    with pytest.raises(UserError, match="give a name or a path"):
        GatesEnv(**{name: given})


def test_an_observation_that_is_no_list_is_refused() -> None:
    with pytest.raises(UserError, match="must be a list of names"):
        GatesEnv(observation=3)  # type: ignore[arg-type]
