"""The exception whose message is meant for the person at the keyboard, and one kind of it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from swamp_rl.clipped import clipped

LONGEST = 2000
"""Characters of a line; some name a file, whose name may be long."""


class UserError(Exception):
    """What is wrong, where (file, row, column or key) and what to do, on one line for each fault.

    Untrusted text in it is clipped: each line is printable and at most `LONGEST` long.
    """

    def __init__(self, message: str) -> None:
        super().__init__("\n".join(clipped(line, LONGEST) for line in message.split("\n")))


class SettingsError(UserError):
    """Settings with which a training cannot succeed: what it has computed so far is of no use."""


@contextmanager
def errors_at(where: Path | str) -> Iterator[None]:
    """Put `where`, a file and its key, before each line of a UserError that the block raises."""
    try:
        yield
    except UserError as error:
        lines = "\n".join(f"{where}: {line}" for line in str(error).split("\n"))
        raise type(error)(lines) from error
