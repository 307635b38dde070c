"""Mean lines of vanes: their angle is the one asked for, and where it is constant they are known curves."""

import math

import numpy as np
import pytest

from swamp_rl.design.velocity_triangles import Triangle, free_vortex_triangle, mean_line, slip_factor


def test_a_free_vortex_has_the_same_circulation_at_every_radius() -> None:
    at = [free_vortex_triangle("tip", radius, 0.04, 100.0, 0.7, 3.0) for radius in (0.03, 0.04, 0.05)]
    assert [one.whirl * one.radius for one in at] == pytest.approx([0.12] * 3)
    assert [one.blade for one in at] == pytest.approx([3.0, 4.0, 5.0])


def test_a_flat_vane_of_constant_angle_is_a_logarithmic_spiral() -> None:
    angle = math.radians(30.0)
    inlet = Triangle("mean", 0.02, 2.0, math.tan(angle), 1.0)
    outlet = Triangle("mean", 0.05, 5.0, math.tan(angle), 4.0)
    line = mean_line(inlet, outlet, (0.0, 0.0), points=2000)
    assert line.wrap == pytest.approx(math.log(0.05 / 0.02) / math.tan(angle), rel=1e-5)


def test_a_cylindrical_vane_of_constant_angle_is_a_helix() -> None:
    angle = math.radians(40.0)
    edge = Triangle("mean", 0.03, 3.0, math.tan(angle), 2.0)
    line = mean_line(edge, edge, (0.0, 0.02))
    assert line.wrap == pytest.approx(0.02 / (0.03 * math.tan(angle)))
    assert np.allclose(np.diff(line.angle), line.wrap / (len(line.angle) - 1))


def test_slip_vanishes_with_ever_more_vanes() -> None:
    outlet = Triangle("mean", 0.04, 5.0, 0.7, 3.3)
    assert 1.0 - slip_factor(outlet, 20_000) < 1e-3
    # Stodola: the vanes' circulation is short by π sin β / z of the vane's speed
    short = (1.0 - slip_factor(outlet, 9)) * outlet.whirl
    assert short == pytest.approx(outlet.blade * math.pi * math.sin(outlet.angle) / 9.0)
