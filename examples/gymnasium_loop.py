"""Drive one boat through `gymnasium.make` with a controller of three lines.

The controller steers for the middle of the next gate: the angle is proportional to the bearing, less a
multiple of the yaw rate. Prints the outcome, the time and the sum of rewards of five seeded episodes.
"""

import gymnasium
import numpy as np

import swamp_rl  # noqa: F401  registers the environments

SENSES = ("gate_ahead", "gate_starboard", "yaw_rate")
GAIN, DAMPING = 4.0, 0.5  # 1/rad, s/rad

env = gymnasium.make("swamp/Gates-v1", disturbances="standard", observation=SENSES)
for seed in range(5):
    observation, info = env.reset(seed=seed)
    over, total = False, 0.0
    while not over:
        ahead, starboard, yaw_rate = observation
        angle = np.clip(GAIN * np.arctan2(starboard, ahead) - DAMPING * yaw_rate, -1.0, 1.0)
        observation, reward, terminated, truncated, info = env.step(np.array([1.0, angle]))
        over, total = terminated or truncated, total + reward
    print(f"seed {seed}: {info['outcome']} after {info['time']:.1f} s, return {total:.2f}")
env.close()
