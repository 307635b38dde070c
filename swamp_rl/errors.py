"""The one exception whose message is meant for the person at the keyboard."""

from collections.abc import Sequence


class UserError(Exception):
    """What is wrong, where (file, row, column or key) and what to do, on one line."""


class FaultsError(UserError):
    """Several faults at once, each as a UserError would tell it; `lines` holds them."""

    def __init__(self, lines: Sequence[str]) -> None:
        super().__init__("\n".join(lines))
        self.lines = tuple(lines)
