"""Learning curves of several training seeds, drawn with their band."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.evaluation import common_steps, curve_band
from swamp_rl.figure_style import sheet
from swamp_rl.files import write_beside

Curve = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Steps (T,), rising, and success (T,) in [0, 1]."""


def learning_curves(path: Path, curves: Mapping[str, Sequence[Curve]], title: str) -> None:
    """PNG of success against steps: for each name the interquartile mean over its seeds, and its 95 % band.

    Each seed's own curve is drawn thinly behind. UserError where the curves of a name have no range of steps
    in common.
    """
    rng = np.random.default_rng(0)
    with write_beside(path) as part, sheet(part, 6.4, 3.6) as figure:
        axes = figure.subplots()
        for name, logged in curves.items():
            try:
                steps, values = common_steps(logged)
            except ValueError as error:
                raise UserError(f"{name}: {error}; log every seed over the same steps") from error
            centre, low, high = curve_band(100.0 * values, rng)
            label = f"{name}, {len(values)} seed{'s' * (len(values) > 1)}"
            (line,) = axes.plot(steps, centre, lw=1.8, label=label, zorder=3)
            axes.fill_between(steps, low, high, color=line.get_color(), alpha=0.22, lw=0, zorder=2)
            axes.plot(steps, 100.0 * values.T, color=line.get_color(), lw=0.5, alpha=0.35, zorder=1)
        axes.set(xlabel="decisions", ylabel="success [%]", ylim=(-2, 102))
        axes.legend(loc="lower right")
        figure.suptitle(title, fontsize=11, fontweight="bold")
