"""The figure of the residual forces."""

import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from swamp_rl.boat import load_boat
from swamp_rl.criticism.inference.finding import Finding
from swamp_rl.criticism.inference.residual_force import Forces
from swamp_rl.criticism.report import figures


def test_a_residual_force_that_is_zero_is_drawn_without_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    n = 40
    force = np.column_stack([np.linspace(-1.0, 1.0, n), np.zeros((n, 2))])
    names = ("speed", "yaw rate", "heading", "time", "throttle bs", "azimuth bs")
    variables = {name: np.linspace(0.0, 1.0, n) for name in names}
    none = Forces(force, variables)
    monkeypatch.setattr(figures, "residual_forces", lambda *given: none)
    run_set = SimpleNamespace(boat=load_boat("swamp"))
    diagnosis = SimpleNamespace(causes=[], leftover=[])
    finding: Any = SimpleNamespace(run_set=run_set, weight=None, diagnosis=diagnosis, extended=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert figures.draw(tmp_path / "forces.png", finding, figures.draw_forces).stat().st_size > 1000


@pytest.mark.parametrize("is_written", [False, True])
def test_the_forces_after_are_those_of_the_boat_that_was_written(
    is_written: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = list[str]()

    def forces(run_set: Any, weight: Any, hypothesis: Any, x: Any) -> Forces:
        drawn.append(hypothesis.label)
        return Forces(np.ones((4, 3)), {"speed": np.arange(4.0)})

    def fitted(*labels: str) -> Any:
        instances = [SimpleNamespace(label=label) for label in labels]
        label = " + ".join(labels)
        return SimpleNamespace(hypothesis=SimpleNamespace(instances=instances, label=label), x=np.zeros(0))

    monkeypatch.setattr(figures, "residual_forces", forces)
    monkeypatch.setattr(figures, "shown_variables", lambda *given: {"speed": ("speed", 1.0)})
    extension: Any = SimpleNamespace(result=SimpleNamespace(written=is_written), fit=fitted("force_curve"))
    diagnosis: Any = SimpleNamespace(causes=[], leftover=[])
    selection: Any = SimpleNamespace(winner=fitted("wind"))  # which does not carry over
    nothing: Any = None
    finding = Finding(diagnosis, nothing, nothing, nothing, selection, fitted(), extension)
    figures.draw_forces(Figure(), finding)
    assert drawn == ["nothing", *(["force_curve"] if is_written else [])]
