"""The sway drag that diagnosis names on the pond, and the circles, held out, that the boat then predicts."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.circles import after_a_minute, measured_turn, predicted_turn
from benchmarks.esso_osaka.diagnosis import Diagnosed
from benchmarks.esso_osaka.turning import turn_of
from benchmarks.esso_osaka.wind import Named, misfit, with_effects
from swamp_rl.boat import Boat
from swamp_rl.effects import parse_effects
from swamp_rl.runs import Run

Array = NDArray[np.float64]

BESIDE = ("sway_drag", "wind")
FIGURES = ("tactical diameter", "advance", "speed", "drift angle", "yaw rate")


def with_sway_drag(boat: Boat, scale: float) -> Boat:
    """The boat file with its drag sideways so many times as large."""
    added = parse_effects([{"effect": "sway_drag", "scale": scale}], "sway drag", boat.thruster_names)
    return with_effects(boat, added)


def sway_scales(every: Sequence[Named]) -> Array:
    """(runs,) scale of the sway drag beside each run's own wind."""
    return np.array([one.fits[BESIDE].x[0] for one in every])


def mean_interval(values: Array) -> tuple[float, float, float]:
    """Mean of values (n,) and its 95 % interval by Student's t."""
    mean, reach = float(values.mean()), float(stats.t.ppf(0.975, len(values) - 1) * stats.sem(values))
    return mean, mean - reach, mean + reach


def diagnosed_scales(result: Mapping[str, Diagnosed], every: Sequence[Named]) -> dict[str, float]:
    """Scales of the sway drag by where they are from: each diagnosis that names a wind beside it, and the
    mean over the runs.
    """
    found = {}
    for day, one in result.items():
        sway = [cause for cause in one.diagnosis.causes if cause.effect == "sway_drag"]
        if sway and one.speed is not None:
            scale = sway[0].parameters["scale"].value
            found[f"sway drag x {scale:.2f}, diagnosed on {day}"] = scale
    mean = mean_interval(sway_scales(every))[0]
    return found | {f"sway drag x {mean:.2f}, mean of the runs": mean}


def sway_table(every: Sequence[Named]) -> str:
    """The sway drag run by run, and what it does for minutes held out."""
    scales = sway_scales(every)
    rows = [
        [one.run.name, f"{scale:.2f}", f"{misfit(one, ('wind',)):.2f}", f"{misfit(one, BESIDE):.2f}"]
        for one, scale in zip(every, scales, strict=True)
    ]
    mean, low, high = mean_interval(scales)
    before, after = (np.mean([misfit(one, names) for one in every]) for names in (("wind",), BESIDE))
    shown = f"**{mean:.2f} ({low:.2f} to {high:.2f})**"
    rows.append(["**mean (95 % interval)**", shown, f"{before:.2f}", f"{after:.2f}"])
    return table(["run", "sway drag / boat file's", "held-out misfit, wind only", "wind and sway drag"], rows)


def figures(turn: Array) -> tuple[float, ...]:
    """Those of `FIGURES`, of a turn's track."""
    begun = turn_of(turn)
    return (begun.tactical_diameter, begun.advance, *after_a_minute(turn))


def errors(boat: Boat, turning: Sequence[Run]) -> dict[str, Array]:
    """(turns,) by how much of the measured value each predicted figure is off [%]."""
    seen, made = (
        np.array([figures(turn) for turn in turns])
        for turns in (map(measured_turn, turning), (predicted_turn(boat, run) for run in turning))
    )
    return dict(zip(FIGURES, 100.0 * (made / seen - 1.0).T, strict=True))


def circles_table(boat: Boat, scales: Mapping[str, float], turning: Sequence[Run]) -> str:
    """Errors of the boat file's circles, and of the same with each sway drag."""
    boats = {"boat file": boat} | {name: with_sway_drag(boat, scale) for name, scale in scales.items()}
    off = {name: errors(each, turning) for name, each in boats.items()}
    rows = [[figure, *(median_and_worst(one[figure]) for one in off.values())] for figure in FIGURES]
    return table(["error, median (worst)", *off], rows)


def median_and_worst(errors: Array) -> str:
    """Median of their sizes, and the one that is farthest from zero."""
    return f"{np.median(np.abs(errors)):.0f} % ({errors[np.argmax(np.abs(errors))]:+.0f} %)"
