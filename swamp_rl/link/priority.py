"""What keeps a command from being late: real-time scheduling, and no collection of garbage before it."""

import gc
import os
from collections.abc import Iterator
from contextlib import contextmanager

from swamp_rl.errors import UserError

PRIORITY = 20
"""Of 1 to 99 in SCHED_FIFO: below the kernel's own threads at 50."""


def schedule_in_real_time() -> None:
    """Run before all ordinary processes from now on (Linux, SCHED_FIFO); UserError where it is refused."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except (AttributeError, OSError) as error:
        raise UserError(
            f"--priority: the system refuses real-time scheduling ({error}); run as root, or leave it out"
        ) from error


@contextmanager
def garbage_kept() -> Iterator[None]:
    """Collect no garbage within the block but where `gc.collect` is called.

    What is there now is of the oldest generation from here on, which no collection of a younger one visits.
    """
    was = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()
