"""The tables of a page on a measured boat."""

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from swamp_rl.boat_fit.identify import errors_on
from swamp_rl.boat_fit.recent_thrust import recent_errors
from swamp_rl.boat_fit.report import gains_sentence, held_out_sentence, summary
from swamp_rl.boat_fit.result import Identification
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.prediction_error import (
    blocks_of,
    boat_file_errors,
    change,
    without_thrust,
)
from swamp_rl.criticism.report.evidence import TRIVIAL
from swamp_rl.doctor.examine import examine
from swamp_rl.doctor.read import read_records

COMPARED = {
    "position, m": ([0, 1], 1.0),
    "heading, deg": ([2], float(np.degrees(1.0))),
    "sway, m/s": ([4], 1.0),
}
"""Columns of the errors of two files, and the factor on them."""
SHOWN = 5.0  # s, horizon of the table by run
PREDICTORS = ["identified with gains", "without gains", *(name.replace("_", " ") for name in TRIVIAL)]


def error_table(found: Identification) -> str:
    """Errors [m] on the held-out runs by horizon."""
    rows = [
        [
            f"{was.horizon_s:g}",
            f"{was.boat_file:.3f}",
            f"{with_gains.boat_file:.3f}",
            f"{now.boat_file:.3f}",
            *(f"{getattr(now, name):.3f}" for name in TRIVIAL),
        ]
        for was, now, with_gains in zip(found.before, found.after, found.predicted, strict=True)
    ]
    return table(["horizon, s", "start", *PREDICTORS], rows)


def compared_table(found: Identification, other: Identification) -> str:
    """Errors on the held-out runs of two identified files, and the intervals of their differences."""
    weight, rows = weights(found.data.held_out, noise_levels(found.data.held_out)), []
    files = [replace(found.data.held_out, boat=one.boat) for one in (found, other)]
    latest = np.maximum(*(runs.first_compared for runs in files))
    for runs in files:
        vars(runs)["first_compared"] = latest  # the cached property: both predict from the same rows
    for horizon in (one.horizon_s for one in found.after):
        before, after = (boat_file_errors(runs, weight, horizon) for runs in files)
        block, row = blocks_of(after, horizon)[0], [f"{horizon:g}"]
        for columns, factor in COMPARED.values():
            paired = change(
                before.error[:, columns], after.error[:, columns], block, np.random.default_rng(0)
            )
            if paired:
                sizes = [factor * size for size in (paired.before, paired.after, *paired.ci95)]
                row += [f"{sizes[0]:.3f}", f"{sizes[1]:.3f}", f"{sizes[2]:.3f} to {sizes[3]:.3f}"]
        rows.append(row)
    heads = [part for name in COMPARED for part in (f"{name}, without", "with", "95 % of the difference")]
    return table(["horizon, s", *heads], rows)


def number_table(found: Identification, names: Collection[str] = ()) -> str:
    """The numbers that the runs show, or those whose names end in one of `names`."""
    rows = [
        [
            f"`{one.number.name}`",
            f"{one.number.start:.3g}",
            f"{one.value:.3g}",
            f"{one.standard_error:.2g}",
            one.number.unit,
        ]
        for one in found.fitted
        if (one.number.name.endswith(tuple(names)) if names else one.shown)
    ]
    return table(["number", "start", "identified", "standard error", "unit"], rows)


def run_table(found: Identification) -> str:
    """Errors [m] at 5 s on each held-out run, and the span of its commands."""
    rows, held = [], found.data.held_out
    count = len(found.boat.thrusters)
    for i, (name, length) in enumerate(zip(held.names, held.lengths, strict=True)):
        run = held.subset([i])
        own = next(one for one in errors_on(run, found.boat) if one.horizon_s == SHOWN)
        recent = next(one for one in recent_errors(run, found.boat, found.gains) if one.horizon_s == SHOWN)
        levels = held.commands[i, :length, count:]
        spans = [f"{low:.2f} to {high:.2f}" for low, high in zip(levels.min(0), levels.max(0), strict=True)]
        errors = [recent.position, own.boat_file, *(getattr(own, trivial) for trivial in TRIVIAL)]
        rows.append([name.split(",")[0].split("_")[-1], *spans, *(f"{error:.2f}" for error in errors)])
    names = [f"throttle of {thruster.name}" for thruster in found.boat.thrusters]
    return table(["run", *names, *PREDICTORS], rows)


def thrust_table(found: Identification) -> str:
    """Errors [m] on the held-out runs without thrust and with it, and the interval of their difference."""
    held = replace(found.data.held_out, boat=found.boat)
    weight, rows = weights(held, noise_levels(held)), []
    for horizon in (one.horizon_s for one in found.after):
        before, after = (boat_file_errors(runs, weight, horizon) for runs in (without_thrust(held), held))
        block, _ = blocks_of(after, horizon)
        paired = change(before.error[:, :2], after.error[:, :2], block, np.random.default_rng(0))
        if paired:
            low, high = paired.ci95
            span = f"{low:.4f} to {high:.4f}"
            rows.append([f"{horizon:g}", f"{paired.before:.4f}", f"{paired.after:.4f}", span])
    return table(["horizon, s", "no thrust", "without gains", "95 % interval of the difference"], rows)


def findings(found: Identification) -> str:
    """What `identify boat` says, a line each."""
    return "\n".join(
        f"* {line}" for line in [*summary(found), held_out_sentence(found), gains_sentence(found)]
    )


def doctor_lines(dataset: Path) -> str:
    """What `runs doctor` finds, a line each."""
    records = read_records(dataset, None)
    return "\n".join(f"* {finding}" for finding in examine(records.runs, records.boat, records.measured))
