"""Sentences of docs/esso_osaka.md, made from the figures that they speak of."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.esso_osaka.wind import CANDIDATES, Named, anemometer, apart, wind_of
from swamp_rl.boat import Boat
from swamp_rl.criticism.heldout import heldout_loss
from swamp_rl.errors import UserError
from swamp_rl.runs.free_running import import_free_running
from swamp_rl.runs.turning import Turn

Array = NDArray[np.float64]
Circle = tuple[Turn, Turn, Turn]
Steady = tuple[float, float, float]  # speed [m/s], drift angle [deg], yaw rate [deg/s]


def span(values: Sequence[float]) -> str:
    """Least to most of changes in percent, with their signs."""
    return f"{min(values):+.0f} to {max(values):+.0f} %"


def circle_words(circles: Sequence[Circle]) -> str:
    """How far the predicted circles are off, with the measured wind."""
    wide = [100.0 * (windy.tactical_diameter / seen.tactical_diameter - 1.0) for seen, windy, _ in circles]
    ahead = [100.0 * (windy.advance / seen.advance - 1.0) for seen, windy, _ in circles]
    turns = "wider" if np.median(wide) > 0.0 else "tighter"
    diameter, advance = (f"{span(off)} (median {np.median(off):+.0f} %)" for off in (wide, ahead))
    return (
        f"The model turns {turns} than the ship: with the measured wind its tactical diameter is off by "
        f"{diameter}, its advance by {advance}."
    )


def steady_words(figures: Sequence[tuple[Steady, Steady, Steady]]) -> str:
    """How the turn after its first minute differs; each: measured, boat file, boat file with C_rY = 1."""
    seen, model, other = (np.array(part) for part in zip(*figures, strict=True))
    off = 100.0 * (model / seen - 1.0)
    shares = 100.0 * model[:, 1] / seen[:, 1]
    closed = 100.0 * (other[:, 1] - model[:, 1]) / (seen[:, 1] - model[:, 1])
    speed, yaw_rate = span(off[:, 0].tolist()), span(off[:, 2].tolist())
    return (
        f"In the steady turn its drift angle is {shares.min():.0f} to {shares.max():.0f} % of the measured "
        f"one, its speed off by {speed}, its yaw rate by {yaw_rate}. With C_rY = 1 in place of the published "
        f"value {closed.min():.0f} to {closed.max():.0f} % of the gap in the drift angle close (median "
        f"{np.median(closed):.0f} %)."
    )


def calm_run_words(every: Sequence[Named]) -> str:
    """Which run's wind is named worst, and how much the wind lowers its misfit."""
    off = [abs(apart(wind_of(one.fits["wind",])[1], anemometer(one.run)[1])) for one in every]
    worst = every[int(np.argmax(off))]
    calmest = min(every, key=lambda one: anemometer(one.run)[0])
    place = "the calmest" if worst is calmest else "not the calmest"
    without, with_it = (misfit(worst, names) for names in ((), ("wind",)))
    return (
        f"The run that is farthest off, {worst.run.name} by {max(off):.0f} degrees, is {place}; there the "
        f"wind changes the held-out misfit from {without:.2f} to {with_it:.2f}."
    )


def misfit(one: Named, names: tuple[str, ...]) -> float:
    """Of held-out minutes, a sample, with what was added."""
    return float(heldout_loss(one.problem, one.fits[names]).sum()) / one.problem.samples


def cause_words(every: Sequence[Named]) -> str:
    """What lowers the misfit most, and how fast the current beside the wind runs."""
    means = {names: float(np.mean([misfit(one, names) for one in every])) for names in CANDIDATES}
    best = min(means, key=lambda names: means[names])
    shares, lee = [], []
    for one in every:
        current = one.fits["current", "wind"].x[:2]
        speed, angle = anemometer(one.run)
        shares.append(100.0 * float(np.hypot(*current)) / speed)
        lee.append(abs(apart(float(np.arctan2(current[1], current[0])), angle + math.pi)))
    return (
        f"Least is left by {' and '.join(best).replace('_', ' ') or 'nothing'} ({means[best]:.2f} on "
        f"average, {means[()]:.2f} with nothing). The pond has no stream; a current down the wind is what a "
        "wind makes of a pond's surface. Named together with the wind, the current runs within "
        f"{max(lee):.0f} degrees of the lee at {min(shares):.1f} to {max(shares):.1f} % of the wind's speed:"
    )


def refused(folder: Path, boat: Boat) -> str:
    """The runs of a folder that the importer refuses, in its words."""
    told = []
    for path in sorted(folder.glob("*.csv")):
        try:
            import_free_running(path, boat)
        except UserError as error:
            told.append(f"`{path.name}`: {str(error).removeprefix(str(path)).lstrip(': ')}")
    return "; ".join(told) if told else "none"
