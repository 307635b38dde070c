"""The signature of a deviation: what another filter that is fed with it has more in its innovations."""

import numpy as np

from swamp_rl.monitor.signature import whitened
from swamp_rl.monitor.tracker import tracker_of
from swamp_rl.simulator import parameters
from tests.support.live_stream import BOAT, stream


def test_a_signature_is_the_difference_of_two_filters() -> None:
    samples = list(stream(33.0))
    calm, _ = tracker_of(BOAT, parameters(BOAT), samples[:301], 0.1)
    moved, _ = tracker_of(BOAT, parameters(BOAT), samples[:301], 0.1)
    for tracker in (calm, moved):
        tracker.history.clear()
    step = np.zeros((1, 30, 6))
    step[:, 5:, 2] = 1e-3  # the compass jumps
    for number, sample in enumerate(samples[301:330]):
        calm.advance(sample)
        shifted = type(sample)(sample.time, sample.commands, sample.senses + step[0, number + 1])
        moved.advance(shifted)
    difference = np.concatenate(
        [
            b.whitener @ b.innovation - a.whitener @ a.innovation
            for a, b in zip(calm.history, moved.history, strict=True)
        ]
    )
    expected = whitened(step, [calm.history[0], *calm.history])[0]
    assert np.abs(expected).max() > 0.05
    np.testing.assert_allclose(difference, expected, atol=0.02 * np.abs(expected).max())
