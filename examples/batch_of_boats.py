"""Step 1,024 boats in one compiled loop through `gymnasium.make_vec`.

Prints the boat-steps per second of this machine, and how the episodes ended that ended within 60 s.
"""

import time
from collections import Counter

import gymnasium
import numpy as np

import swamp_rl  # noqa: F401  registers the environments

BOATS, STEPS = 1024, 600  # steps of 0.1 s
SENSES = ("gate_ahead", "gate_starboard", "yaw_rate")

boats = gymnasium.make_vec("swamp/Gates-v1", num_envs=BOATS, disturbances="severe", observation=SENSES)
observation, _ = boats.reset(seed=0)
outcomes: Counter[str] = Counter()
actions = np.ones((BOATS, 2))

begun = time.perf_counter()
for _ in range(STEPS):
    bearing = np.arctan2(observation[:, 1], observation[:, 0])
    actions[:, 1] = np.clip(4.0 * bearing - 0.5 * observation[:, 2], -1.0, 1.0)
    observation, _, _, _, info = boats.step(actions)  # a boat that has ended starts anew by itself
    if "outcome" in info:
        outcomes.update(info["outcome"][info["_outcome"]])
seconds = time.perf_counter() - begun
boats.close()

print(f"{BOATS * STEPS / seconds / 1e6:.2f} million boat-steps per second")
for outcome, count in outcomes.most_common():
    print(f"{outcome}: {count} of {outcomes.total()} episodes")
