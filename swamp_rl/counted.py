"""Numbers of things, as English writes them."""

from collections.abc import Sequence


def counted(number: int, noun: str) -> str:
    """`1 run`, `2 runs`: a number and its noun, which takes an s."""
    return f"{number} {noun}{'s' * (number != 1)}"


def and_others(names: Sequence[str]) -> str:
    """The first name and how many others there are: `run1 and 3 others`."""
    return names[0] + (f" and {counted(len(names) - 1, 'other')}" if len(names) > 1 else "")


def few(names: Sequence[str], most: int = 6) -> str:
    """The names; of more than `most`, the first and how many others there are."""
    return ", ".join(names) if len(names) <= most else and_others(names)
