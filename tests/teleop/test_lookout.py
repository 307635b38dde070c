"""The watch beside a run: it names what fails, knows the sensors of the run before, and holds nothing up."""

import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.link import Sample
from swamp_rl.monitor import Monitor
from swamp_rl.teleop.lookout import LEARNS, WAITING, WATCHES, Lookout
from swamp_rl.teleop.messages import Choose
from swamp_rl.teleop.view import status
from tests.support.driving import drive, session
from tests.support.live_stream import BOAT, NOISE, stream
from tests.support.patience import PATIENCE, until

BEGINS = 40.0
FAULT = {"effect": "heading_bias", "bias": 0.2}


@pytest.fixture
def lookout() -> Iterator[Lookout]:
    found = Lookout(NOISE)
    yield found
    found.close()


def feed(lookout: Lookout, samples: Iterator[Sample]) -> None:
    """Give it a run no faster than it watches: a person's run comes in real time."""
    lookout.begin(BOAT)
    for sample in samples:
        until(lambda: lookout.waiting < WAITING / 2, "the watch keeps up")
        lookout.see(sample)


def test_what_fails_in_a_run_is_named_and_the_next_run_is_watched_at_once() -> None:
    lookout = Lookout()
    feed(lookout, stream(BEGINS + 5.0, BEGINS, [FAULT]))
    feed(lookout, stream(14.0, 8.0, [FAULT], seed=1))
    lookout.close()
    result = lookout.messages()
    assert result[:2] == [LEARNS, WATCHES] and "heading_bias" in result[2]
    assert result[3:5] == [LEARNS, WATCHES] and "heading_bias" in result[5]
    assert len(result) == 6


def test_the_boat_sails_on_though_its_watch_hangs(lookout: Lookout, monkeypatch: pytest.MonkeyPatch) -> None:
    hangs, go_on = threading.Event(), threading.Event()

    def feed(self: Monitor, sample: Sample) -> list[object]:
        hangs.set()
        assert go_on.wait(PATIENCE)
        return []

    monkeypatch.setattr(Monitor, "feed", feed)
    sample = Sample(0.0, np.zeros(8), np.zeros(6))
    lookout.begin(BOAT)
    lookout.see(sample)
    assert hangs.wait(PATIENCE)
    for number in range(2 * WAITING):  # would never end if it waited
        lookout.see(replace(sample, time=0.1 * number))
    lookout.begin(BOAT)
    go_on.set()


def test_a_watch_that_breaks_says_so_and_begins_anew_with_the_next_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lookout = Lookout()
    with monkeypatch.context() as patched:
        patched.setattr(Monitor, "feed", lambda self, sample: 1 / 0)
        feed(lookout, stream(0.3))
        until(lambda: not lookout.waiting, "the watch has had all samples")
    feed(lookout, stream(31.0))
    lookout.close()
    result = lookout.messages()
    assert result[0] == LEARNS and result[1].startswith("stopped: ") and result[2:] == [LEARNS, WATCHES]


def test_the_page_reports_what_fails_in_a_run_and_nothing_where_nothing_does(
    tmp_path: Path, lookout: Lookout
) -> None:
    level = tmp_path / "failing.yaml"
    failure = "{effect: thruster_failure, thruster: bp, time: 8.0}"
    level.write_text(f"description: a bow jet fails\neffects:\n  - {failure}\n", encoding="utf-8")
    game = session(tmp_path / "runs", str(level), seed=3, lookout=lookout)

    def watched() -> list[str]:
        drive(game)
        until(lambda: not lookout.waiting, "the watch has had all samples")
        lookout.begin(BOAT)  # what it is busy with is over when it says so
        until(lambda: game.listen() or status(game)["watch"][-1] == LEARNS, "the watch is idle")
        return list(status(game)["watch"])

    game.choose(Choose(type="choose", level="calm"))
    assert watched()[:2] == [LEARNS, WATCHES]
    game.drop(again=False)
    assert status(game)["watch"] == []
    game.choose(Choose(type="choose", level=str(level)))
    assert any("thruster_failure bp" in line for line in watched())
