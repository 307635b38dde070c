"""Numbers so large or so small that powers and ratios of them leave the range of floating point."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from swamp_rl.boat.merge import is_quantity, leaves
from swamp_rl.boat.quantity import SPREAD

LEAST, MOST = 1e-30, 1e20  # of any boat, in SI units; the fifth power of a diameter stays a number


def out_of_range(raw: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Dotted key and complaint for each number of a boat file or a design beyond what any boat has.

    What is not a finite number is left for the schema to refuse.
    """
    for key, leaf in leaves(raw):
        value, spread = (leaf.get("value"), leaf.get(SPREAD)) if is_quantity(leaf) else (leaf, None)
        found = [one for one in _numbers(value) if one and not LEAST <= abs(one) <= MOST]
        found += [one for one in _numbers(spread) if abs(one) > MOST]
        if found:
            number = f"{found[0]:.6g}" if isinstance(found[0], float) else "an integer of many digits"
            yield (
                ".".join(key),
                f"{number} is out of range: numbers are 0 or {LEAST:g} to {MOST:g}; check the unit",
            )


def _numbers(given: Any) -> Iterator[float]:
    """Those that are finite, in lists of any depth, too."""
    if isinstance(given, list):
        for one in given:
            yield from _numbers(one)
    elif _is_finite(given):
        yield given


def _is_finite(given: Any) -> bool:
    if isinstance(given, float):
        return math.isfinite(given)
    return isinstance(given, int) and not isinstance(given, bool)
