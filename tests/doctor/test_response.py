"""The doctor on commands: which exchanges, signs and latencies the runs tell apart."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.runs import Run
from tests.support.doctored import STEP, faults, late, sailed, steered
from tests.support.from_scratch import written


def test_a_periodic_steering_of_which_half_a_period_is_a_change_of_sign_is_no_fault(twin: Boat) -> None:
    runs = steered(twin, np.sin, 10.0)
    assert faults(runs, twin) == []
    assert faults(runs, None) == []


@pytest.mark.parametrize("seconds", [1.5, -1.0])
def test_the_latency_of_a_periodic_steering_with_steps_is_reported(seconds: float, twin: Boat) -> None:
    runs = steered(twin, lambda phase: np.sign(np.sin(phase)), 10.0)
    (finding,) = faults([Run(run.name, late(seconds)(dict(run.columns))) for run in runs], twin)
    assert finding.code == "latency"
    assert finding.figures["latency_s"] == pytest.approx(seconds, abs=0.35)


def test_a_thrust_that_is_linear_in_the_level_is_no_latency(twin: Boat, tmp_path: Path) -> None:
    written(tmp_path, "twin")
    linear = {"thrust_linear": 8.0, "thrust_quadratic": 0.0, "astern_linear": 5.0, "astern_quadratic": 0.0}
    curves = "".join(f"  {name}: {linear}\n" for name in twin.thruster_names)
    (tmp_path / "linear.yaml").write_text(f"extends: twin.yaml\nthrusters:\n{curves}")
    phase = np.pi * np.arange(601) * STEP / 20.0
    level, apart = 0.6 * np.abs(np.sin(phase)), 0.15 * np.sin(2.0 * phase)
    throttles = [[level + apart, level - apart], [level - apart, level + apart]]
    runs = sailed(load_boat(tmp_path / "linear.yaml"), throttles, np.random.default_rng(4))
    assert faults(runs, twin) == []
