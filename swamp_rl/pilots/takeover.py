"""Two pilots in sequence: the first drives for some seconds, then the second takes over (thesis 7.3.3)."""

from typing import Any, ClassVar

import numpy as np

from swamp_rl.pilots.arrays import Array, checked, checked_count
from swamp_rl.pilots.pilot import Pilot


class TakeoverPilot:
    """Both pilots receive all observations, so that the second's state is up to date when it takes over."""

    kind: ClassVar[str] = "takeover"

    def __init__(self, first: Pilot, then: Pilot, seconds: float, step: float = 0.1) -> None:
        """seconds: for how long `first` drives [s]; step: time between decisions [s]."""
        self.first, self.then = first, then
        self.seconds, self.step = seconds, step
        self.senses = tuple(dict.fromkeys((*first.senses, *then.senses)))
        self._first_senses = [self.senses.index(name) for name in first.senses]
        self._then_senses = [self.senses.index(name) for name in then.senses]
        self._ticks_of_first = round(seconds / step)
        self.reset(0)

    def reset(self, n: int) -> None:
        """Set the number of boats to n, driven by the first pilot."""
        self._tick = np.zeros(checked_count(n), dtype=np.int64)
        self.first.reset(n)
        self.then.reset(n)

    def reset_boats(self, mask: Array) -> None:
        """Return the boats of `mask` (n,) to the first pilot."""
        self._tick[np.asarray(mask, dtype=bool)] = 0
        self.first.reset_boats(mask)
        self.then.reset_boats(mask)

    def keep(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,)."""
        self._tick = self._tick[boats]
        self.first.keep(boats)
        self.then.keep(boats)

    def act(self, observation: Array) -> Array:
        """Return the levers (n, 2) of the pilot that drives each boat, for observations (n, d)."""
        seen = checked(observation, self.senses, len(self._tick))
        watched = self.then.act(seen[:, self._then_senses])
        early = self._tick < self._ticks_of_first
        self._tick += 1
        if not early.any():
            return watched
        driven = self.first.act(seen[:, self._first_senses])
        return np.where(early[:, None], driven, watched)

    def settings(self) -> dict[str, Any]:
        """Times, and kind and settings of the two pilots."""
        pilots = {name: getattr(self, name) for name in ("first", "then")}
        described = {
            name: {"kind": pilot.kind, "settings": pilot.settings()} for name, pilot in pilots.items()
        }
        return {"seconds": self.seconds, "step": self.step, **described}

    def weights(self) -> dict[str, Array]:
        """Those of the two pilots, with `first.` and `then.` before their names."""
        first, then = self.first.weights(), self.then.weights()
        return {**{f"first.{k}": v for k, v in first.items()}, **{f"then.{k}": v for k, v in then.items()}}
