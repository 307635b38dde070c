"""Commands that are held for some seconds each: those that the next trial is chosen from."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.model.manoeuvres import command_bounds, manoeuvres
from swamp_rl.criticism.options import options
from swamp_rl.simulator import parameters
from swamp_rl.simulator.substeps import steps_over

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CommandFamily:
    """Sequences of n commands (n, 2K), each held for `hold` rows, of `length` rows in all.

    palette: (P, 2K) commands of the fixed manoeuvres and of their mirror images; low, high: (2K,) bounds.
    """

    hold: int
    length: int
    palette: Array
    low: Array
    high: Array

    @property
    def count(self) -> int:
        """n."""
        return math.ceil(self.length / self.hold)

    def begun(self, rows: Array) -> Array:
        """Commands (W, T, 2K) within the bounds, without throttle for the first `hold` rows: the thrusters
        turn to their first angles, so that the trial does not depend on where they were.
        """
        made = np.clip(rows, self.low, self.high)
        made[:, : self.hold, len(self.low) // 2 :] = 0.0
        return made

    def rows(self, sequences: Array) -> Array:
        """(W, T, 2K) a command for each row, of sequences (W, n, 2K)."""
        return self.begun(np.repeat(sequences, self.hold, axis=1)[:, : self.length])

    def sampled(self, rows: Array) -> Array:
        """(W, n, 2K) sequences with the commands of rows (W, T, 2K) in the middle of each hold."""
        middle = np.minimum(np.arange(self.count) * self.hold + self.hold // 2, self.length - 1)
        return rows[:, middle]

    def random(self, rng: np.random.Generator, count: int) -> Array:
        """(count, n, 2K) sequences whose blocks are of the palette."""
        made = np.zeros((count, self.count, len(self.low)))
        for one in made:
            place = 0
            while place < self.count:
                size = int(rng.integers(1, options().trial_block + 1))
                one[place : place + size] = self._of_palette(rng)
                place += size
        return made

    def exchanged(self, sequence: Array, rng: np.random.Generator) -> Array:
        """(n, 2K) the sequence with one block of commands replaced, of all thrusters or of one."""
        made = sequence.copy()
        size = int(rng.integers(1, options().trial_block + 1))
        place = int(rng.integers(0, max(1, self.count - size + 1)))
        block = made[place : place + size]
        if rng.random() < options().trial_whole_boat:
            block[:] = self._of_palette(rng)
            return made
        thrusters = len(self.low) // 2
        one = int(rng.integers(thrusters))
        turns = round(2.0 * math.pi / options().trial_angle_step)
        angle = options().trial_angle_step * (int(rng.integers(turns)) - turns // 2)
        level = rng.choice(options().trial_levels) * self.high[thrusters + one]
        if self.low[thrusters + one] < 0.0 and rng.random() < 0.5:
            level = rng.choice(options().trial_levels) * self.low[thrusters + one]
        if rng.random() < 0.5:
            block[:, one] = np.clip(angle, self.low[one], self.high[one])
        else:
            block[:, thrusters + one] = level
        return made

    def _of_palette(self, rng: np.random.Generator) -> Array:
        """(2K,) a command of the palette, its largest share of full at one of the levels."""
        thrusters = len(self.low) // 2
        row = self.palette[rng.integers(len(self.palette))].copy()
        limit = np.where(row < 0.0, self.low, self.high)[thrusters:]
        largest = (row[thrusters:] / limit).max()
        if largest > 0.0:
            row[thrusters:] *= rng.choice(options().trial_levels) / largest
        return np.clip(row, self.low, self.high)


def command_family(boat: Boat, dt: float, seconds: float, throttle: float) -> CommandFamily:
    """For a trial of so many seconds, a row each dt [s]; throttle: greatest share of full [1].

    A command is held for `trial_hold` or more, and for as long as the slowest actuator takes from one end to
    the other (half a turn of an azimuth without ends), so that the boat follows it.
    """
    count = len(boat.thrusters)
    low, high = command_bounds(boat, throttle)
    swing = np.minimum(high[:count] - low[:count], math.pi)
    with np.errstate(divide="ignore", invalid="ignore"):
        slowest = float(np.nan_to_num(swing / parameters(boat)["azimuth_rate"][0], posinf=0.0).max())
    rows = np.concatenate(list(manoeuvres(boat, dt, seconds, throttle).values()))
    mirrored = rows * np.concatenate([-np.ones(count), np.ones(count)])
    palette = np.unique(np.round(np.concatenate([rows, mirrored]), 9), axis=0)
    hold = steps_over(max(options().trial_hold, slowest), dt)
    return CommandFamily(hold, round(seconds / dt), palette, low, high)
