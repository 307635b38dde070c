"""What a logged run would have seen of the gates is what the environment showed when it was driven."""

import math

import numpy as np
import pytest
from swamp_rl.envs.hindsight import with_gates
from swamp_rl.envs.single import GatesEnv

from swamp_rl.course import load_course
from swamp_rl.errors import UserError
from swamp_rl.pilots.demonstrations import NEXT_GATE, observed
from swamp_rl.runs import Run


def test_the_gates_of_a_logged_run_are_those_that_its_pilot_saw() -> None:
    env = GatesEnv(disturbances="standard", observation=NEXT_GATE)
    env.reset(seed=3)
    env.fleet.boats["state"][0, :3] = [6.5, 0.1, 0.2]
    seen: list[np.ndarray] = []
    poses: list[np.ndarray] = []
    ended = False
    while not ended and len(seen) < 150:
        poses.append(env.fleet.pose[0].copy())
        observation, _, terminated, truncated, _ = env.step(np.array([1.0, 0.1 * math.sin(0.1 * len(seen))]))
        seen.append(observation)
        ended = terminated or truncated
    poses.append(env.fleet.pose[0].copy())
    track = np.array(poses)
    columns = dict(zip(("north", "east", "heading"), track.T, strict=True)) | {"time": np.arange(len(track))}
    again = observed(with_gates(Run("driven", columns), load_course("camogli")), NEXT_GATE)
    assert again[0, 4] == 0.0 and again[-1, 4] == 1.0
    np.testing.assert_allclose(again[1:], np.array(seen), atol=1e-4)


def test_a_run_without_a_pose_is_refused() -> None:
    with pytest.raises(UserError, match="heading"):
        with_gates(Run("blind", {"north": np.zeros(3), "east": np.zeros(3)}), load_course("camogli"))
