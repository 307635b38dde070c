"""One of the two computers: which jets it commands, and when it takes over from the other (thesis 6.5).

Each hull has a computer with its own GPS and AHRS, a battery, a communication module to the console on shore,
and the modules of its jets. The thesis says that the other hull takes over and not how. Chosen here:

* A computer commands the jets of its own hull, and all jets while it hears nothing of the other.
* The starboard computer is the master: it allocates the console's wish to all jets that work, and tells the
  other its commands. The other allocates for itself while it hears nothing of the master.
* What one hears it sends to the other: wishes of the console, fixes, and which modules are silent.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation import Jets, allocate

Array = NDArray[np.float64]

LOST = 0.25
"""Seconds without a sign of life, of which ten are due a second, after which a computer or module is lost."""
ANSWER = 0.15
"""Seconds in which the other hull's modules must send telemetry to a computer that has taken them over."""
WISH_LASTS = 1.0
"""Seconds after which a console's last wish no longer counts, and the pumps stop."""
STARBOARD, PORT = 0, 1


@dataclass(frozen=True)
class Heartbeat:
    """What one computer tells the other. wished, fixed: when [s] the console's wish (3,) [N, N m] and the fix
    of its GPS came; commands: (2K,) for all jets, None from a computer that allocates nothing."""

    sender: int
    wish: tuple[float, ...]
    wished: float
    fixed: float
    silent: frozenset[int]
    azimuths: tuple[float, ...]
    commands: tuple[float, ...] | None


@dataclass
class Computer:
    """The computer of hull `number`, which owns the jets `own`; every time is given by the caller [s]."""

    number: int
    own: frozenset[int]
    jets: Jets
    heard: float = 0.0
    "When the other computer was heard last."
    module_heard: list[float] = field(default_factory=list)
    fixed: float = -math.inf
    "When its own GPS gave a fix last."
    wish: tuple[float, ...] = (0.0, 0.0, 0.0)
    wished: float = -math.inf

    def __post_init__(self) -> None:
        count = len(self.jets.names)
        self.module_heard = [0.0] * count
        self._azimuths = [0.0] * count
        self._beat: Heartbeat | None = None
        self._taken_over = math.inf
        self._key: tuple[frozenset[int], tuple[float, ...]] | None = None
        self._commands = np.zeros(2 * count)

    def hear_wish(self, wish: Sequence[float], sent: float) -> None:
        """Take a wish (3,) that the console sent at a time; an older one than is known counts for nothing."""
        if sent > self.wished:
            self.wish, self.wished = tuple(wish), sent

    def hear_module(self, k: int, azimuth: float, now: float) -> None:
        """Take telemetry of the module of jet k, which points at an azimuth [rad]."""
        self.module_heard[k], self._azimuths[k] = now, azimuth

    def hear_other(self, beat: Heartbeat, now: float) -> None:
        """Take a heartbeat."""
        self.heard, self._beat = now, beat
        self.hear_wish(beat.wish, beat.wished)
        for k in set(range(len(self._azimuths))) - self.own:
            self._azimuths[k] = beat.azimuths[k]

    def alone(self, now: float) -> bool:
        """Whether the other has not been heard for too long."""
        return now - self.heard > LOST

    def allocates(self, now: float) -> bool:
        """Whether it shares out the wish itself."""
        return self.number == STARBOARD or self.alone(now)

    def navigates_by(self, now: float) -> int | None:
        """The hull whose GPS it uses: its own, else the other's, None where neither has a fix."""
        if now - self.fixed <= LOST:
            return self.number
        if not self.alone(now) and self._beat is not None and now - self._beat.fixed <= LOST:
            return self._beat.sender
        return None

    def commanded(self, now: float) -> frozenset[int]:
        """The jets that it commands."""
        return frozenset(range(len(self.jets.names))) if self.alone(now) else self.own

    def silent(self, now: float) -> frozenset[int]:
        """The jets whose modules are not heard: of its own hull, and of the other's what that one tells, or,
        once it has taken over and had the time to hear them, what it hears itself."""
        self._taken_over = min(self._taken_over, now) if self.alone(now) else math.inf
        mine = {k for k in self.own if now - self.module_heard[k] > LOST}
        if not self.alone(now):
            return frozenset(mine | (self._beat.silent if self._beat is not None else frozenset()))
        theirs = set(range(len(self.jets.names))) - self.own
        unheard = {k for k in theirs if now - self.module_heard[k] > LOST}
        return frozenset(mine | (unheard if now - self._taken_over > ANSWER else set()))

    def commands(self, now: float) -> Array:
        """(2K,) azimuths [rad] and throttles [1] for the jets that it commands; the others' do not count."""
        if not self.allocates(now) and self._beat is not None and self._beat.commands is not None:
            return np.array(self._beat.commands)
        silent = self.silent(now)
        wish = self.wish if now - self.wished <= WISH_LASTS else (0.0, 0.0, 0.0)
        if (silent, wish) != self._key:
            self._key = silent, wish
            working = self.jets.without([self.jets.names[k] for k in silent])
            self._commands = allocate(working, np.array(wish), np.array(self._azimuths)).commands
        return self._commands

    def heartbeat(self, now: float) -> Heartbeat:
        """What it tells the other."""
        commands = tuple(self.commands(now).tolist()) if self.allocates(now) else None
        mine = frozenset(self.silent(now) & self.own)
        azimuths = tuple(self._azimuths)
        return Heartbeat(self.number, self.wish, self.wished, self.fixed, mine, azimuths, commands)
