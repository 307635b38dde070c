"""Numbers in reports, to the digits that are known."""

import math


def digits(value: float, count: int) -> str:
    """A number to `count` digits, without an exponent up to a million."""
    return f"{float(f'{value:.{count}g}'):.6g}"


def known(value: float, error: float, count: int = 4) -> str:
    """A number to `count` digits, none of them below the second digit of its standard error."""
    if 0.0 < error < math.inf:
        value = round(value, 1 - math.floor(math.log10(error))) + 0.0  # no -0
    return digits(value, count)
