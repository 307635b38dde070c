"""The figure of the residual forces."""

import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.inference.residual_force import Forces
from swamp_rl.criticism.report import figures


def test_a_residual_force_that_is_zero_is_drawn_without_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    n = 40
    force = np.column_stack([np.linspace(-1.0, 1.0, n), np.zeros((n, 4))])
    names = ("speed", "yaw rate", "heading", "time", "throttle bs", "azimuth bs")
    variables = {name: np.linspace(0.0, 1.0, n) for name in names}
    none = Forces(force, np.ones((n, 5)), np.zeros(n, int), variables)
    monkeypatch.setattr(figures, "residual_forces", lambda *given: none)
    run_set = SimpleNamespace(boat=load_boat("swamp"))
    diagnosis = SimpleNamespace(causes=[], leftover=[])
    finding: Any = SimpleNamespace(run_set=run_set, weight=None, diagnosis=diagnosis, extended=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert figures.draw(tmp_path / "forces.png", finding, figures.draw_forces).stat().st_size > 1000
