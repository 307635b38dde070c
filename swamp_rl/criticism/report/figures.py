"""Figures of the prediction error: tracks, errors by horizon, and missing forces."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.constants import Z95
from swamp_rl.criticism.data.command_names import as_column
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.inference.finding import Finding
from swamp_rl.criticism.inference.residual_force import Forces, residual_forces
from swamp_rl.criticism.likelihood.prediction_error import QUANTITIES, errors_at, restarts
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.report.words import force_name
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.figure_style import sheet, spaced_axes

Array = NDArray[np.float64]

SHOWN_RUNS = 6
WINDOW = 10.0  # s between restarts of the tracks that are drawn
BINS = 7
ROUGH = 0.121  # lengths of noise from which a measured track is drawn in dots
PERFECT = 4  # simulations of a perfect model
MEASURED, BEFORE, AFTER = "#a9b2ba", "#c0392b", "#1f6fb2"
NOISE: dict[str, Any] = {"color": "#555555", "ls": ":", "lw": 1.2}
PERFECT_MODEL = NOISE | {"ls": "--"}
DEGREES = 180.0 / math.pi
VARIABLE_UNITS = {
    "time": ("s", 1.0),
    "position": ("m", 1.0),
    "heading": ("°", DEGREES),
    "speed": ("m/s", 1.0),
    "surge": ("m/s", 1.0),
    "sway": ("m/s", 1.0),
    "yaw rate": ("°/s", DEGREES),
    "azimuth": ("°", DEGREES),
    "rudder": ("°", DEGREES),
    "throttle": ("of full", 1.0),
    "propeller": ("rps", 1.0),
}
# title, unit, factor from SI, channel whose noise is drawn
SHOWN = {
    "position_rmse_m": ("position", "m", 1.0, "north"),
    "heading_rmse_rad": ("heading", "degrees", DEGREES, "heading"),
    "surge_rmse_m_s": ("surge", "m/s", 1.0, "surge"),
    "sway_rmse_m_s": ("sway", "m/s", 1.0, "sway"),
    "yaw_rate_rmse_rad_s": ("yaw rate", "degrees/s", DEGREES, "yaw_rate"),
}


def draw(path: Path, finding: Finding, picture: Callable[[Any, Finding], None]) -> Path:
    """Save a picture as PNG; returns `path`."""
    with sheet(path, 10.5, 6.0, fitted=False) as figure:
        picture(figure, finding)
    return path


def draw_tracks(figure: Any, finding: Finding) -> None:
    """Measured tracks, and predictions of WINDOW from measured states, without and with the causes."""
    run_set = finding.run_set
    runs = min(SHOWN_RUNS, len(run_set.lengths))
    rows, columns = (2, math.ceil(runs / 2)) if runs > 3 else (1, runs)
    figure.set_size_inches(10.5, 3.9 * rows)
    grid = spaced_axes(figure, rows, columns).ravel()
    rough = finding.diagnosis.noise.get("north", 0.0) > ROUGH * run_set.boat.length
    seconds = min(WINDOW, 0.4 * float(run_set.lengths[:runs].min()) * run_set.dt)
    for run, axes in enumerate(grid[:runs]):
        measured = run_set.measured[run, : run_set.lengths[run]]
        if rough:
            axes.plot(measured[:, 1], measured[:, 0], ".", color=MEASURED, ms=3.5, mew=0)
        else:
            axes.plot(measured[:, 1], measured[:, 0], color=MEASURED, lw=4, solid_capstyle="round")
        drawn = [(Hypothesis(), np.zeros(0), BEFORE)]
        drawn += [(finding.extended_fit.hypothesis, finding.extended_fit.x, AFTER)] * finding.extended
        for hypothesis, x, colour in drawn:
            start = restarts(run_set, finding.weight, run, seconds)
            for track in start.predict(hypothesis, x) if start else ():
                axes.plot(track[:, 1], track[:, 0], color=colour, lw=1.3)
                axes.plot(*track[0, 1::-1], ".", color="#222222", ms=4, zorder=5)
        axes.set(title=run_set.names[run], xlabel="east [m]", ylabel="north [m]")
        axes.set_aspect("equal", adjustable="datalim")
    for axes in grid[runs:]:
        axes.remove()
    dots = {"marker": ".", "ls": "", "ms": 6}
    measured_as = {"measured": {"color": MEASURED, **(dots if rough else {"lw": 4})}}
    restart = {f"restart, every {seconds:.3g} s": {"color": "#222222", **dots}}
    _legend(figure, measured_as | _lines(finding, "predicted by the ") | restart)


def _lines(finding: Finding, before: str = "") -> dict[str, dict[str, Any]]:
    """Entries of a legend for the boat file and, where it differs, the extended boat."""
    extended = {f"{before}extended boat": {"color": AFTER, "lw": 1.5}} if finding.extended else {}
    return {f"{before}boat file": {"color": BEFORE, "lw": 1.5}} | extended


def _legend(figure: Any, entries: dict[str, dict[str, Any]]) -> None:
    """Above all axes; entries: the style of the line or the dot of each label."""
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], label=label, **style) for label, style in entries.items()]
    figure.legend(handles=handles, loc="upper center", ncols=len(handles), borderaxespad=0.2)


def draw_errors(figure: Any, finding: Finding) -> None:
    """Root mean square errors against the horizon, without and with the causes, and the measurement noise."""
    gains = finding.diagnosis.gain
    names = [name for name in QUANTITIES if any(getattr(gain, name) for gain in gains)]
    figure.set_size_inches(10.5, 3.4)
    if not names:
        figure.text(0.5, 0.5, "The runs are too short to measure prediction errors.", ha="center")
        return
    own = finding.diagnosis.gain_on != "other_runs"
    perfect = perfect_errors(finding, np.random.default_rng(0)) if own else {}
    for axes, name in zip(spaced_axes(figure, 1, len(names))[0], names, strict=True):
        title, unit, factor, channel = SHOWN[name]
        kept = [(gain.horizon_s, paired) for gain in gains if (paired := getattr(gain, name))]
        horizons = [horizon for horizon, _ in kept]
        axes.loglog(horizons, [factor * one.before for _, one in kept], "o-", color=BEFORE)
        if finding.extended:
            axes.loglog(horizons, [factor * one.after for _, one in kept], "s-", color=AFTER)
        if channel in finding.diagnosis.noise:  # which held-out runs may have alone
            noise = factor * finding.diagnosis.noise[channel] * math.sqrt(len(QUANTITIES[name]))
            axes.axhline(noise, **NOISE)
        known = [(h, factor * error) for h, error in perfect.get(name, {}).items() if h in horizons]
        if known:
            axes.loglog(*zip(*known, strict=True), **PERFECT_MODEL)
        _plain_ticks(axes, horizons)
        axes.set(title=title, xlabel="seconds ahead")
        axes.set_ylabel(f"error [{unit}]")
    perfect_model = {"perfect model": PERFECT_MODEL} if own else {}
    _legend(figure, _lines(finding) | perfect_model | {"measurement noise": NOISE})


def perfect_errors(finding: Finding, rng: np.random.Generator) -> dict[str, dict[float, float]]:
    """Errors of a perfect model, by quantity and horizon [s], in SI: the extended boat predicts its own
    simulated runs with noise of the estimated size. They grow with time, since the initial state has the
    error of the measurement.
    """
    at = finding.extended_fit
    numbers = np.repeat(at.x[None], len(finding.run_set.lengths), axis=0)
    squares: dict[float, Array] = {}
    for _ in range(PERFECT):
        synthetic = perfect_run_set(finding, rng)
        for gain in finding.diagnosis.gain:
            made = errors_at(synthetic, finding.weight, gain.horizon_s, at.hypothesis, numbers)
            before = squares.get(gain.horizon_s, np.zeros((0, len(CHANNELS))))
            squares[gain.horizon_s] = np.concatenate([before, made.error**2])
    return {
        name: {
            h: math.sqrt(np.nanmean(e[:, c]) * len(c))
            for h, e in squares.items()
            if np.isfinite(e[:, c]).any()
        }
        for name, c in QUANTITIES.items()
        if np.isfinite(finding.run_set.measured[..., c]).any()
    }


def perfect_run_set(finding: Finding, rng: np.random.Generator) -> RunSet:
    """The runs simulated with the extended boat, under the same noise."""
    run_set, noise, at = finding.run_set, finding.diagnosis.noise, finding.extended_fit
    sigma = np.array([noise.get(name, 0.0) for name in CHANNELS])
    measured = run_set.measured.copy()
    for run, length in enumerate(run_set.lengths):
        whole = (int(length) - 1 - int(run_set.first_compared[run])) * run_set.dt
        start = restarts(run_set, finding.weight, run, whole)
        if start is not None:
            first = int(start.first[0])
            track = start.predict(at.hypothesis, at.x)[0][: int(length) - first]
            measured[run, first : first + len(track)] = track + sigma * rng.standard_normal(track.shape)
    measured[np.isnan(run_set.measured)] = np.nan
    return replace(run_set, measured=measured)


def _plain_ticks(axes: Any, horizons: list[float]) -> None:
    """Ticks at the horizons, and vertical ones at 1, 2 and 5 times powers of ten, as decimal numbers.

    Over more than three decades, as of simulated runs without noise, at powers of ten only.
    """
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_xticks(horizons, labels=[f"{horizon:g}" for horizon in horizons])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_minor_locator(LogLocator(subs=[]))
    low, high = axes.get_ylim()
    wider = max(1.3, math.sqrt(6.0 * low / high))
    axes.set_ylim(low / wider, high * wider)
    axes.yaxis.set_major_locator(LogLocator(subs=[1.0] if high > 1e3 * low else [1.0, 2.0, 5.0]))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def draw_forces(figure: Any, finding: Finding) -> None:
    """Residual surge and sway force and yaw moment against the boat's motion and commands."""
    before = residual_forces(finding.run_set, finding.weight, Hypothesis(), np.zeros(0))
    every = [before]
    if finding.extended:
        at = finding.extended_fit
        every.append(residual_forces(finding.run_set, finding.weight, at.hypothesis, at.x))
    chosen = shown_variables(finding.run_set, before, thrusters_of_causes(finding.diagnosis))
    figure.set_size_inches(10.5, 6.3)
    axes = spaced_axes(figure, 3, len(chosen), labelled=False, sharey="row", sharex="col")
    titles = ("surge force [N]", "sway force [N]", "yaw moment [N m]")
    for row, title in enumerate(titles):
        largest = max(float(np.quantile(np.abs(one.force[:, row]), 0.93)) for one in every)
        reach = 1.3 * largest or 1.0  # where all are zero
        for column, (name, (label, factor)) in enumerate(chosen.items()):
            ax = axes[row, column]
            ax.axhline(0, color="#888888", lw=0.8)
            for forces, colour in zip(every, (BEFORE, AFTER), strict=False):
                if name in forces.variables:
                    _scatter(ax, factor * forces.variables[name], forces.force[:, row], colour)
            ax.set_ylim(-reach, reach)
            if row == 2:
                ax.set_xlabel(label)
        axes[row, 0].set_ylabel(title)
    _legend(figure, _lines(finding, "missing from the "))


def thrusters_of_causes(found: Diagnosis) -> list[str]:
    """Thrusters that causes or residual forces are found on."""
    named = [cause.thruster for cause in found.causes if cause.thruster not in (None, "all")]
    of_forces = [one.force.removeprefix("thrust of ") for one in found.leftover if "thrust of" in one.force]
    return [name for one in named for name in ([one] if isinstance(one, str) else one or [])] + of_forces


def shown_variables(
    run_set: RunSet, forces: Forces, preferred: Sequence[str] = ()
) -> dict[str, tuple[str, float]]:
    """Label and factor by name: motion, and azimuth and throttle of a preferred or the most used thruster."""
    every = run_set.boat.thruster_names
    names = [name for name in every if name in preferred[:1]] or every

    def most_moved(what: str) -> str:
        named = [f"{what} {name}" for name in names]
        return max(named, key=lambda one: float(np.ptp(forces.variables.get(one, np.zeros(1)))))

    wanted = ("speed", "yaw rate", most_moved("throttle"), most_moved("azimuth"), "heading", "time")
    return {name: labelled(name, run_set.boat) for name in wanted if name in forces.variables}


def labelled(variable: str, boat: Boat) -> tuple[str, float]:
    """A variable with its unit as drawn, and the factor from SI; commands as `as_column` names them."""
    name = as_column(variable, boat)
    unit, factor = VARIABLE_UNITS[name if name in VARIABLE_UNITS else name.split()[0]]
    return f"{name} [{unit}]", factor


def draw_missing(figure: Any, finding: Finding) -> None:
    """Each residual force as a function of its variable, with its 95 % interval."""
    functions = [one for one in finding.diagnosis.leftover if one.curve]
    figure.set_size_inches(10.5, 2.7)
    axes = spaced_axes(figure, 1, max(3, len(functions)), legend=False)[0]
    for ax in axes[len(functions) :]:
        ax.set_visible(False)
    for ax, one in zip(axes, functions, strict=False):
        label, factor = labelled(one.variable, finding.run_set.boat)
        at = factor * np.array([point.at for point in one.curve])
        force = np.array([point.force for point in one.curve])
        reach = Z95 * np.array([point.standard_error for point in one.curve])
        ax.axhline(0, color="#888888", lw=0.8)
        ax.fill_between(at, force - reach, force + reach, color=BEFORE, alpha=0.18, lw=0)
        ax.plot(at, force, "o-", ms=3.5, lw=1.5, color=BEFORE)
        ax.set_xlabel(label)
        ax.set_ylabel(f"{force_name(one.force)} [{'N m' if one.force == 'yaw' else 'N'}]")


def _scatter(axes: Any, values: Array, force: Array, colour: str) -> None:
    """Points, and the mean of each bin with one standard error."""
    axes.plot(values, force, ".", ms=4.5, color=colour, alpha=0.4, mew=0)
    edges = np.unique(np.quantile(values, np.linspace(0, 1, BINS + 1)[1:-1]))
    place = np.searchsorted(edges, values)
    kept = [here for b in range(len(edges) + 1) if (here := place == b).sum() >= 4]
    middle = [float(values[here].mean()) for here in kept]
    mean = [float(force[here].mean()) for here in kept]
    error = [float(force[here].std(ddof=1)) / math.sqrt(here.sum()) for here in kept]
    axes.errorbar(middle, mean, yerr=error, fmt="o-", ms=3.5, lw=1.3, color=colour, capsize=2)
