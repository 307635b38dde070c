"""The figure of prediction errors, of runs in which there are none to measure."""

from types import SimpleNamespace
from typing import Any

from matplotlib.figure import Figure

from swamp_rl.criticism.report.figures import draw_errors
from swamp_rl.criticism.result import Gain


def test_runs_too_short_for_a_prediction_are_told_instead_of_drawn() -> None:
    gains = [Gain(horizon_s=horizon, restarts=0, blocks="runs") for horizon in (1.0, 5.0)]
    misfit: Any = SimpleNamespace(diagnosis=SimpleNamespace(gain=gains, gain_on="same_run"))
    figure = Figure()
    draw_errors(figure, misfit)
    assert figure.axes == [] and "too short" in figure.texts[0].get_text()
