"""Commands that act late and sensors that err: the environment flies the boat that its file describes."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.errors import UserError
from swamp_rl.simulator import simulate, tank
from swamp_rl.simulator.sensors import observe

Array = NDArray[Any]

SWAMP = load_boat("swamp")
LATE = {"effect": "command_delay", "delay": 0.37}
SENSORS = [
    {"effect": "heading_bias", "bias": 0.1},
    {"effect": "position_delay", "delay": 0.44},
    {"effect": "position_lever_arm", "x": 0.3, "y": -0.2},
    {"effect": "heading_drift", "rate": 0.01},
    {"effect": "gyro_bias", "bias": -0.05},
]
DRAWN = [
    {"effect": "command_delay", "delay": {"uniform": [0.0, 2.0]}, "probability": 0.7},
    {"effect": "heading_bias", "bias": {"uniform": [-0.2, 0.2]}},
    {"effect": "position_delay", "delay": {"uniform": [0.0, 2.0]}, "probability": 0.7},
    {"effect": "position_lever_arm", "x": {"uniform": [-0.5, 0.5]}, "y": {"uniform": [-0.5, 0.5]}},
    {"effect": "gyro_bias", "bias": {"uniform": [-0.05, 0.05]}},
    {"effect": "heading_drift", "rate": {"uniform": [-0.01, 0.01]}},
    {"effect": "current", "disc": 0.2},
]
STEPS = 80


def swamp_with(effects: list[dict[str, Any]]) -> Boat:
    return SWAMP.model_copy(update={"effects": parse_effects(effects, "test", SWAMP.thruster_names)})


def hands(n: int) -> Array:
    """Levers (STEPS, n, 2) of unsteady hands."""
    return np.random.default_rng(5).uniform([0.2, -1.0], [1.0, 1.0], (STEPS, n, 2))


def sailed(boats: GatesVectorEnv, levers: Array) -> dict[str, Array]:
    """What happened to the episodes of seeds 0, 1, ... under `levers`, each (n, T or T + 1, .)."""
    first, _ = boats.reset(options={"episodes": np.arange(boats.num_envs)})
    kept = {name: [] for name in ("reward", "over", "command")}
    kept |= {"seen": [first], "state": [boats.fleet.boats["state"].copy()], "sensed": [boats.sensed_pose]}
    for lever in levers:
        seen, reward, terminated, truncated, _ = boats.step(lever)
        now = {"seen": seen, "reward": reward, "over": terminated | truncated, "sensed": boats.sensed_pose}
        now |= {"command": boats.commands.copy(), "state": boats.fleet.boats["state"].copy()}
        for name, value in now.items():
            kept[name].append(value)
    return {name: np.stack(values, axis=1) for name, values in kept.items()}


@pytest.mark.parametrize("of_the_boat", [True, False])
def test_commands_act_as_late_as_in_a_replay_of_them(of_the_boat: bool) -> None:
    late = {"boat": swamp_with([LATE])} if of_the_boat else {"disturbances": [LATE]}
    boats = GatesVectorEnv(2, **late)
    run = sailed(boats, hands(2)[:40])
    assert not run["over"].any()
    fleet = boats.fleet
    replayed = simulate(
        fleet.params, tank(SWAMP), run["state"][:, 0], run["command"], fleet.boats["gust_seed"], 0.1, 1
    )
    assert run["state"] == pytest.approx(replayed, abs=1e-9)
    prompt = sailed(GatesVectorEnv(2), hands(2)[:40])["state"]
    assert np.abs(run["state"] - prompt)[..., :2].max() > 0.05


def test_an_observation_is_what_the_sensors_say_of_the_track() -> None:
    boats = GatesVectorEnv(2, boat=swamp_with(SENSORS))
    run = sailed(boats, hands(2)[:40])
    assert not run["over"].any()
    measured = observe(run["state"], boats.fleet.params, 0.1)
    assert run["sensed"] == pytest.approx(measured[..., :3], abs=1e-9)
    heading = measured[..., 2]
    pose = np.stack([measured[..., 0], measured[..., 1], np.cos(heading), np.sin(heading)], axis=-1)
    assert run["seen"][..., :4] == pytest.approx(pose, abs=1e-5)  # float32
    assert run["seen"][..., 4:7] == pytest.approx(measured[..., 3:], abs=1e-6)
    gate = boats.fleet.course.gates[0].centre
    away = np.array([gate.north, gate.east]) - measured[..., :2]
    ahead = away[..., 0] * np.cos(heading) + away[..., 1] * np.sin(heading)
    assert run["seen"][..., 7] == pytest.approx(ahead, abs=1e-5)


def test_the_course_judges_where_the_boat_is_and_not_where_it_thinks_it_is() -> None:
    far_off = [{"effect": "position_lever_arm", "x": 0.0, "y": 6.0}, *SENSORS[:2]]
    straight = np.tile([1.0, 0.0], (120, 3, 1))
    believed, true = (sailed(GatesVectorEnv(3, boat=boat), straight) for boat in (swamp_with(far_off), SWAMP))
    assert (true["seen"][:, -1, 11] > 0).any()
    for name in ("state", "reward", "over"):
        np.testing.assert_array_equal(believed[name], true[name])
    np.testing.assert_array_equal(believed["seen"][..., 11], true["seen"][..., 11])
    assert np.abs(believed["seen"][..., :2] - true["seen"][..., :2]).max() > 5.0


def test_one_boat_and_a_batch_agree_when_every_delay_and_sensor_is_drawn() -> None:
    sailed(GatesVectorEnv(300), hands(300)[:2])  # the code for plain boats must not be taken for these
    levers = hands(300)
    many = sailed(GatesVectorEnv(300, disturbances=DRAWN), levers)
    for i in (0, 7, 299):
        env = GatesEnv(disturbances=DRAWN)
        seen = [env.reset(seed=i)[0]]
        for lever in levers[:, i]:
            observation, _, terminated, truncated, _ = env.step(lever)
            seen.append(observation)
            if terminated or truncated:
                break
        assert np.array_equal(np.array(seen), many["seen"][i, : len(seen)])
    assert (many["sensed"] != many["state"][..., :3]).any(axis=(1, 2)).all()


def test_an_episode_remembers_nothing_of_the_one_before() -> None:
    env = GatesEnv(disturbances=DRAWN)

    def episode() -> Array:
        first, _ = env.reset(seed=3)
        return np.array([first, *(env.step(lever)[0] for lever in hands(1)[:30, 0])])

    fresh = episode()
    env.reset(seed=8)
    for lever in hands(1)[:50, 0]:
        env.step(lever)
    assert np.array_equal(episode(), fresh)


def test_a_level_with_shallow_water_is_refused_for_a_boat_that_no_tank_towed() -> None:
    shallow = [{"effect": "shallow_water", "depth_over_draught": 3.0}]
    with pytest.raises(UserError, match=r"disturbances effects: shallow_water .* esso_osaka"):
        GatesEnv(boat="esso_osaka", disturbances=shallow)


def test_a_boat_file_with_such_effects_is_flown_by_its_name_alone(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(
        "extends: swamp\neffects:\n"
        "  - {effect: command_delay, delay: 0.5}\n"
        "  - {effect: heading_bias, bias: 0.2}\n"
    )
    env = gymnasium.make("swamp/Gates-v1", boat=str(file))
    seen, _ = env.reset(seed=0)
    true_heading = env.unwrapped.fleet.pose[0, 2]  # type: ignore[attr-defined]
    assert np.arctan2(seen[3], seen[2]) == pytest.approx(true_heading + 0.2, abs=1e-6)
