"""A pilot of your own, evaluated on a course of your own beside a shipped one.

`Pursuit` steers for a point behind the next gate. It learns nothing, so `train`, `save` and `load` are short;
docs/tutorials/own_pilot_reward_course.md has one that learns. Prints the success of both pilots.
"""

import json
from pathlib import Path

import numpy as np

import swamp_rl

COURSE = """
extends: camogli
name: slalom
gates:
  - {name: first, centre: {north: 8.0, east: -3.0}, heading: 0.0, width: 4.0}
  - {name: second, centre: {north: 16.0, east: 3.0}, heading: 0.0, width: 4.0}
  - {name: third, centre: {north: 25.0, east: -2.0}, heading: 0.0, width: 4.0}
"""
EXPERIMENT = """
name: slalom
boat: swamp
course: slalom.yaml
pilots:
  line-of-sight: {kind: line-of-sight}
  pursuit: {kind: 'own_pilot:Pursuit'}
evaluation: {levels: [calm, standard], episodes: 50, seed: 1, shown: 5}
"""


class Pursuit:
    """Full throttle, angle proportional to the bearing of a point `beyond` [m] behind the gate."""

    senses = ("gate_ahead", "gate_starboard", "gate_cos", "gate_sin", "yaw_rate")
    from_runs = False
    beyond = 1.0

    @classmethod
    def train(cls, training):
        return cls()

    def save(self, folder):
        (folder / "note.txt").write_text("nothing was learned\n")

    @classmethod
    def load(cls, folder, settings):
        return cls()

    def reset(self, n):
        """It remembers nothing."""

    def act(self, observation):
        ahead, starboard, cos, sin, yaw_rate = np.asarray(observation).T
        bearing = np.arctan2(starboard + self.beyond * sin, ahead + self.beyond * cos)
        return np.column_stack([np.ones(len(bearing)), np.clip(4.0 * bearing - 0.5 * yaw_rate, -1.0, 1.0)])


if __name__ == "__main__":
    Path("slalom.yaml").write_text(COURSE)
    Path("slalom_experiment.yaml").write_text(EXPERIMENT)
    folder = swamp_rl.run_experiment("slalom_experiment.yaml", out="results/example_slalom")
    for name, pilot in json.loads((folder / "results.json").read_text())["pilots"].items():
        print(name, {level: f"{one['success_rate']:.0%}" for level, one in pilot["levels"].items()})
