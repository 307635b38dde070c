"""Commands that act late: what reaches the thrusters in a step, from the commands before."""

from typing import Any

from swamp_rl.physics.compile import compiled


@compiled
def delayed_command(past: Any, tick: int, delay: float, arrived: Any) -> None:
    """Fill `arrived` (2K,) with the command that acts in step `tick` of an episode.

    past: (R, 2K), row i % R the command given in step i, so either a table of the whole run or a ring that
    the caller fills as it goes, of R >= delay + 2 rows. delay: in steps; where it is no whole number the two
    commands that share the step are mixed by their shares of it: the track is continuous in the delay.
    Before the first step its command is taken to have stood already.
    """
    whole = int(delay)
    share = delay - whole
    newer, older = max(tick - whole, 0), max(tick - whole - 1, 0)
    if newer >= past.shape[0]:  # a division that a table of the whole run never needs
        newer, older = newer % past.shape[0], older % past.shape[0]
    for c in range(arrived.shape[0]):
        arrived[c] = past[newer, c]
        if share != 0.0:
            arrived[c] += share * (past[older, c] - past[newer, c])
