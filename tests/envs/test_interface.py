"""The environments keep Gymnasium's and stable-baselines3's contracts; bad arguments end in one line."""

import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.observation import CHARGE, NAMES, OBSERVATION
from swamp_rl.envs.single import GatesEnv

import swamp_rl  # noqa: F401  registers
from swamp_rl.errors import UserError


def test_gymnasium_checks_the_single_environment() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings(
            "ignore", message=".*Box observation space (minimum|maximum) value is.*infinity"
        )
        check_env(gymnasium.make("swamp/Gates-v1", disturbances="standard").unwrapped)


def test_stable_baselines3_checks_the_single_environment() -> None:
    from stable_baselines3.common.env_checker import check_env as check

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*symmetric and normalized Box action space.*")
        check(gymnasium.make("swamp/Gates-v1", disturbances="standard").unwrapped, skip_render_check=False)


def test_make_vec_gives_the_native_batch() -> None:
    boats = gymnasium.make_vec("swamp/Gates-v1", num_envs=5, step=0.2, observation=["north", "east"])
    assert isinstance(boats.unwrapped, GatesVectorEnv)
    assert boats.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    observation, _ = boats.reset(seed=1)
    assert observation.shape == (5, 2)
    result = boats.step(boats.action_space.sample())
    assert [part.shape for part in result[:4]] == [(5, 2), (5,), (5,), (5,)]
    assert result[0] in boats.observation_space


def test_the_joypad_is_throttle_then_angle() -> None:
    space = GatesEnv().action_space
    assert space == gymnasium.spaces.Box(np.float32([0, -1]), np.float32([1, 1]))


def test_a_pilot_senses_what_it_chose_in_its_order() -> None:
    chosen = ["gates_passed", "sin_heading", "north"]
    everything, _ = GatesEnv().reset(seed=4)
    some, _ = GatesEnv(observation=chosen).reset(seed=4)
    assert some.tolist() == [everything[OBSERVATION.index(name)] for name in chosen]


def test_what_is_sensed_in_severe_weather_lies_in_its_space_whatever_the_levers() -> None:
    senses = [name for name in NAMES if name != CHARGE]
    boats = GatesVectorEnv(8, disturbances="severe", observation=senses, time_limit=8.0, step=0.3)
    seen, _ = boats.reset(seed=1)
    boats.action_space.seed(1)
    for _ in range(80):
        assert seen in boats.observation_space and np.isfinite(seen).all()
        seen, rewards, *_ = boats.step(boats.action_space.sample())
        assert np.isfinite(rewards).all()


def test_the_gate_is_seen_from_the_boat() -> None:
    observation, _ = GatesEnv().reset(seed=2)
    seen = dict(zip(OBSERVATION, observation.astype(float).tolist(), strict=True))
    heading = np.arctan2(seen["sin_heading"], seen["cos_heading"])
    offset = complex(8.0 - seen["north"], 0.0 - seen["east"]) * np.exp(-1j * heading)
    assert (seen["gate_ahead"], seen["gate_starboard"]) == pytest.approx((offset.real, offset.imag), abs=1e-5)
    assert np.arctan2(seen["gate_sin"], seen["gate_cos"]) == pytest.approx(-heading, abs=1e-6)


def test_the_levers_drive_the_bow_thrusters_and_leave_the_stern_alone() -> None:
    boats = GatesVectorEnv(1)
    boats.reset(seed=0)
    boats.step(np.array([[0.8, -0.5]]))
    azimuth, throttle = np.split(boats.commands[0], 2)
    by_name = dict(zip(boats.fleet.boat.thruster_names, zip(azimuth, throttle, strict=True), strict=True))
    assert by_name["bs"] == by_name["bp"] == pytest.approx((-np.pi / 4, 0.8))
    assert by_name["ss"] == by_name["sp"] == (0.0, 0.0)


def test_a_picture_from_above_shows_both_gates_in_their_colours() -> None:
    env = gymnasium.make("swamp/Gates-v1", render_mode="rgb_array")
    env.reset(seed=0)
    picture: Any = env.render()
    assert picture.ndim == 3 and picture.dtype == np.uint8
    red, green, _ = picture.astype(int).transpose(2, 0, 1)
    north_of_middle = np.arange(len(picture))[:, None] < len(picture) / 2
    assert ((red - green > 100) & north_of_middle).any()
    assert ((green - red > 80) & ~north_of_middle).any()


def test_the_picture_has_a_scale_and_shows_where_the_boat_heads() -> None:
    """A scale bar, black, lies in the south-west; the boat's line reaches two lengths north of midship."""
    env = gymnasium.make("swamp/Gates-v1", render_mode="rgb_array")
    env.reset(seed=0)
    picture: Any = env.render()
    height, width = picture.shape[:2]
    corner = picture[height // 2 : height - 3, 3 : width // 2]
    assert (corner.max(axis=2) < 60).sum() > 50
    red, green, blue = picture.astype(int).transpose(2, 0, 1)
    fleet = env.unwrapped.fleet  # type: ignore[attr-defined]
    bounds, north = fleet.course.bounds, fleet.pose[0, 0]
    row = (bounds.north - north - 2.0 * 1.24) / (bounds.north - bounds.south) * height
    assert ((blue - red > 100) & (blue - green > 30))[int(row)].any()


def test_a_film_of_every_step_is_as_fast_as_the_boat() -> None:
    from swamp_rl.envs.sb3 import GatesVecEnv

    assert gymnasium.make("swamp/Gates-v1").metadata["render_fps"] == 10
    assert gymnasium.make("swamp/Gates-v1", step=0.02).metadata["render_fps"] == 50
    boats = GatesVectorEnv(2, step=0.02, autoreset_mode=AutoresetMode.SAME_STEP)
    assert boats.metadata["render_fps"] == 50
    assert GatesVecEnv(boats, hold=5).metadata["render_fps"] == 10
    assert GatesEnv.metadata["render_fps"] == GatesVectorEnv.metadata["render_fps"] == 10


@pytest.mark.parametrize("kind", [np.int64, np.float32])
def test_numbers_of_numpy_are_numbers(kind: Any) -> None:
    def made(number: Any, whole: Any) -> GatesVectorEnv:
        wind = {"effect": "wind", "speed": number(3), "from": {"uniform": [number(0), number(1)]}}
        weights = {"effort": number(2)}
        given: dict[str, Any] = {"depth": number(4), "time_limit": number(40), "step": number(1)}
        return GatesVectorEnv(
            whole(2), disturbances=[wind], reward=weights, max_episode_steps=whole(30), **given
        )

    one, other = made(kind, np.int64), made(float, int)
    np.testing.assert_array_equal(one.reset(seed=1)[0], other.reset(seed=1)[0])
    for _ in range(3):
        for part, expected in zip(one.step(np.ones((2, 2))), other.step(np.ones((2, 2))), strict=True):
            np.testing.assert_equal(part, expected)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"boat": "swamq"}, "swamq"),
        ({"course": "portofino"}, "portofino"),
        ({"disturbances": "calmm"}, "calmm"),
        ({"disturbances": [{"effect": "curent", "north": 0.1}]}, "curent"),
        ({"observation": ["nort"]}, "did you mean 'north'"),
        ({"observation": []}, "observation: must be a list"),
        ({"observation": "north"}, "observation: must be a list"),
        ({"observation": ["north", "north"]}, "given twice"),
        ({"step": 0.0}, "step"),
        ({"step": float("nan")}, "step"),
        ({"step": "0.1"}, "step"),
        ({"step": 5.0}, "step"),
        ({"render_mode": "human"}, "render_mode"),
        ({"num_envs": 0}, "num_envs"),
        ({"autoreset_mode": "Disabled"}, "autoreset_mode"),
    ],
)
def test_a_bad_argument_ends_in_one_clear_line(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError) as error:
        GatesVectorEnv(**arguments)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_gate_too_narrow_for_the_boat_is_refused() -> None:
    env = GatesEnv()
    narrow = env.fleet.course.gates[0].model_copy(update={"width": 1.4})
    with pytest.raises(UserError, match=r"gate green is 1\.4 m wide, but boat swamp"):
        GatesEnv(course=env.fleet.course.model_copy(update={"gates": (narrow,)}))


def test_levers_that_are_no_numbers_are_refused() -> None:
    boats = GatesVectorEnv(3)
    boats.reset(seed=0)
    with pytest.raises(UserError, match="boat 1: the levers"):
        boats.step(np.array([[1.0, 0.0], [np.nan, 0.0], [1.0, 0.0]]))


@pytest.mark.parametrize("actions", [np.zeros(2), np.zeros((2, 2)), np.zeros((3, 3))])
def test_actions_of_another_shape_are_refused(actions: Any) -> None:
    boats = GatesVectorEnv(3)
    boats.reset(seed=0)
    with pytest.raises(UserError, match=r"must have the shape \(3, 2\)"):
        boats.step(actions)


@pytest.mark.parametrize(
    "options", [{"episode": [1, 2]}, {"episodes": [1]}, {"episodes": [-1, 2]}, {"episodes": [0.5, 1.0]}]
)
def test_options_of_a_reset_that_make_no_sense_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(UserError, match="reset"):
        GatesVectorEnv(2).reset(options=options)


def test_thrusters_that_the_levers_do_not_drive_can_be_held_and_the_others_not() -> None:
    env = GatesEnv()
    env.reset(seed=0)
    env.fleet.hold(("ss",), -1.0, 0.5)
    env.step(np.array([0.8, 0.0]))
    assert env.fleet.commands[0].tolist() == [0.0, 0.0, -1.0, 0.0, 0.8, 0.8, 0.5, 0.0]
    with pytest.raises(ValueError, match="bs obeys the levers"):
        env.fleet.hold(("bs",), 0.0, 0.0)
