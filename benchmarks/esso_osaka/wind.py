"""The wind on the pond, named from the motion of the model ship alone and held against the anemometer."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.windows import WIND, errors_at_end
from swamp_rl.boat import Boat
from swamp_rl.criticism.data.run_set import CHANNELS, run_set_of
from swamp_rl.criticism.likelihood.cross_validation import heldout_loss
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit, fit_states
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.selection.score_test import at_neutral_values
from swamp_rl.effects import EffectEntry
from swamp_rl.runs import Run

Array = NDArray[np.float64]

WINDOW = 60.0  # s, each with an initial state of its own
HORIZON = 30.0  # s from a measured state, as the independent program has it
INDEPENDENT = {"no wind": 0.75, "wind": 0.60, "measured wind": 0.47}
"""Root mean square position errors [m] at the horizon by an independent program: without wind, with the wind
identified from the other minutes, with the measured one."""
# Where the weights begin: what a model with the wind right may miss in a minute; then the misfit sets them.
FIRST_SIGMA = np.array([0.1, 0.1, 0.05, 0.02, 0.02, 0.004])
ROUNDS = 4  # steps that the initial states are given alone, before the effects move
BREEZES = (1.0, 2.5)  # m/s
CANDIDATES: tuple[tuple[str, ...], ...] = (
    (),
    ("wind",),
    ("current",),
    ("external_force",),
    ("current", "wind"),
    ("sway_drag", "wind"),
)


@dataclass(frozen=True)
class Named:
    """A run without its wind columns, as fitted: fits by the names of what was added."""

    run: Run
    problem: Shooting
    fits: dict[tuple[str, ...], Fit]


def hidden(run: Run) -> Run:
    """The run without the anemometer."""
    return Run(run.name, {name: values for name, values in run.columns.items() if name not in WIND}, run.meta)


def named(boat: Boat, run: Run) -> Named:
    """Every candidate fitted to the run's motion, weighted by what is left of the wind's own fit."""
    run_set = run_set_of([hidden(run)], boat, run.name)
    problem = Shooting(run_set, np.isfinite(run_set.measured) / FIRST_SIGMA, WINDOW)
    states = problem.initial_states()
    found = fitted(boat, problem, ("wind",), likely_wind(boat, problem, states), states)
    residual = found.residual.reshape(found.residual.shape[0], -1, len(CHANNELS))
    sigma = FIRST_SIGMA * np.sqrt(np.mean(residual**2, axis=(0, 1)))
    problem = Shooting(run_set, np.isfinite(run_set.measured) / sigma, WINDOW)
    fits, instances = {}, by_label(candidates(boat, 1e3))
    for names in CANDIDATES:
        begin = np.array([x for name in names for x in at_neutral_values(instances[name], boat).starts[0]])
        if "wind" in names:
            begin[-2:] = found.x
        fits[names] = fitted(boat, problem, names, begin, states)
    return Named(run, problem, fits)


def likely_wind(boat: Boat, problem: Shooting, states: Array) -> Array:
    """(2,) the wind's vector that leaves least, of a few speeds from eight directions: where a fit begins."""
    hypothesis = Hypothesis((by_label(candidates(boat, 1e3))["wind"],))
    tried = [s * np.array([math.cos(a), math.sin(a)]) for s in BREEZES for a in np.arange(8) * math.pi / 4]
    left = [float((fit_states(problem, hypothesis, x, states, ROUNDS)[2] ** 2).sum()) for x in tried]
    return tried[int(np.argmin(left))]


def fitted(boat: Boat, problem: Shooting, names: tuple[str, ...], x: Array, states: Array) -> Fit:
    """The named effects fitted together from x (p,) and states (W, 6)."""
    instances = by_label(candidates(boat, 1e3))
    hypothesis = Hypothesis(tuple(instances[name] for name in names))
    return fit(problem, hypothesis, x, fit_states(problem, hypothesis, x, states, ROUNDS)[0])


def wind_of(found: Fit) -> tuple[float, float]:
    """Speed [m/s] and direction it comes from [rad] of a fit whose last two numbers are a wind."""
    return float(np.hypot(*found.x[-2:])), float(np.arctan2(found.x[-1], found.x[-2]))


def anemometer(run: Run) -> tuple[float, float]:
    """Mean speed [m/s] and direction of the mean wind [rad]."""
    speed, angle = run.columns["wind_speed"], run.columns["wind_from"]
    return float(speed.mean()), float(
        np.arctan2((speed * np.sin(angle)).mean(), (speed * np.cos(angle)).mean())
    )


def apart(one: float, other: float) -> float:
    """Angle between two directions [degrees], from -180 to 180."""
    return math.degrees(math.remainder(one - other, 2.0 * math.pi))


def wind_table(every: Sequence[Named]) -> str:
    """The named wind beside the anemometer's, run by run; medians last."""
    rows, angles, ratios = [], [], []
    for one in every:
        speed, angle = anemometer(one.run)
        message, wind_from = wind_of(one.fits["wind",])
        angles.append(apart(wind_from, angle))
        ratios.append(message / speed)
        rows.append(
            [
                one.run.name,
                f"{speed:.2f} from {math.degrees(angle):.0f}",
                f"{message:.2f} from {math.degrees(wind_from):.0f}",
                f"{angles[-1]:+.0f}",
                f"{ratios[-1]:.2f}",
            ]
        )
    off = np.abs(angles)
    rows.append(
        [
            "**median (worst)**",
            "",
            "",
            f"**{np.median(off):.0f} ({off.max():.0f})**",
            f"**{np.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})**",
        ]
    )
    rows.append(["an independent program, nine runs", "", "", "13 (30)", "0.99 (0.63 to 1.38)"])
    head = ["run", "anemometer, m/s, deg", "identified, m/s, deg", "error, deg", "speed / measured"]
    return table(head, rows)


def ranking_table(every: Sequence[Named]) -> str:
    """Misfit of each candidate on minutes held out, over all runs."""
    losses = {names: [misfit(one, names) for one in every] for names in CANDIDATES}
    rows = [
        [" + ".join(names) or "nothing", *(f"{loss:.2f}" for loss in own), f"**{np.mean(own):.2f}**"]
        for names, own in sorted(losses.items(), key=lambda item: float(np.mean(item[1])))
    ]
    return table(["added", *(one.run.name[-14:] for one in every), "mean"], rows)


def drift_table(every: Sequence[Named]) -> str:
    """Wind and current named together: does the current run down the wind, and how fast?"""
    rows = []
    for one in every:
        found = one.fits["current", "wind"]
        result, wind_from = wind_of(found)
        speed, angle = anemometer(one.run)
        current, towards = float(np.hypot(*found.x[:2])), float(np.arctan2(found.x[1], found.x[0]))
        rows.append(
            [
                one.run.name,
                f"{result:.2f}, {apart(wind_from, angle):+.0f}",
                f"{100 * current:.1f}",
                f"{apart(towards, angle + math.pi):+.0f}",
                f"{100 * current / speed:.1f}",
            ]
        )
    head = ["run", "wind, m/s, error in deg", "current, cm/s", "from downwind, deg", "% of the wind speed"]
    return table(head, rows)


def with_effects(boat: Boat, entries: Sequence[EffectEntry]) -> Boat:
    """The boat file with further effects."""
    return boat.model_copy(update={"effects": (*boat.effects, *entries)})


def horizon_errors(boat: Boat, one: Named, names: tuple[str, ...]) -> Array:
    """(n,) position errors [m] at the horizon, in each half of the minutes with the fit of the other half."""
    count = one.problem.windows.count
    steps = round(HORIZON / one.problem.dt)
    errors = []
    for odd in (0, 1):
        others, whole = np.arange(count) % 2 != odd, one.fits[names]
        result = fitted(boat, one.problem.part(others), names, whole.x, whole.states[others])
        first = (one.problem.windows.first + one.problem.windows.pad)[np.arange(count) % 2 == odd]
        starts = np.concatenate([first, first + steps])
        starts = starts[starts + steps < len(one.run.time)]
        extended = with_effects(boat, result.hypothesis.entries(result.x))
        errors.append(errors_at_end(extended, one.run, HORIZON, False, starts))
    return np.concatenate(errors)


def error_table(boat: Boat, every: Sequence[Named], rms: dict[str, float]) -> str:
    """Position error at the horizon; rms: without wind and with the measured one."""
    rows = [["nothing", f"{rms['calm']:.2f}", f"{INDEPENDENT['no wind']:.2f}"]]
    for names in CANDIDATES[1:]:
        errors = np.concatenate([horizon_errors(boat, one, names) for one in every])
        theirs = f"{INDEPENDENT['wind']:.2f}" if names == ("wind",) else ""
        message = f"{' and '.join(names)}, from the motion of the other minutes".replace("_", " ")
        rows.append([message, f"{np.sqrt(np.mean(errors**2)):.2f}", theirs])
    theirs = f"{INDEPENDENT['measured wind']:.2f}"
    rows.append(["the measured wind, sample by sample", f"{rms['measured']:.2f}", theirs])
    return table(["added to the boat file", "error at 30 s, m", "an independent program, m"], rows)


def misfit(one: Named, names: tuple[str, ...]) -> float:
    """Loss of the held-out minutes, per sample, with the named effects."""
    return float(heldout_loss(one.problem, one.fits[names]).sum()) / one.problem.samples
