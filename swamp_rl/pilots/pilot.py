"""The protocol of a pilot: observations to joypad levers, for a batch of boats."""

from typing import Any, Protocol

from swamp_rl.pilots.arrays import Array


class Pilot(Protocol):
    """Batch first: n boats share the weights, and each has its own internal state.

    The levers of a boat depend on its own observations alone, bit for bit (see `arrays.times`).
    """

    @property
    def kind(self) -> str:
        """The kind that `swamp_rl.pilots.store` keeps it as; of one's own that of `own.own_class`."""

    @property
    def senses(self) -> tuple[str, ...]:
        """Names of its d observations, in order."""

    def reset(self, n: int) -> None:
        """Set the number of boats to n and reset all internal states.

        UserError if n is no whole number of at least 0.
        """

    def reset_boats(self, mask: Array) -> None:
        """Reset the internal states of the boats of `mask` (n,) bool."""

    def keep(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,), in that order, with their states."""

    def act(self, observation: Array) -> Array:
        """Return levers (n, 2), throttle in [0, 1] and angle in [-1, 1], for observations (n, d) in SI.

        UserError for another shape or number of boats, and for a value that is not a finite number.
        """

    def settings(self) -> dict[str, Any]:
        """Return everything but the arrays as plain JSON; with `weights` it suffices for `build`."""

    def weights(self) -> dict[str, Array]:
        """Return the arrays by name; empty for a pilot without weights."""
