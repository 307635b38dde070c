"""Propellers matched to a hull, and the speed of best range, as tables and a figure."""

from functools import partial
from pathlib import Path

from swamp_rl.experiments.reports.design import Table, spec, write_design
from swamp_rl.experiments.reports.design_match_figure import draw_match

from swamp_rl.constants import KNOT
from swamp_rl.design.matching import best_ranges, drag_of, load_match, matches

FIGURE = "match.png"
PROPELLERS = {
    "name": "",
    "pitch_ratio": "1",
    "bollard_coefficient": "1",
    "advance": "1",
    "thrust_coefficient": "1",
    "revolutions": "1/s",
    "thrust": "N",
}
RANGES = {
    "onboard_power": "W",
    "speed": "m/s",
    "propulsion_power": "W",
    "total_power": "W",
    "energy_per_metre": "J/m",
    "range": "m",
}


def write_match(out: Path, asked: str) -> list[str]:
    """Match the propellers of a file and write it into `out`; lines to print. UserError if none fits."""
    design = load_match(asked)
    found, ranges = matches(design), best_ranges(design)
    factor = drag_of(design).factor(design.design_speed)
    propellers = [
        (
            one.pitch.name,
            one.pitch.pitch_ratio,
            one.pitch.bollard_coefficient,
            one.advance,
            one.thrust_coefficient,
            one.revolutions,
            one.thrust,
        )
        for one in found
    ]
    best = [tuple(getattr(one, key) for key in RANGES) for one in ranges]
    content = {
        "design": "match",
        "asked": spec(design),
        "drag_factor": {"value": factor, "unit": "kg/m"},
        "propellers": [dict(zip(PROPELLERS, row, strict=True)) for row in propellers],
        "ranges": [dict(zip(RANGES, row, strict=True)) for row in best],
    }
    tables = [Table("propellers.csv", PROPELLERS, propellers), Table("ranges.csv", RANGES, best)]
    drawn = partial(draw_match, design=design, found=found, ranges=ranges)
    write_design(out, asked, content, tables, (FIGURE, drawn))
    lines = [f"{design.name}: drag {factor:.4g} kg/m times speed squared, at {design.design_speed:g} m/s:"]
    lines += [
        f"  {one.pitch.name:<12} p/d {one.pitch.pitch_ratio:<5g} J* {one.advance:.3f}  "
        f"K_t {one.thrust_coefficient:.3f}  {60.0 * one.revolutions:.0f} rpm  {one.thrust:.3g} N each"
        for one in found
    ]
    lines += ["best range:"]
    lines += [
        f"  {one.onboard_power:g} W on board: {one.speed:.2f} m/s ({one.speed / KNOT:.1f} kn), "
        f"{one.propulsion_power:.1f} W to drive, {one.energy_per_metre:.3g} J/m, {one.range / 1e3:.4g} km"
        for one in ranges
    ]
    return lines
