"""How runs are cut in windows."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.criticism.data.windows import cut
from swamp_rl.simulator.substeps import steps_over
from tests.support.criticism import simulated_runs


@pytest.mark.parametrize("step", [0.1, 0.09999999999990905, 0.10000000000000142])
def test_the_last_digits_of_a_sample_step_move_no_window(step: float) -> None:
    runs = simulated_runs([])
    weight = np.ones_like(runs.measured)
    exact, rounded = (cut(replace(runs, dt=dt), weight, 5.0) for dt in (0.1, step))
    assert rounded.pad == exact.pad
    assert np.array_equal(rounded.first, exact.first) and np.array_equal(rounded.steps, exact.steps)


def test_a_time_is_covered_by_whole_steps() -> None:
    of_steps = {0.0: 0, 0.04: 1, 0.1: 1, 0.95: 10, 1.0: 10, 1.05: 11}
    assert {seconds: steps_over(seconds, 0.1) for seconds in of_steps} == of_steps
