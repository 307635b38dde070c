"""How a logged track ended is as the environment recorded it."""

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.course.outcome import outcome_of, passes_in_a_step
from swamp_rl.evaluation.rollout import drive
from swamp_rl.pilots.scripted import ScriptedPilot

BREADTH, COURSE, STEP = load_boat("swamp").breadth, load_course("camogli"), 0.1


class Steady:
    """Holds levers that it draws once for each boat."""

    senses = ("north",)

    def reset(self, n: int) -> None:
        rng = np.random.default_rng(4)
        self.levers = np.column_stack([rng.uniform(0.1, 1.0, n), rng.normal(0.0, 0.12, n)])

    def keep(self, boats: NDArray[np.intp]) -> None:
        self.levers = self.levers[boats]

    def act(self, observation: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.levers


def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
    return GatesVectorEnv(n, disturbances="severe", observation=senses, step=STEP)


def test_a_logged_track_ends_as_the_environment_judged_it() -> None:
    seen = set()
    for pilot in (Steady(), ScriptedPilot(0, None, STEP)):
        flown = drive(pilot, boats, np.arange(40))
        for i, judged in enumerate(flown.outcome.tolist()):
            track = flown.track(i)[:, :2]
            assert outcome_of(np.arange(len(track)) * STEP, track, COURSE, BREADTH) == judged
            seen.add(judged)
    assert seen == {"success", "buoy", "out_of_bounds", "timeout"}


def test_a_track_that_stops_on_its_way_is_incomplete() -> None:
    start = COURSE.start.pose
    track = np.array([[start.north, start.east], [start.north + 0.1, start.east]])
    assert outcome_of(np.array([0.0, 0.1]), track, COURSE, BREADTH) == "incomplete"


def test_a_log_without_the_state_after_the_last_action_lacks_a_step_to_the_last_gate() -> None:
    flown = drive(ScriptedPilot(0, None, STEP), boats, np.arange(20))
    lacking = {}
    for rows in (1, 2):
        tracks = [flown.track(i)[:-rows, :2] for i in range(20)]
        times = [np.arange(len(track)) * STEP for track in tracks]
        pairs = list(zip(times, tracks, strict=True))
        assert {outcome_of(*pair, COURSE, BREADTH) for pair in pairs} == {"incomplete"}
        lacking[rows] = [passes_in_a_step(*pair, COURSE, BREADTH) for pair in pairs]
    assert lacking[1] == (flown.outcome == "success").tolist() and 0 < sum(lacking[1]) < 20
    assert not any(lacking[2])
    assert not passes_in_a_step(np.zeros(1), np.zeros((1, 2)), COURSE, BREADTH)
