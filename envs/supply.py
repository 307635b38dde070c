"""Charge of the boats' batteries in an episode, and the thrust that it leaves them.

Beside the compiled step, and only where a level has an effect on the battery or `charge` is observed. What
was drawn is in the boats' records, so that a step may be sailed anew.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.kernel import RUNNING
from swamp_rl.envs.observation import CHARGE
from swamp_rl.envs.task import Task

from swamp_rl.boat import Boat
from swamp_rl.energy import charge_at, pack_power, stored_energy
from swamp_rl.energy.power import thrust_left
from swamp_rl.simulator.state import ACTUATORS

Array = NDArray[np.float64]
DRAWN, GAIN = "drawn", "thruster_gain"


def supply_fields(boat: Boat) -> tuple[tuple[Any, ...], ...]:
    """Fields of a boat's record: energy drawn from each pack [J], each thruster's gain at full charge [1]."""
    packs = boat.battery.packs if boat.battery else 0
    return ((DRAWN, np.float64, (packs,)), (GAIN, np.float64, (len(boat.thrusters),)))


def sags(task: Task) -> bool:
    """Whether the thrust follows the charge."""
    return any(entry.effect.battery for entry in task.level.entries)


def counts_charge(task: Task) -> bool:
    """Whether the charge is asked for."""
    return sags(task) or CHARGE in task.observed.names


class Supply:
    """The batteries of n boats."""

    def __init__(self, task: Task, boats: NDArray[Any], params: NDArray[Any]) -> None:
        """boats, params (n,): the records that the step changes."""
        assert task.boat.battery is not None
        self._boat, self._battery, self._step = task.boat, task.boat.battery, task.step
        self._boats, self._params = boats, params
        self._sags = sags(task)
        self._columns = [i for i, name in enumerate(task.observed.names) if name == CHARGE]
        self._left: Array | float = 1.0

    @property
    def start(self) -> Array:
        """State of charge [1] at the start of the episode, (n, packs)."""
        return np.repeat(self._params["battery_charge"][:, None], self._battery.packs, axis=1)

    @property
    def drawn(self) -> Array:
        """Energy [J] drawn from each pack since the start of the episode, (n, packs), a copy."""
        return np.array(self._boats[DRAWN])

    @property
    def charge(self) -> Array:
        """State of charge [1] of each pack, (n, packs)."""
        return charge_at(self._battery, stored_energy(self._battery, self.start) - self._boats[DRAWN])

    def feed(self) -> None:
        """Before a step: give each thruster the thrust that its pack's voltage leaves it."""
        self._sailed = (self._boats["outcome"] == RUNNING) & ~self._boats["fresh"]
        if self._sags:
            charge = self.charge
            self._charged, self._left = charge > 0.0, thrust_left(self._boat, charge)
            self._params[GAIN] = self._boats[GAIN] * self._left

    def draw(self, observations: NDArray[np.float32]) -> None:
        """After a step: count what it drew from the packs, and fill the observations (n, d)."""
        throttle = self._boats["state"][:, ACTUATORS + len(self._boat.thrusters) :]
        power = pack_power(self._boat, throttle, self._left) * self._sailed[:, None]
        if self._sags:
            power = power * self._charged
        self._boats[DRAWN] += power * self._step
        self.look(np.arange(len(self._boats)), observations)

    def look(self, chosen: NDArray[np.intp], observations: NDArray[np.float32]) -> None:
        """Fill the rows `chosen` (m,) of observations (n, d)."""
        if self._columns:
            observations[chosen[:, None], self._columns] = self.charge.min(axis=1)[chosen, None]
