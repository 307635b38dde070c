"""The limits of IMO resolution MSC.137(76), section 5.3, as pass or fail."""

import math
from dataclasses import dataclass
from typing import Any

from swamp_rl.manoeuvres.analysis.figure import Result, plain_number

HARD_OVER = 35.0  # deg, at which the standard measures its turning circle
SAME = 0.5  # deg of the setting that still counts as that of the standard
SHORTEST = 100.0  # m, of the ships that the standard is for (section 3)
TITLE = "IMO MSC.137(76)"


def title_for(length: float) -> str:
    """The standard's title; for a boat of a length [m] below that of its ships, also whom it is for."""
    return TITLE if length >= SHORTEST else f"{TITLE}, a standard for ships of {SHORTEST:g} m and more"


@dataclass(frozen=True)
class Criterion:
    """One limit: `value` against `limit` in `unit`; passed is None where there is no value to judge."""

    name: str
    value: float
    limit: float
    unit: str

    @property
    def passed(self) -> bool | None:
        """Whether the value keeps the limit."""
        return self.value <= self.limit if math.isfinite(self.value) else None

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "name": self.name,
            "value": plain_number(self.value),
            "limit": self.limit,
            "unit": self.unit,
            "passed": self.passed,
        }


def first_overshoot_limit(length_over_speed: float) -> float:
    """Of the 10/10 zig-zag [deg], by L/V [s]."""
    return min(max(5.0 + 0.5 * length_over_speed, 10.0), 20.0)


def second_overshoot_limit(length_over_speed: float) -> float:
    """Of the 10/10 zig-zag [deg], by L/V [s]."""
    return min(max(17.5 + 0.75 * length_over_speed, 25.0), 40.0)


def criteria(result: Result, length: float) -> list[Criterion]:
    """The limits that apply to a result; length of the boat [m].

    None for a circle or zig-zag at another angle than the standard's: a wider circle at 30 deg is no failure.
    """
    best = result.best
    angle = abs(math.degrees(result.setting.get("angle", math.nan)))
    if result.kind == "turning-circle":
        if abs(angle - HARD_OVER) > SAME:
            return []
        return [
            Criterion("advance", best["advance"].value / length, 4.5, "L"),
            Criterion("tactical diameter", best["tactical_diameter"].value / length, 5.0, "L"),
        ]
    if result.kind == "stopping":
        return [Criterion("track reach", best["track_reach"].value / length, 15.0, "L")]
    if result.kind != "zig-zag":
        return []
    heading = abs(math.degrees(result.setting.get("heading", result.setting.get("angle", math.nan))))
    if abs(angle - 10.0) <= SAME and abs(heading - 10.0) <= SAME:
        lasts = length / max(best["approach_speed"].value, 1e-9)
        first, second = first_overshoot_limit(lasts), second_overshoot_limit(lasts)
        return [
            Criterion("initial turning", best["initial_turning"].value / length, 2.5, "L"),
            Criterion("first overshoot 10/10", best["first_overshoot"].value, first, "deg"),
            Criterion("second overshoot 10/10", best["second_overshoot"].value, second, "deg"),
        ]
    if abs(angle - 20.0) <= SAME and abs(heading - 20.0) <= SAME:
        return [Criterion("first overshoot 20/20", best["first_overshoot"].value, 25.0, "deg")]
    return []
