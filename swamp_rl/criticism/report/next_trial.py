"""The next trial in words and as a figure: what it is to show, the tracks to be expected, the commands."""

import html
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.boat import Boat, PropellerRudder
from swamp_rl.criticism.inference.next_trial import Designed
from swamp_rl.criticism.report.words import manoeuvre_words, readable
from swamp_rl.criticism.result import Diagnosis, Narrowed, NextTrial
from swamp_rl.digits import digits
from swamp_rl.figure_style import sheet
from swamp_rl.html_page import image, table

LISTED = 3  # fixed manoeuvres beside the trial


def next_trial_sentences(trial: NextTrial) -> list[str]:
    """What the trial is, what it is expected to decide, and how much better it is than a fixed manoeuvre."""
    north, east = trial.start_m
    sentences = [
        f"{trial.file}: {trial.duration_s:.0f} s within {trial.area_m[0]:g} x {trial.area_m[1]:g} m (north x "
        f"east), up to {trial.top_speed:.2g} m/s; start at rest, bow to the north, {north:.1f} m north and "
        f"{east:.1f} m east of the south-west corner"
    ]
    if trial.separates:
        closest = trial.separates[0]
        of = " or more between any two, the least" if len(trial.separates) > 1 else ""
        sentences.append(
            f"{closest.separation:.3g} standard errors expected{of} between {_sum(closest.effects[0])} and "
            f"{_sum(closest.effects[1])}"
        )
    if one := trial.narrows:
        unit = f" {one.unit}" if one.unit != "1" else ""
        now = f"{digits(one.before, 2)}{unit} now" if one.identifiable else "not determined now"
        sentences.append(
            f"narrows {one.parameter.replace('_', ' ')} of {readable(one.effect)}: a standard error of "
            f"{digits(one.after, 2)}{unit} expected, {now}{_limited(one, trial.evidence)}"
        )
    if trial.of_list and trial.of_list[0].evidence > 0.0:
        best = trial.of_list[0]
        sentences.append(
            f"{trial.evidence / best.evidence:.3g} times the evidence of the best fixed manoeuvre within the "
            f"same limits ({best.manoeuvre})"
        )
    return sentences


def _sum(label: str) -> str:
    """The effects of an explanation joined by a plus: an `and` stands between two explanations."""
    return " + ".join(readable(part) for part in label.split(" + "))


def _limited(narrows: Narrowed, evidence: float) -> str:
    """That estimates scatter between runs by more than the noise of the trial."""
    if narrows.scatter * evidence <= 1.0:
        return ""
    return " (runs differ by more than noise: several more, each different, narrow it further)"


def next_trial_section(found: Diagnosis, images: Mapping[str, str]) -> str:
    """The trial as a part of the page; empty where none was designed."""
    trial = found.next_trial
    if trial is None:
        return ""
    listed = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in next_trial_sentences(trial))
    rows = [("this trial", f"{trial.evidence:.3g}", f"{trial.duration_s:.0f}")]
    rows += [
        (manoeuvre_words(one.manoeuvre), f"{one.evidence:.3g}", f"{one.duration_s:.0f}")
        for one in trial.of_list[:LISTED]
    ]
    unit = "information, in multiples of the present" if trial.narrows else "evidence [χ²]"
    picture = image(images["next_trial"], "Next trial") if "next_trial" in images else ""
    return (
        f"<h2>The next trial</h2><ul>{listed}</ul>{picture}<p>Evidence is twice the expected difference of "
        "log likelihood between the two explanations that are separated least, their parameters and the "
        "initial states fitted anew. A manoeuvre ends where it exceeds a limit.</p>"
        + table(("manoeuvre", unit, "duration [s]"), rows, numbers=(1, 2))
    )


def draw_next_trial(path: Path, trial: Designed, boat: Boat, dt: float) -> Path:
    """Save tracks and commands as PNG; returns `path`."""
    with sheet(path, 10.5, 4.4) as figure:
        left, right = figure.subfigures(1, 2, width_ratios=(1, 1.4))
        _draw_tracks(left.subplots(), trial)
        panels = _panels(boat)
        drawn = right.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        time, count = dt * np.arange(len(trial.commands)), len(boat.thrusters)
        lines = {}
        for axes, (label, columns) in zip(drawn, panels.items(), strict=True):
            for column in columns:
                values = trial.commands[:, column]
                values = np.degrees(values) if column < count else values
                k = column % count
                (lines[k],) = axes.step(time, values, where="post", lw=1.2, color=f"C{k}")
            axes.set(ylabel=label)
        drawn[-1].set(xlabel="time [s]")
        handles = [lines[k] for k in range(count)]
        drawn[0].legend(
            handles, boat.thruster_names, ncols=count, loc="lower center", bbox_to_anchor=(0.5, 1.0)
        )
    return path


def _panels(boat: Boat) -> dict[str, list[int]]:
    """Columns of the commands (T, 2K) by quantity, of those that the boat has."""
    found: dict[str, list[int]] = {"angle [°]": [], "throttle": [], "revolutions [rps]": []}
    for k, thruster in enumerate(boat.thrusters):
        if thruster.command_columns[0] is not None:
            found["angle [°]"].append(k)
        level = "revolutions [rps]" if isinstance(thruster, PropellerRudder) else "throttle"
        found[level].append(len(boat.thrusters) + k)
    return {label: columns for label, columns in found.items() if columns}


def _draw_tracks(axes: Any, trial: Designed) -> None:
    """The tracks under each explanation, in the area."""
    north, east = trial.result.area_m
    axes.plot([0, east, east, 0, 0], [0, 0, north, north, 0], color="#5b6874", lw=1.0)
    for name, track in zip(trial.names, trial.tracks, strict=True):
        axes.plot(track[:, 1], track[:, 0], lw=1.3, label=readable(name))
    axes.plot(*trial.result.start_m[::-1], "o", color="#222222", ms=4)
    axes.set(xlabel="east [m]", ylabel="north [m]")
    axes.set_aspect("equal")
    axes.legend(fontsize=7, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=1)
