"""Logged runs on a course, with what the environment would have shown of its gates."""

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.observation import OBSERVATION, look

from swamp_rl.course import Course, gate_table
from swamp_rl.course.geometry import crosses_gate
from swamp_rl.pilots.demonstrations import NEXT_GATE
from swamp_rl.runs import Run
from swamp_rl.simulator.state import state_size

PLACES = [OBSERVATION.index(name) for name in NEXT_GATE]


def with_gates(run: Run, course: Course) -> Run:
    """The run with NEXT_GATE as further columns, from its poses on `course`; UserError where it has none."""
    seen = gates_seen(run.pose, gate_table(course))
    return Run(run.name, {**run.columns, **dict(zip(NEXT_GATE, seen.T, strict=True))}, run.meta)


def gates_seen(pose: NDArray[np.float64], gates: NDArray[np.float64]) -> NDArray[np.float64]:
    """NEXT_GATE (T, 5) along a track: pose (T, 3) north, east [m], heading [rad]; gates: `gate_table`."""
    still, everything = np.zeros(state_size(0)), np.empty(len(OBSERVATION))
    seen = np.empty((len(pose), len(NEXT_GATE)))
    passed = 0
    for t, (north, east, heading) in enumerate(pose):
        if t and passed < len(gates):
            passed += crosses_gate(pose[t - 1, 0], pose[t - 1, 1], north, east, *gates[passed])
        look((north, east, heading), still, passed, gates, everything)
        seen[t] = everything[PLACES]
    return seen
