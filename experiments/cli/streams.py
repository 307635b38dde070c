"""Standard streams that can be written to, however the process was started."""

import io
import os
import sys


def usable_streams() -> None:
    """Open the null device for each standard stream that is closed; write `?` for what a coding lacks.

    The first file that is opened would otherwise get the number of a closed stream, and all that a library
    writes to that.
    """
    while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(handle, True)
    os.close(handle)
    sys.stdout = sys.stdout or open(1, "w", closefd=False)  # noqa: SIM115
    sys.stderr = sys.stderr or open(2, "w", closefd=False)  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
