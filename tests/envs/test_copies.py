"""An environment that is copied or pickled under way goes on as the original does."""

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.single import GatesEnv

DISTURBED: dict[str, Any] = {"disturbances": "severe", "time_limit": 2.0}


@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
@pytest.mark.parametrize("make", [lambda: GatesEnv(**DISTURBED), lambda: GatesVectorEnv(2, **DISTURBED)])
def test_a_copy_made_under_way_goes_on_as_the_original(
    make: Callable[[], Any], duplicate: Callable[[Any], Any]
) -> None:
    env = make()
    env.reset(seed=3)
    levers = np.broadcast_to([1.0, 0.2], env.action_space.shape)
    for _ in range(5):
        env.step(levers)
    other = duplicate(env)
    for _ in range(20):
        ours, theirs = env.step(levers), other.step(levers)
        assert np.array_equal(ours[0], theirs[0])
        assert np.array_equal(ours[1], theirs[1])
        assert np.array_equal(env.fleet.pose, other.fleet.pose)
        assert np.array_equal(env.fleet.applied, other.fleet.applied)
    assert np.array_equal(env.reset()[0], other.reset()[0])
