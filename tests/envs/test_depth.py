"""Shallow water in episodes: depth of the course, drawn or as an effect, and boats that touch ground."""

from typing import Any

import numpy as np
import pytest
from swamp_rl.envs.again import same_episode
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.reward import DEFAULTS
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import load_boat
from swamp_rl.boat.squat import clearance
from swamp_rl.course import Course, fitted, limited, load_course
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.errors import UserError
from swamp_rl.pilots.record import replayable
from swamp_rl.runs import Run, RunMeta
from swamp_rl.simulator import parameters, simulate, tank

SWAMP = load_boat("swamp")
BETWEEN = {"uniform": [0.15, 0.3]}


def ahead(throttle: float, steps: int = 60, **task: Any) -> dict[str, Any]:
    """Surges [m/s] of an episode straight ahead, its last reward and info."""
    env = GatesEnv(**task)
    env.reset(seed=1)
    surges, reward, terminated, info = [0.0], 0.0, False, {}
    for _ in range(steps):
        _, reward, terminated, _, info = env.step(np.array([throttle, 0.0]))
        surges.append(float(env.fleet.velocity[0, 0]))
        if info:
            break
    return {"surge": surges, "reward": reward, "terminated": terminated, "info": info}


def test_a_fast_boat_touches_ground_where_a_slow_one_floats() -> None:
    fast, slow = ahead(1.0, depth=0.17), ahead(0.4, depth=0.17)
    assert fast["info"]["outcome"] == "aground" and fast["terminated"]
    assert fast["reward"] < 0.5 - DEFAULTS["failure"]
    assert clearance(SWAMP, fast["surge"][-1], 0.17) <= 0.0 < clearance(SWAMP, fast["surge"][-2], 0.17)
    assert slow["info"] == {} and max(slow["surge"]) > 0.2


def test_a_course_without_a_depth_is_deep_and_shallow_water_slows_a_boat() -> None:
    surges = [ahead(1.0, depth=depth)["surge"][-1] for depth in (0.25, 0.5, 100.0, None)]
    assert surges == sorted(surges) and surges[0] < 0.95 * surges[-1]
    assert surges[-2] == surges[-1]


def test_a_drawn_depth_is_the_same_alone_and_in_a_batch() -> None:
    boats = GatesVectorEnv(300, depth=BETWEEN)
    boats.reset(seed=5)
    depths = boats.fleet.boats["depth"]
    assert 0.15 <= depths.min() < 0.17 and 0.28 < depths.max() < 0.3
    one = GatesEnv(depth=BETWEEN)
    one.reset(seed=5 + 7)
    assert one.fleet.boats["depth"][0] == depths[7]
    for _ in range(40):
        boats.step(np.tile([1.0, 0.1], (300, 1)))
    ended = boats.fleet.boats["outcome"]
    assert len(set(ended.tolist())) > 1


def test_a_constant_depth_leaves_the_draws_of_an_episode_as_they_were() -> None:
    shallow, deep = (GatesVectorEnv(3, disturbances="standard", depth=depth) for depth in (0.3, None))
    for boats in (shallow, deep):
        boats.reset(seed=2)
    assert (shallow.pose == deep.pose).all()
    assert shallow.fleet.drawn(1)["effects"][:-1] == deep.fleet.drawn(1)["effects"]
    assert shallow.fleet.drawn(1)["gust_seed"] == deep.fleet.drawn(1)["gust_seed"]


def test_the_effect_of_a_level_and_the_depth_of_a_course_are_one() -> None:
    draughts = 0.25 / SWAMP.draught
    level = [{"effect": "shallow_water", "depth_over_draught": draughts}]
    assert ahead(1.0, disturbances=level)["surge"] == ahead(1.0, depth=draughts * SWAMP.draught)["surge"]
    boats = GatesVectorEnv(2, disturbances=level)
    boats.reset(seed=1)
    assert boats.fleet.boats["depth"] == pytest.approx(0.25)


def test_a_run_in_shallow_water_is_replayed_from_what_it_tells() -> None:
    boats = GatesVectorEnv(1, depth=BETWEEN, disturbances="standard")
    boats.reset(seed=3)
    message, start = replayable(boats, 0), boats.fleet.boats["state"].copy()
    commands, track = [], [start[0]]
    for _ in range(20):
        boats.step(np.array([[0.4, 0.3]]))
        commands.append(boats.commands[0].copy())
        track.append(boats.fleet.boats["state"][0].copy())
    params = parameters(SWAMP)
    effects = parse_effects(message["disturbances"], "run", SWAMP.thruster_names)
    apply_effects(params, effects, SWAMP.thruster_names)
    seeds = np.array([message["gust_seed"]], np.uint64)
    again = simulate(params, tank(SWAMP), start, np.array([commands]), seeds, 0.1, 1)
    np.testing.assert_array_equal(again[0], track)
    assert message["water_depth"] == boats.fleet.boats["depth"][0]

    poses = np.array(track)[:, :3]
    columns = {"time": 0.1 * np.arange(len(poses))} | dict(
        zip(("north", "east", "heading"), poses.T, strict=True)
    )
    run = Run("r", columns, RunMeta(**message))
    course = limited(fitted(load_course("camogli"), SWAMP.length), None, None, BETWEEN)
    anew = same_episode(run, SWAMP, course, 0.1)(2, ("north",))
    anew.reset(seed=9)
    assert (anew.fleet.boats["depth"] == message["water_depth"]).all()


def test_a_course_for_another_boat_scales_its_depth() -> None:
    course = limited(load_course("camogli"), None, None, 0.3)
    longer = fitted(course, 2.0 * 1.24)
    assert isinstance(longer, Course) and longer.depth is not None
    assert longer.depth.uniform == pytest.approx((0.6, 0.6))


@pytest.mark.parametrize(
    ("task", "message"),
    [
        (
            {"depth": 0.14},
            "course camogli: depth: 0.14 m is no more than the draught of 0.14 m of boat swamp",
        ),
        ({"depth": {"uniform": [0.1, 0.3]}}, "it lies aground; give more depth"),
        ({"depth": {"uniform": [0.3, 0.2]}}, r"depth: uniform must be \[least, most\]"),
        ({"depth": {"normal": [0.3, 0.2]}}, "depth.*unknown key"),
        ({"depth": "shallow"}, r"depth: must be a number \[m\], or"),
        ({"depth": -1.0}, "depth: must be above 0 m, not -1"),
        ({"depth": 0.2, "boat": "esso_osaka"}, "lies aground"),
        ({"depth": 1.0, "boat": "esso_osaka"}, "which no tank towed, is known from 9;"),
        (
            {"depth": 0.3, "disturbances": [{"effect": "shallow_water", "depth_over_draught": 2.0}]},
            "have shallow_water too; give one of the two",
        ),
    ],
)
def test_a_depth_that_does_not_fit_is_refused(task: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        GatesEnv(**task)
