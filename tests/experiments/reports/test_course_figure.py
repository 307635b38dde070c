"""The drawing of a course fits the boat that it is scaled to."""

import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from swamp_rl.experiments.reports.figures import draw_course

from swamp_rl.course import fitted, load_course


@pytest.mark.parametrize("length", [0.4, 1.24, 15.0])
def test_buoys_can_be_seen_and_leave_the_gate_open_whatever_the_boat(length: float) -> None:
    course = fitted(load_course("camogli"), length)
    axes = Figure().subplots()
    draw_course(axes, course)
    widths = {gate.width for gate in course.gates}
    radii = [patch.radius for patch in axes.patches if isinstance(patch, Circle)]
    assert len(radii) == 2 * len(course.gates) and len(widths) == 1
    assert all(0.05 < radius / max(widths) < 0.1 and radius >= course.buoy_radius for radius in radii)
