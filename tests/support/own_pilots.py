"""The module of a pilot of the user's own, as text."""

MODULE = """
import numpy as np

class Ahead:
    senses = ("gate_ahead",)

    @classmethod
    def train(cls, training):
        return cls()

    def save(self, folder):
        (folder / "nothing.txt").write_text("")

    @classmethod
    def load(cls, folder, settings):
        {load}

    def reset(self, n):
        pass

    def act(self, observation):
        return np.tile([{throttle}, 0.0], (len(observation), 1))

    from_runs = False
"""


def own_pilot_module(throttle: float = 1.0, load: str = "return cls()") -> str:
    """A module of the class Ahead, which goes ahead at `throttle`; load: the body of its `load`, line 16."""
    return MODULE.format(throttle=throttle, load=load)
