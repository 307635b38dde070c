"""What two turning circles to either side tell together: the bias of the boat, and its course stability."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.analysis.stability import SMALL, judge_pull_outs

SAME = 0.01  # of the steady diameter, within which both sides count as alike


@dataclass(frozen=True)
class Pair:
    """Circles at one angle [deg] and throttle [1]: steady diameters [m], how much wider the one to starboard
    is [1], and the verdicts."""

    angle: float
    throttle: float
    starboard: float
    port: float
    verdicts: dict[str, str] = field(default_factory=dict)

    @property
    def wider(self) -> float:
        """How much wider the boat turns to starboard, as a share of the mean diameter."""
        return 2.0 * (self.starboard - self.port) / (self.starboard + self.port)


def pairs(results: Sequence[Result], length: float) -> list[Pair]:
    """Every pair of circles that differ in their side alone; length of the boat [m]."""
    circles = {_key(result): result for result in results if _turned(result)}
    found = []
    for (angle, throttle, pattern), starboard in circles.items():
        port = circles.get((-angle, throttle, pattern))
        if angle > 0.0 and port is not None:
            found.append(_pair(angle, throttle, starboard, port, length))
    return found


def _turned(result: Result) -> bool:
    diameter = result.best.get("steady_diameter")
    return result.kind == "turning-circle" and diameter is not None and math.isfinite(diameter.value)


def _key(result: Result) -> tuple[float, float, str]:
    angle = round(math.degrees(float(result.setting.get("angle", math.nan))), 1)
    throttle = round(float(result.setting.get("throttle", math.nan)), 4)
    return angle, throttle, str(result.setting.get("pattern", ""))


def _pair(angle: float, throttle: float, starboard: Result, port: Result, length: float) -> Pair:
    one, other = (result.best["steady_diameter"].value for result in (starboard, port))
    together = Result("pair", "pull-out", {})
    left = starboard.figures.get("residual_rate_starboard"), port.figures.get("residual_rate_port")
    if left[0] is not None and left[1] is not None:
        speed = starboard.best["approach_speed"].value
        judge_pull_outs(together, left[0], left[1], math.degrees(SMALL * speed / length))
        together.verdicts["pull_out_bias"] = together.verdicts.pop("bias")
    pair = Pair(angle, throttle, one, other, together.verdicts)
    if abs(pair.wider) <= SAME:
        pair.verdicts["bias"] = f"none: the diameters differ by {100 * abs(pair.wider):.1f} %"
    else:
        side = "port" if pair.wider > 0.0 else "starboard"
        pair.verdicts["bias"] = f"to {side}: it turns {100 * abs(pair.wider):.1f} % tighter to that side"
    return pair
