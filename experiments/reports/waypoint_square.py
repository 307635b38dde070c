"""A waypoint square: the vehicle's numbers as identified, the replay, its figure."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from swamp_rl.clipped import in_markdown
from swamp_rl.errors import UserError
from swamp_rl.figure_style import sheet
from swamp_rl.identification.square_twin import STEP, Log, Vehicle, load_vehicle, sail
from swamp_rl.identification.waypoint_square import AXES, NEEDED, Found, identify, replay, track_error
from swamp_rl.unfinished import folder_beside

Array = NDArray[np.float64]

DATA = "result.json"


def write_square(out: Path, name: str, seed: int) -> list[str]:
    """Sail, identify and replay the square of a vehicle file, and write the folder; lines to print.

    UserError where the log shows none of the axes.
    """
    vehicle = load_vehicle(name)
    log = sail(vehicle, seed)
    found = identify(vehicle, log)
    if not any(one.shown for one in found):
        refused = "; ".join(refusal(one) for one in found)
        raise UserError(f"{name}: nothing can be identified from the square; {refused}")
    poses = replay(vehicle, log, found)
    error = track_error(log, poses)
    with folder_beside(out, replaces=DATA) as part:
        result = as_json(vehicle, log, found, error, seed)
        (part / DATA).write_text(json.dumps(result, indent=1, allow_nan=False), encoding="utf-8")
        (part / "report.md").write_text(
            report(vehicle, found, lines(vehicle, log, found, error)), encoding="utf-8"
        )
        draw(part / "square.png", vehicle, log, poses, error)
    return lines(vehicle, log, found, error)


def refusal(one: Found) -> str:
    """Why an axis is not shown, and what to record."""
    return f"{one.axis}: {next(why for why in one.doubts if why)}; record {NEEDED[one.axis]}"


def as_json(vehicle: Vehicle, log: Log, found: list[Found], error: Array, seed: int) -> dict[str, Any]:
    """Every number of the square."""
    axes = {
        one.axis: {"shown": one.shown, "doubts": list(one.doubts)}
        | ({"mass": one.estimates[0]._asdict(), "drag": one.estimates[1]._asdict()} if one.estimates else {})
        for one in found
    }
    return {
        "vehicle": vehicle.name,
        "source": "simulated",
        "seed": seed,
        "length": log.length,
        "time": len(log.force) * STEP,
        "axes": axes,
        "track_error": figures(error),
    }


def figures(error: Array) -> dict[str, float]:
    """Mean, root mean square, standard deviation and greatest error [m]."""
    rms = math.sqrt(float((error**2).mean()))
    return {"mean": float(error.mean()), "rms": rms, "sd": float(error.std()), "max": float(error.max())}


def rows_of(vehicle: Vehicle, found: list[Found]) -> list[list[str]]:
    """A row for each number that the log shows."""
    rows = []
    for axis, one in enumerate(found):
        if not one.shown or one.estimates is None:
            continue
        for what, estimate, true in zip(
            ("mass", "drag"), one.estimates, (vehicle.masses[axis], vehicle.drags[axis]), strict=True
        ):
            between = f"{estimate.low:.4g} to {estimate.high:.4g}"
            rows.append(
                [f"{AXES[axis]} {what}", estimate.unit, f"{true:.4g}", f"{estimate.value:.4g}", between]
            )
    return rows


def lines(vehicle: Vehicle, log: Log, found: list[Found], error: Array) -> list[str]:
    """What the command line prints."""
    entries = [f"{log.length:.1f} m in {len(log.force) * STEP:.0f} s"]
    entries += [
        f"{name:<11} {value} {unit:<7} 95 % {between}, file {true}"
        for name, unit, true, value, between in rows_of(vehicle, found)
    ]
    entries += [f"not identifiable: {refusal(one)}" for one in found if not one.shown]
    e = figures(error)
    return [
        *entries,
        f"replay: mean track error {e['mean']:.2f} m, rms {e['rms']:.2f} m, max {e['max']:.2f} m",
    ]


def report(vehicle: Vehicle, found: list[Found], text: list[str]) -> str:
    """The Markdown report."""
    head = ["number", "unit", "file", "identified", "95 %"]
    body = "\n".join(f"* {line}" for line in (text[0], *text[1 + len(rows_of(vehicle, found)) :]))
    return (
        f"# Waypoint square of {in_markdown(vehicle.name)}\n\n"
        f"Simulated. {in_markdown(vehicle.description)}\n\n"
        f"{table(head, rows_of(vehicle, found))}\n\n{body}\n\n![square](square.png)\n"
    )


def draw(path: Path, vehicle: Vehicle, log: Log, poses: Array, error: Array) -> None:
    """Write a PNG: the square from above as sailed and as replayed; depth; track error."""
    time = np.arange(len(log.force)) * STEP
    with sheet(path, 7.2, 7.2) as canvas:
        above, depth, off = canvas.subplots(3, 1, height_ratios=(3, 1, 1))
        for where, colour, style, label in (
            (log.pose, "#444444", "-", "sailed"),
            (poses, "#c0562f", "--", "replayed"),
        ):
            above.plot(where[:, 1], where[:, 0], color=colour, ls=style, label=label)
            depth.plot(time, where[:, 2], color=colour, ls=style)
        above.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
        above.legend(loc="best")
        depth.set(ylabel="depth [m]")
        depth.invert_yaxis()
        off.plot(time, error, color="#2b6ca3")
        off.set(xlabel="time [s]", ylabel="track error [m]")
        canvas.suptitle(f"Waypoint square of {vehicle.name}", fontweight="bold")
