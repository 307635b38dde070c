"""The picture of a matching: thrust coefficients against what the hull asks for, and energy over speed."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.trial_figures import colours

from swamp_rl.constants import KNOT
from swamp_rl.design.matching import (
    BestRange,
    Match,
    MatchDesign,
    drag_of,
    energy_per_metre,
    thrust_coefficient,
)
from swamp_rl.figure_style import sheet


def draw_match(path: Path, design: MatchDesign, found: Sequence[Match], ranges: Sequence[BestRange]) -> None:
    """Write the PNG."""
    with sheet(path, 10.5, 4.6) as canvas:
        left, right = canvas.subplots(1, 2)
        coefficients(left, design, found)
        energy(right, design, ranges)
        canvas.suptitle(f"{design.name}: propellers on the hull, and best range", fontweight="bold")


def coefficients(axes: Any, design: MatchDesign, found: Sequence[Match]) -> None:
    """K_t over J of each propeller, and k_x J²/(K_h n_prop ρ d²) of the hull; J* where they meet."""
    of, drag = design.propellers, drag_of(design)
    asked = drag.factor(design.design_speed)
    asked /= of.hull_efficiency * of.count * drag.water_density * of.diameter**2
    most = max(one.pitch.pitch_ratio for one in found) * of.null_factor
    highest = max(one.pitch.bollard_coefficient for one in found)
    shades = colours([float(i) for i in range(len(found))])
    for i, one in enumerate(found):
        pitch = one.pitch
        at = np.linspace(0.0, of.null_factor * pitch.pitch_ratio, 50)
        values = thrust_coefficient(at, of, pitch)
        label = f"p/d {pitch.pitch_ratio:g}: J* = {one.advance:.2f}"
        axes.plot(at, values, color=shades[float(i)], label=label)
        axes.plot(one.advance, one.thrust_coefficient, "o", color=shades[float(i)], ms=6)
    at = np.linspace(0.0, min(most, (highest / asked) ** 0.5), 200)
    axes.plot(at, asked * at**2, color="#888888", ls="--", label="asked by the hull")
    axes.set(xlabel="advance coefficient J [1]", ylabel="thrust coefficient K_t [1]")
    axes.set(xlim=(0.0, 1.05 * most), ylim=(0.0, 1.35 * highest), title="Steady run")
    axes.legend(loc="upper right")


def energy(axes: Any, design: MatchDesign, ranges: Sequence[BestRange]) -> None:
    """Energy a metre over the speed at each on-board power, the least marked."""
    drag = drag_of(design)
    fastest = max(one.speed for one in ranges)
    low, high = max(drag.low, 0.25 * min(one.speed for one in ranges)), min(drag.high, 1.6 * fastest)
    speed = np.linspace(low, high, 120)
    shades = colours([one.onboard_power for one in ranges])
    for one in ranges:
        spent = [energy_per_metre(design, drag, one.onboard_power, float(v)) for v in speed]
        label = f"{one.onboard_power:g} W on board: {one.speed:.2f} m/s, {one.range / 1e3:.3g} km"
        axes.plot(speed, spent, color=shades[one.onboard_power], label=label)
        axes.plot(one.speed, one.energy_per_metre, "o", color=shades[one.onboard_power], ms=6)
    above = axes.secondary_xaxis("top", functions=(lambda v: v / KNOT, lambda knots: knots * KNOT))
    above.set_xlabel("speed [kn]")
    top = 2.5 * max(one.energy_per_metre for one in ranges)
    axes.set(xlabel="speed [m/s]", ylabel="energy a metre [J/m]", xlim=(0.0, high), ylim=(0.0, top))
    axes.legend(loc="upper center")
