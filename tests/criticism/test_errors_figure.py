"""The figure of prediction errors, of runs in which there are none to measure."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from swamp_rl.criticism.data.run_set import CHANNELS
from swamp_rl.criticism.report import figures
from swamp_rl.criticism.report.figures import draw_errors
from swamp_rl.criticism.result import Gain


def test_runs_too_short_for_a_prediction_are_reported_instead_of_drawn() -> None:
    gains = [Gain(horizon_s=horizon, restarts=0, blocks="runs") for horizon in (1.0, 5.0)]
    misfit: Any = SimpleNamespace(diagnosis=SimpleNamespace(gain=gains, gain_on="same_run"))
    figure = Figure()
    draw_errors(figure, misfit)
    assert figure.axes == [] and "too short" in figure.texts[0].get_text()


def test_a_horizon_longer_than_the_runs_has_no_error_of_a_perfect_model(
    monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    def errors(run_set: Any, weight: Any, horizon: float, *_: Any) -> Any:
        return SimpleNamespace(error=np.full((3, len(CHANNELS)), 0.1 if horizon < 10.0 else np.nan))

    monkeypatch.setattr(figures, "perfect_run_set", lambda finding, rng: None)
    monkeypatch.setattr(figures, "errors_at", errors)
    finding: Any = SimpleNamespace(
        extended_fit=SimpleNamespace(x=np.zeros(1), hypothesis=None),
        run_set=SimpleNamespace(lengths=np.array([100]), measured=np.zeros((1, 100, len(CHANNELS)))),
        diagnosis=SimpleNamespace(gain=[SimpleNamespace(horizon_s=h) for h in (1.0, 30.0)]),
        weight=None,
    )
    perfect = figures.perfect_errors(finding, np.random.default_rng(0))
    assert {tuple(known) for known in perfect.values()} == {(1.0,)}
    assert perfect["position_rmse_m"][1.0] == pytest.approx(0.1 * np.sqrt(2.0))
    assert not recwarn.list


def test_errors_of_runs_without_noise_have_few_enough_ticks_to_be_read() -> None:
    def gain(horizon: float, after: float) -> Any:
        none = dict.fromkeys(figures.QUANTITIES)
        one = SimpleNamespace(before=1.0, after=after)
        return SimpleNamespace(horizon_s=horizon, **(none | {"position_rmse_m": one}))

    gains = [gain(1.0, 1e-2), gain(5.0, 1e-4), gain(30.0, 1e-7)]
    reported = SimpleNamespace(gain=gains, gain_on="other_runs", noise=dict.fromkeys(CHANNELS, 0.01))
    finding: Any = SimpleNamespace(diagnosis=reported, extended=True)
    figure = Figure()
    draw_errors(figure, finding)
    low, high = figure.axes[0].get_ylim()
    ticks = [tick for tick in figure.axes[0].get_yticks() if low <= tick <= high]
    assert 3 <= len(ticks) <= 9


def test_a_channel_that_only_the_held_out_runs_have_is_drawn_without_a_level_of_noise() -> None:
    none = dict.fromkeys(figures.QUANTITIES)
    both = dict.fromkeys(("position_rmse_m", "surge_rmse_m_s"), SimpleNamespace(before=1.0, after=0.5))
    gains = [SimpleNamespace(horizon_s=horizon, **(none | both)) for horizon in (1.0, 5.0)]
    reported = SimpleNamespace(gain=gains, gain_on="other_runs", noise={"north": 0.1, "east": 0.1})
    finding: Any = SimpleNamespace(diagnosis=reported, extended=False)
    figure = Figure()
    draw_errors(figure, finding)
    assert [len(axes.lines) for axes in figure.axes] == [2, 1]
