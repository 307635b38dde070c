"""A boat file looked over: where its numbers come from, and what the boat does in a simulation."""

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.reports.trial_figures import draw_trials

from swamp_rl.boat import Boat, Provenance
from swamp_rl.boat.quantity import ORIGINS, value_at
from swamp_rl.clipped import in_markdown
from swamp_rl.constants import GRAVITY
from swamp_rl.digits import digits
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.circle import extraordinary
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.controller import Trial
from swamp_rl.manoeuvres.execute import execute
from swamp_rl.manoeuvres.record import runs_of_trials
from swamp_rl.manoeuvres.steering import refuse_astern, steering_limit
from swamp_rl.manoeuvres.straight_line_stability import straight_line_stability
from swamp_rl.simulator.reference import reference_of
from swamp_rl.unfinished import folder_beside

REPORT = "check.md"
THROTTLES = (0.2, 0.4, 0.6, 0.8, 1.0)
STEEREST = math.radians(35.0)
TURNS = 2
FLATTEST = 20.0  # breadth over draught of one hull: skiffs have up to 17, catamarans taken as one 22 and more
MEASURED = 10.0  # √(L/g) over which a steady speed is measured


def sail(boat: Boat) -> list[Result]:
    """Speed at five throttles, a turning circle to either side, and stopping where the boat can push astern.

    The boat's own effects act. UserError for a boat whose motion diverges or that cannot be steered.
    """
    seconds = MEASURED * math.sqrt(boat.length / GRAVITY)
    angle = min(STEEREST, steering_limit(boat))
    trials = [Trial("straight", throttle, duration=seconds) for throttle in THROTTLES]
    trials += [Trial("turning-circle", 1.0, side * angle, turns=TURNS, duration=1.0) for side in (1.0, -1.0)]
    try:
        refuse_astern(boat)
        trials.append(Trial("stopping", 1.0))
    except UserError:
        pass  # no stopping trial: the report then has none
    return [analyse_run(run, boat) for run in runs_of_trials(execute(boat, trials), boat, 0)]


def raft_warning(boat: Boat) -> str | None:
    """A line where an estimated boat of one hull is as flat as only two hulls taken as one are, else None."""
    if boat.hull.spacing > 0.0 or boat.breadth <= FLATTEST * boat.draught:
        return None
    return (
        f"draught {boat.draught:.3g} m is 1/{boat.breadth / boat.draught:.0f} of the breadth, flatter than "
        "one hull is; of a catamaran give the breadth of each hull with --demihull"
    )


def turning_warning(boat: Boat) -> str | None:
    """A line where the circle of an estimated boat, full ahead to starboard, is outside what boats under way
    do, None where it is not. UserError as of `sail`.
    """
    angle = min(STEEREST, steering_limit(boat))
    trial = Trial("turning-circle", 1.0, angle, turns=TURNS, duration=1.0)
    result = analyse_run(runs_of_trials(execute(boat, [trial]), boat, 0)[0], boat)
    if not result.corrected or not (found := extraordinary(result.corrected, boat.length, angle)):
        return None
    told = found[0].partition("; check")[0]
    return (
        f"full ahead at {math.degrees(angle):+.0f} deg: {told}; give the lateral area of its skeg, fin or "
        "lower unit with --fin"
    )


def check_lines(boat: Boat, results: Sequence[Result]) -> list[str]:
    """What the command line prints: the origin of the numbers section by section, then what was simulated."""
    return [*_origin_lines(boat.provenance), *_motion_lines(boat, results)]


def write_check(out: Path, boat: Boat, results: Sequence[Result]) -> list[str]:
    """Write the report and the figures into the new folder `out`; names of its files."""
    with folder_beside(out, replaces=REPORT) as part:
        pictures = draw_trials(part, results, boat.length)
        text = [
            f"# Boat file {in_markdown(boat.name)}",
            *(f"* {in_markdown(line)}" for line in _motion_lines(boat, results)),
        ]
        text += ["", *(f"![{Path(name).stem.replace('_', ' ')}]({name})" for name in pictures)]
        text += [
            "",
            "## Numbers",
            "",
            table(["key", "value", "sd", "unit", "provenance", "source"], _rows(boat)),
        ]
        (part / REPORT).write_text("\n".join(text) + "\n", encoding="utf-8")
    return [REPORT, *pictures]


def _origin_lines(provenance: dict[str, Provenance]) -> list[str]:
    """How many numbers are measured, fitted and assumed: of the file, then of each of its sections."""
    sections: dict[str, Counter[str]] = {}
    for key, origin in provenance.items():
        name = ".".join(key.split(".")[:2]) if key.startswith("thrusters.") else key.partition(".")[0]
        sections.setdefault(name if "." in key else "particulars", Counter())[origin.provenance] += 1
    whole = sum(sections.values(), Counter())
    spread = sum(origin.sd is not None for origin in provenance.values())
    lines = [f"{sum(whole.values())} numbers: {_counts(whole)}; {spread} with a standard deviation"]
    return lines + [f"  {name}: {_counts(counts)}" for name, counts in sections.items()]


def _counts(counts: Counter[str]) -> str:
    return ", ".join(f"{counts[origin]} {origin}" for origin in ORIGINS if counts[origin])


def _motion_lines(boat: Boat, results: Sequence[Result]) -> list[str]:
    reference = reference_of(boat)
    froude = reference.speed / math.sqrt(GRAVITY * boat.length)
    weight = boat.mass * GRAVITY
    lines = [
        f"thrust at rest: {digits(reference.thrust, 4)} N, {reference.thrust / weight:.3g} of the weight",
        f"top speed: {reference.speed:.3g} m/s, Froude number {froude:.2f}",
    ]
    lines.append(_stability_line(boat, reference.speed))
    for result in results:
        lines += _result_lines(result, boat.length)
        lines += [f"  note, {result.kind}: {note}" for note in result.notes]
    return lines


def _stability_line(boat: Boat, speed: float) -> str:
    found = straight_line_stability(boat)
    time = math.log(2.0) / abs(found.growth)
    distance = f"in {time:.3g} s, {time * speed / boat.length:.2g} L"
    if found.growth <= 0.0:
        return f"straight-line stability at full ahead: stable, a yaw rate halves {distance}"
    line = f"straight-line stability at full ahead: unstable, a yaw rate doubles {distance}; "
    if found.stable_n_r is None:
        return line + "no hull.n_r makes it stable; check hull.n_v, hull.y_r and x_g"
    return line + (
        f"a skeg, a fin aft or a lower unit adds yaw damping: below hull.n_r {found.stable_n_r:.3g} it is "
        f"stable, the file has {boat.hull.n_r:.3g}"
    )


def _result_lines(result: Result, length: float) -> list[str]:
    figures, setting = result.best, result.setting
    if result.kind == "straight" and "speed" in figures:
        return [f"speed at throttle {setting['throttle']:.1f}: {figures['speed'].value:.3g} m/s"]
    if result.kind == "turning-circle" and "tactical_diameter" in figures:
        angle = math.degrees(setting["angle"])
        sizes = (f"{name} {figures[name].value / length:.2f} L" for name in ("tactical_diameter", "advance"))
        return [f"turning circle at {angle:+.0f} deg: {', '.join(sizes).replace('_', ' ')}"]
    if result.kind == "stopping" and "track_reach" in figures:
        reach, time = figures["track_reach"].value, figures["stopping_time"].value
        return [f"stopping from full ahead: {reach:.3g} m, {reach / length:.1f} L, in {time:.3g} s"]
    return []


def _rows(boat: Boat) -> list[list[str]]:
    return [
        [
            in_markdown(key),
            in_markdown(_cell(value_at(boat, key.split(".")))),
            _cell(origin.sd),
            in_markdown(origin.unit),
            origin.provenance,
            in_markdown(origin.source),
        ]
        for key, origin in boat.provenance.items()
    ]


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return ", ".join(f"{one:.6g}" for one in value) if isinstance(value, tuple) else f"{value:.6g}"
