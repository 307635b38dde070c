"""Ctrl-C and SIGTERM, once and again: what the first begins to clear away, the second does not interrupt."""

import signal

import pytest
from swamp_rl.experiments.cli import signals
from swamp_rl.experiments.cli.signals import stoppable


@pytest.mark.parametrize("second", signals.SIGNALS)
def test_a_second_signal_does_not_interrupt_what_the_first_one_ends(second: int) -> None:
    switched_off = False
    with stoppable() as came, pytest.raises(KeyboardInterrupt):
        try:
            signal.raise_signal(signal.SIGINT)
        finally:
            signal.raise_signal(second)
            switched_off = True
    assert switched_off
    assert came == [signal.SIGINT, second]


def test_a_signal_after_the_grace_interrupts_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(signals, "GRACE", 0.0)
    with stoppable() as came:
        for _ in range(2):
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
    assert came == [signal.SIGINT] * 2
