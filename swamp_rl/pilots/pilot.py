"""What every pilot is: observation in, joypad out, for any number of boats at once."""

from typing import Any, Protocol

from swamp_rl.pilots.arrays import Array


class Pilot(Protocol):
    """Batch first: n boats that share what was learned, each with a memory of its own.

    What a boat is told depends on its own observations alone, to the last bit (see `arrays.times`).
    """

    @property
    def kind(self) -> str:
        """What it is, under which it is stored: scripted, reservoir, cloning, gru, ppo or takeover."""

    @property
    def senses(self) -> tuple[str, ...]:
        """Names of the d observations it wants, in order."""

    def reset(self, n: int) -> None:
        """Begin a run with each of n boats; what came before is forgotten."""

    def reset_boats(self, mask: Array) -> None:
        """Begin a new run with the boats of `mask` (n,) bool; the others go on."""

    def keep(self, boats: Array) -> None:
        """Go on with the boats of the places `boats` (m,) alone, in that order, each with its memory."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2), throttle in [0, 1] and angle in [-1, 1], from the observation (n, d), SI units."""

    def settings(self) -> dict[str, Any]:
        """All that is not an array, as plain JSON; with `weights`, enough for `build`."""

    def weights(self) -> dict[str, Array]:
        """The arrays by name; empty where nothing was learned."""
