"""Numbers of things, as English writes them."""


def counted(number: int, noun: str) -> str:
    """`1 run`, `2 runs`: a number and its noun, which takes an s."""
    return f"{number} {noun}{'s' * (number != 1)}"
