"""How an episode is judged and paid: gates, buoys, bounds, time, and the mirror image of it all."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from swamp_rl.envs.reward import DEFAULTS
from swamp_rl.envs.single import GatesEnv

from swamp_rl.course import Course, Gate, Point, Pose, Start, gate_table, load_course
from swamp_rl.course.progress import distance_to_go

STILL = Pose(north=0.0, east=0.0, heading=0.0)


def course(
    north: float = 0.0,
    east: float = 0.0,
    heading: float = 0.0,
    gates: tuple[tuple[float, float, float], ...] = ((8.0, 0.0, 0.0), (22.0, 8.0, 0.0)),
    time_limit: float = 60.0,
) -> Course:
    """Camogli with another start, drawn without spread, and other gates (north, east, heading)."""
    start = Start(pose=Pose(north=north, east=east, heading=heading), spread=STILL)
    made = tuple(
        Gate(name=str(i), centre=Point(north=n, east=e), heading=h, width=4.0)
        for i, (n, e, h) in enumerate(gates)
    )
    return load_course("camogli").model_copy(update={"start": start, "gates": made, "time_limit": time_limit})


def ahead(t: float) -> tuple[float, float]:
    """Full throttle, straight on."""
    return 1.0, 0.0


def sail(
    course: Course, hand: Callable[[float], tuple[float, float]] = ahead
) -> tuple[list[Any], list[float], dict[str, Any]]:
    """Observations, the first included, rewards and last info of an episode driven by `hand`(time)."""
    env = GatesEnv(course=course)
    seen, rewards = [env.reset(seed=0)[0]], []
    while True:
        observation, reward, terminated, truncated, info = env.step(np.array(hand(0.1 * len(rewards))))
        seen.append(observation)
        rewards.append(reward)
        if terminated or truncated:
            return seen, rewards, info | {"terminated": terminated}


def test_passing_the_only_gate_is_a_success() -> None:
    seen, _, info = sail(course(gates=((8.0, 0.0, 0.0),)))
    assert info["outcome"] == "success" and info["terminated"]
    assert seen[-2][0] < 8.0 <= seen[-1][0] and seen[-1][11] == 1.0
    assert info["time"] == pytest.approx(0.1 * (len(seen) - 1))


def test_a_gate_passed_the_wrong_way_does_not_count() -> None:
    seen, _, info = sail(course(north=12.0, heading=math.pi, gates=((8.0, 0.0, 0.0),)))
    assert min(s[0] for s in seen) < 0.0
    assert info["outcome"] == "out_of_bounds" and seen[-1][11] == 0.0


def test_gates_count_only_in_their_order() -> None:
    seen, _, info = sail(course(gates=((20.0, 0.0, 0.0), (8.0, 0.0, 0.0))))
    passed_at = next(s[0] for s in seen if s[11] == 1.0)
    assert passed_at == pytest.approx(20.0, abs=0.2)
    assert info["outcome"] == "out_of_bounds" and seen[-1][11] == 1.0


@pytest.mark.parametrize(
    ("east", "outcome"),
    [(0.0, "success"), (1.2, "success"), (1.3, "buoy"), (-2.7, "buoy"), (2.8, "out_of_bounds")],
)
def test_a_boat_passes_between_the_buoys_touches_one_or_misses_the_gate(east: float, outcome: str) -> None:
    # The buoys stand 2 m from the middle; the boat, 1.10 m broad, touches their 0.2 m within 0.75 m.
    assert sail(course(east=east, gates=((8.0, 0.0, 0.0),)))[2]["outcome"] == outcome


def test_time_out_truncates_at_the_limit() -> None:
    seen, _, info = sail(course(time_limit=2.0), lambda t: (0.0, 0.0))
    assert (info["outcome"], info["terminated"], len(seen) - 1) == ("timeout", False, 20)


def test_the_reward_of_a_whole_run_depends_on_its_ends_its_gates_its_levers_and_its_time() -> None:
    def hand(t: float) -> tuple[float, float]:
        return 0.7 + 0.3 * math.sin(t), 0.05 * math.sin(0.7 * t)

    there = course()
    seen, rewards, info = sail(there, hand)
    gates = gate_table(there)
    passed = int(seen[-1][11])
    way = distance_to_go(0.0, 0.0, 0, gates) - distance_to_go(
        float(seen[-1][0]), float(seen[-1][1]), passed, gates
    )
    levers = np.array([(0.0, 0.0), *(hand(0.1 * j) for j in range(len(rewards)))])
    effort = DEFAULTS["effort"] * 0.1 * np.sum(levers[1:, 0] ** 2)
    change = DEFAULTS["change"] / 0.1 * np.sum(np.diff(levers, axis=0) ** 2)
    failure = DEFAULTS["failure"] if info["outcome"] in ("buoy", "out_of_bounds") else 0.0
    spent = effort + change + DEFAULTS["time"] * info["time"]
    assert passed == 1
    gained = DEFAULTS["progress"] * way + DEFAULTS["gate"] * passed
    assert sum(rewards) == pytest.approx(gained - spent - failure, abs=1e-5)


def test_the_mirrored_course_with_mirrored_levers_gives_the_mirrored_run() -> None:
    def hand(t: float) -> tuple[float, float]:
        return 1.0, 0.3 * math.sin(0.5 * t) + 0.05

    here = course(east=0.1, heading=0.2, gates=((8.0, 0.5, 0.3), (22.0, 8.0, 0.0)))
    there = course(east=-0.1, heading=-0.2, gates=((8.0, -0.5, -0.3), (22.0, -8.0, 0.0)))
    there = there.model_copy(
        update={
            "bounds": here.bounds.model_copy(update={"west": -here.bounds.east, "east": -here.bounds.west})
        }
    )
    seen, rewards, info = sail(here, hand)
    mirrored, paid, ended = sail(there, lambda t: (1.0, -hand(t)[1]))
    sign = np.array([1, -1, 1, -1, 1, -1, -1, 1, -1, 1, -1, 1])
    assert info == ended
    assert rewards == pytest.approx(paid, abs=1e-9)
    assert np.array(seen) == pytest.approx(np.array(mirrored) * sign, abs=1e-9)
