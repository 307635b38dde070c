"""The offset between the clocks of two tables."""

import numpy as np
import pytest

from swamp_rl.logs.clock import clock_offset


def test_messages_that_come_late_change_no_offset() -> None:
    rng = np.random.default_rng(3)
    time = 0.1 * np.arange(400)
    turn = np.convolve(rng.standard_normal(420), np.ones(21) / 21.0, "valid")
    late = np.arange(400)
    late[100:300] = late[100:300].reshape(-1, 20)[:, ::-1].ravel()
    found = clock_offset((time, turn), (time[late] + 0.7, turn[late]), "log")
    assert found.seconds == pytest.approx(-0.7, abs=0.02)
    assert found.correlation > 0.99
