"""The pictures of trials, where an axis is chosen by what there is to draw."""

import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from swamp_rl.experiments.reports.captive_figures import draw_towed
from swamp_rl.experiments.reports.trial_figures import zig_zag_tracks

from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.captive import Point


def zig_zag(width: float) -> Result:
    """A zig-zag over 8 m, so wide [m]."""
    north = np.linspace(0.0, 8.0, 50)
    place = np.column_stack([north, 0.5 * width * np.sin(north)])
    setting = {"angle": math.radians(20.0), "throttle": 0.6}
    return Result("r", "zig-zag", setting, traces={"place": place, "course": np.array(0.0)})


@pytest.mark.parametrize(("width", "aspect"), [(0.05, "auto"), (2.0, 1.0)])
def test_tracks_too_flat_to_see_are_drawn_wider_than_they_are(width: float, aspect: object) -> None:
    canvas = Figure()
    zig_zag_tracks(canvas, [zig_zag(width)], 1.0)
    assert canvas.axes[0].get_aspect() == aspect
    assert ("enlarged" in canvas.axes[0].get_ylabel()) == (aspect == "auto")


@pytest.mark.parametrize(
    ("throttles", "speeds", "along"), [((0.7,), (1.0, 2.0), "speed"), ((0.5, 0.7), (1.0, 2.0), "throttle")]
)
def test_towing_at_one_throttle_is_drawn_over_the_speed(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    throttles: tuple[float, ...],
    speeds: tuple[float, ...],
    along: str,
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr("swamp_rl.figure_style.save", lambda figure, path: drawn.append(figure))
    points = [Point(("main",), p, u, 66.0 * u * u, 9.0, 341.0, 0.0, 0.0) for p in throttles for u in speeds]
    draw_towed(tmp_path / "towed.png", "barge", points)
    (figure,) = drawn
    assert figure.axes[0].get_xlabel().startswith(along)
    assert all(len(line.get_xdata()) > 1 for line in figure.axes[0].get_lines())
