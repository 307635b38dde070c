"""What is rewarded, observed and allowed is given to the environment, built-in terms and one's own."""

import math
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.observation import NAMES, OBSERVATION
from swamp_rl.envs.reward import DEFAULTS
from swamp_rl.envs.single import GatesEnv

import swamp_rl  # noqa: F401  registers
from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.errors import UserError
from swamp_rl.evaluation import drive, episode_table
from swamp_rl.pilots.line_of_sight import LineOfSightPilot

NOTHING = dict.fromkeys(DEFAULTS, 0.0)
WEATHER: list[dict[str, Any]] = [
    {"effect": "wind", "speed": 5.0, "from": math.pi / 2},
    {"effect": "current", "north": 0.2, "east": -0.1},
]
OWN = """
import numpy as np

def speed(batch):
    return np.hypot(batch.velocity[:, 0], batch.velocity[:, 1])

def first_gate(batch):
    return (batch.gates_now > 0) & (batch.gates_passed == 1)

def way(batch):
    return batch.way_made

def steered(batch):
    return np.abs(batch.action[:, 1] - batch.last_action[:, 1])

def weather(batch):
    return batch.wind[:, 0] + 10.0 * batch.current[:, 1]

def wide(batch):
    return batch.pose

def endless(batch):
    return np.full(len(batch.time), np.inf)

def broken(batch):
    return batch.depth

speed.bounds = (0.0, 10.0)
steered.bounds = (0.0, 0.25)
weather.bounds = (1.0, 0.0)
number = 3
"""


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A module `own_terms_of_a_test` on the path."""
    (tmp_path / "own_terms_of_a_test.py").write_text(OWN)
    monkeypatch.syspath_prepend(str(tmp_path))


def named(term: str) -> str:
    return f"own_terms_of_a_test:{term}"


def driven(env: GatesEnv, steps: int = 400, seed: int = 1) -> dict[str, Any]:
    """Observations, rewards and the last info of an episode of line-of-sight steering."""
    pilot = LineOfSightPilot()
    seen, _ = env.reset(seed=seed)
    rows, rewards, actions, info = [seen], [], [], {}
    places = [env.task.observed.names.index(name) for name in pilot.senses]
    for _ in range(steps):
        actions.append(pilot.act(seen[None, places])[0])
        seen, reward, over, cut, info = env.step(actions[-1])
        rows.append(seen)
        rewards.append(reward)
        if over or cut:
            break
    return {"seen": np.array(rows), "rewards": np.array(rewards), "actions": np.array(actions), "info": info}


def paid(term: str, level: str = "standard") -> np.ndarray:
    """Rewards of an episode of which only one term counts, by 1."""
    return driven(GatesEnv(disturbances=level, reward={**NOTHING, term: 1.0}))["rewards"]


def test_each_term_counts_what_its_table_says() -> None:
    env = GatesEnv(disturbances="standard")
    result = driven(env)
    throttle = result["actions"][:, 0]
    changes = np.diff(np.vstack([[0.0, 0.0], result["actions"]]), axis=0)
    assert result["info"]["outcome"] == "success"
    assert paid("gate").sum() == len(env.fleet.course.gates)
    assert paid("success").sum() == 1.0 and paid("success")[-1] == 1.0
    assert paid("failure").sum() == 0.0
    np.testing.assert_allclose(paid("time"), -0.1)
    np.testing.assert_allclose(paid("effort"), -0.1 * throttle**2)
    np.testing.assert_allclose(paid("change"), -(changes**2).sum(axis=1) / 0.1, rtol=1e-9)
    everything = sum(DEFAULTS[term] * paid(term) for term in DEFAULTS if DEFAULTS[term])
    np.testing.assert_allclose(result["rewards"], everything, atol=1e-12)


def test_the_distance_from_the_gates_middle_line_is_a_cost() -> None:
    result = driven(GatesEnv(disturbances="calm"))
    seen = {name: result["seen"][1:, i] for i, name in enumerate(OBSERVATION)}
    gates = {0: 0.0, 1: 8.0}  # east of the middle, both headed north
    before = result["seen"][:-1, OBSERVATION.index("gates_passed")]
    off = np.abs(seen["east"] - np.array([gates[int(passed)] for passed in before]))
    np.testing.assert_allclose(paid("cross_track", "calm"), -0.1 * off, atol=1e-6)


@pytest.mark.parametrize(("boat", "level"), [("swamp", "severe"), ("esso_osaka", "calm")])
def test_the_energy_that_is_rewarded_is_the_energy_that_is_reported(boat: str, level: str) -> None:
    reward = {**NOTHING, "energy": 1.0}

    def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
        return GatesVectorEnv(n, boat=boat, disturbances=level, observation=senses, reward=reward)

    table = episode_table(drive(LineOfSightPilot(), boats, np.arange(4)), load_boat(boat), 0.1)
    np.testing.assert_allclose(-table["return"], table["energy"], rtol=1e-9)


def test_wind_current_last_action_and_time_left_can_be_observed() -> None:
    names = NAMES[len(OBSERVATION) :]
    env = GatesEnv(disturbances=WEATHER, observation=[*names, "cos_heading", "sin_heading"], time_limit=60.0)
    env.reset(seed=3)
    rows = [env.step(np.array([0.5, 0.8]))[0].astype(float) for _ in range(20)]
    seen = dict(zip([*names, "cos", "sin"], rows[-1], strict=True))
    turn = complex(seen["cos"], -seen["sin"])  # from north and east to ahead and starboard
    wind, current = complex(0.0, -5.0) * turn, complex(0.2, -0.1) * turn
    assert (seen["wind_ahead"], seen["wind_starboard"]) == pytest.approx((wind.real, wind.imag), abs=1e-5)
    assert (seen["current_ahead"], seen["current_starboard"]) == pytest.approx(
        (current.real, current.imag), abs=1e-6
    )
    assert (seen["last_throttle"], seen["last_angle"]) == pytest.approx((0.5, 0.8))
    assert seen["time_left"] == pytest.approx(58.0)
    assert env.observation_space.contains(rows[-1].astype(np.float32))


def test_the_time_left_is_within_its_bounds_where_the_limit_is_no_multiple_of_the_step() -> None:
    env = GatesEnv(observation=["time_left"], time_limit=10.0, step=0.3)
    seen, _ = env.reset(seed=0)
    assert seen == env.observation_space.high == pytest.approx(34 * 0.3)


def test_a_time_limit_and_bounds_take_the_place_of_the_courses() -> None:
    env = GatesEnv(time_limit=2.0)
    env.reset(seed=0)
    ended = [env.step(np.zeros(2))[2:] for _ in range(20)]
    assert [cut for _, cut, _ in ended] == [False] * 19 + [True]
    assert ended[-1][2] == {"outcome": "timeout", "time": 2.0}
    narrow = GatesEnv(bounds={"south": -0.7})
    assert narrow.fleet.course.bounds.north == load_course("camogli").bounds.north
    narrow.reset(seed=0)
    narrow.fleet.boats["state"][0, 0] = -0.8
    assert narrow.step(np.zeros(2))[4]["outcome"] == "out_of_bounds"


def test_the_time_of_an_end_is_a_number_of_steps_without_the_error_of_their_product() -> None:
    env = GatesEnv(time_limit=12.7)
    env.reset(seed=0)
    ended = [env.step(np.zeros(2)) for _ in range(127)]
    assert ended[-1][4]["time"] == 12.7


def test_gymnasiums_own_limit_of_steps_holds_alone_and_in_a_batch() -> None:
    env = gymnasium.make("swamp/Gates-v1", max_episode_steps=7)
    boats: Any = gymnasium.make_vec("swamp/Gates-v1", num_envs=2, max_episode_steps=7)
    env.reset(seed=0)
    boats.reset(seed=0)
    alone = [env.step(np.zeros(2))[3] for _ in range(7)]
    together = [boats.step(np.zeros((2, 2)))[3].tolist() for _ in range(7)]
    assert alone == [False] * 6 + [True]
    assert together == [[cut] * 2 for cut in alone]


def test_terms_of_ones_own_are_paid_and_observed_alone_and_in_a_batch() -> None:
    reward = {**NOTHING, named("first_gate"): 5.0, named("way"): -1.0}
    senses = [*OBSERVATION, named("speed"), "wind_ahead"]
    arguments: dict[str, Any] = {"reward": reward, "observation": senses, "disturbances": "standard"}
    result = driven(env := GatesEnv(**arguments))
    expected = -paid("progress")
    expected[np.argmax(paid("gate") > 0)] += 5.0
    np.testing.assert_allclose(result["rewards"], expected, atol=1e-9)
    surge, sway, speed = (result["seen"][:, i] for i in (4, 5, 12))
    np.testing.assert_allclose(speed, np.hypot(surge, sway), rtol=1e-6)
    assert (env.observation_space.low[12], env.observation_space.high[12]) == (0.0, 10.0)

    boats = GatesVectorEnv(2, autoreset_mode="SameStep", **arguments)
    boats.reset(seed=0)
    for t, action in enumerate(result["actions"]):
        observation, rewards, *_, info = boats.step(np.array([[0.0, 0.0], action]))
        assert rewards[1] == result["rewards"][t]
    np.testing.assert_array_equal(info["final_obs"][1], result["seen"][-1])
    assert observation[1, 12] == 0.0  # of the boat that has started anew


def test_a_boat_that_is_only_started_anew_is_paid_nothing() -> None:
    boats = GatesVectorEnv(1, time_limit=1.0, reward={**NOTHING, named("speed"): 1.0})
    boats.reset(seed=0)
    rewards = [boats.step(np.ones((1, 2)))[1][0] for _ in range(12)]
    assert min(rewards[:10]) > 0.0
    assert rewards[10] == 0.0 and rewards[11] > 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"reward": {"gat": 1.0}}, "reward: no term 'gat'; did you mean 'gate'"),
        ({"reward": {"gat": 1.0}}, "progress [1/m]"),
        ({"reward": {"gate": math.nan}}, "reward: gate: the weight must be a finite number"),
        ({"reward": {"gate": "much"}}, "reward: gate: the weight must be a finite number"),
        ({"reward": ["gate"]}, "reward: must be weights by name"),
        ({"reward": {drive: 1.0}}, "given by its name as text, 'swamp_rl.evaluation.rollout:drive'"),
        ({"reward": lambda batch: batch.time}, "'module:function' of one made by def"),
        ({"observation": [drive]}, "given by its name as text, 'swamp_rl.evaluation.rollout:drive'"),
        ({"reward": {"no_such_module:term": 1.0}}, "reward: no_such_module:term: cannot be imported"),
        ({"reward": {named("nobody"): 1.0}}, "nobody"),
        ({"reward": {named("number"): 1.0}}, "is not a function"),
        ({"observation": ["wind_ahaed"]}, "did you mean 'wind_ahead'"),
        ({"observation": [named("weather")]}, "bounds: the first must be below the second"),
        ({"time_limit": 0.5}, "time_limit"),
        ({"time_limit": "long"}, "time_limit"),
        ({"bounds": {"nroth": 40.0}}, "did you mean 'north'"),
        ({"bounds": {"south": 5.0}}, "the start, with its spread, is not inside bounds"),
        ({"bounds": 5}, "bounds: must be edges by name"),
        ({"max_episode_steps": 0}, "max_episode_steps: must be a whole number"),
        ({"rewards": {}}, "unknown argument 'rewards'; did you mean 'reward'"),
    ],
)
def test_a_wrong_term_weight_or_limit_is_one_line(arguments: dict[str, Any], message: str) -> None:
    for make in (GatesEnv, GatesVectorEnv):
        with pytest.raises(UserError) as error:
            make(**arguments)
        assert message in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("make", "own"),
    [(GatesEnv, ["render_mode"]), (GatesVectorEnv, ["num_envs", "render_mode", "autoreset_mode"])],
)
def test_the_known_arguments_hold_those_of_the_environment_itself(make: Any, own: list[str]) -> None:
    with pytest.raises(UserError, match="unknown argument 'x'") as error:
        make(x=1)
    assert all(name in str(error.value) for name in ("max_episode_steps", *own))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"reward": {named("wide"): 1.0}}, r"wide: gave the shape \(1, 3\) of float64, \(1,\) of numbers"),
        ({"reward": {named("endless"): 1.0}}, "endless: gave inf for a boat"),
        ({"reward": {named("broken"): 1.0}}, "broken: failed .*no attribute 'depth'"),
        ({"observation": [named("steered")]}, r"steered: gave 1 to 1, outside of its bounds 0 to 0\.25"),
    ],
)
def test_what_a_term_gives_is_looked_at_and_the_term_is_named(
    arguments: dict[str, Any], message: str
) -> None:
    env = GatesEnv(**arguments)
    env.reset(seed=0)
    with pytest.raises(UserError, match=message):
        env.step(np.array([1.0, 1.0]))
