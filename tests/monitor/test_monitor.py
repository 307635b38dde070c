"""What begins under way is named within seconds, and nothing where nothing begins."""

from collections.abc import Iterable
from copy import deepcopy
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from swamp_rl.link import Sample
from swamp_rl.monitor import Monitor, Notice
from swamp_rl.monitor.options import DEFAULT, Options
from tests.support.live_stream import BOAT, stream

BEGINS = 45.0
BAR = 3.0  # s


def notices(samples: Iterable[Sample], options: Options = DEFAULT) -> list[Notice]:
    """What a new monitor says."""
    return heard(Monitor(BOAT, options), samples)


def notices_later(samples: Iterable[Sample]) -> list[Notice]:
    """What a monitor says that has had `stream()` until BEGINS, as the samples are; it ignores those."""
    return heard(deepcopy(settled()), samples)


@cache
def settled() -> Monitor:
    """A monitor at BEGINS: its first seconds take longer than all that comes then."""
    monitor = Monitor(BOAT)
    assert heard(monitor, stream(BEGINS)) == []
    return monitor


def heard(monitor: Monitor, samples: Iterable[Sample]) -> list[Notice]:
    return [notice for sample in samples for notice in monitor.feed(sample)]


def test_nothing_is_said_of_a_clean_minute_and_a_half() -> None:
    assert notices(stream(90.0)) == []


@pytest.mark.parametrize(
    ("effect", "cause"),
    [
        ({"effect": "thruster_failure", "thruster": "bp", "time": 0.0}, "thruster_failure bp"),
        ({"effect": "current", "north": 0.3, "east": -0.2}, "current"),
        ({"effect": "external_force", "north": 0.0, "east": 10.0}, "external_force"),
        ({"effect": "heading_bias", "bias": -0.2}, "heading_bias"),
    ],
)
def test_what_begins_is_named_within_three_seconds(effect: dict[str, Any], cause: str) -> None:
    first = notices_later(stream(BEGINS + 5.0, BEGINS, [effect]))[0]
    assert first.cause == cause
    assert BEGINS <= first.time <= BEGINS + BAR
    assert abs(first.since - BEGINS) < 0.6


def test_a_force_as_small_as_a_gusts_is_not_reported() -> None:
    effect = {"effect": "external_force", "north": 0.0, "east": 1.5}
    credulous = replace(DEFAULT, sea=0.0)
    samples = list(stream(BEGINS + 10.0, BEGINS, [effect]))
    assert [notice.cause for notice in notices(samples, credulous)] == ["external_force"]
    assert notices_later(samples) == []


def test_its_size_is_that_of_the_current_that_rose() -> None:
    effect = {"effect": "current", "north": 0.3, "east": -0.2}
    first = notices_later(stream(BEGINS + 5.0, BEGINS, [effect]))[0]
    assert first.values["north"] == pytest.approx(0.3, abs=0.1)
    assert first.values["east"] == pytest.approx(-0.2, abs=0.1)


@pytest.mark.parametrize(
    ("channels", "sensor"),
    [((0, 1), "position"), ((2,), "heading"), ((3, 4), "velocity"), ((5,), "yaw_rate")],
)
def test_a_sensor_that_repeats_its_reading_is_frozen(channels: tuple[int, ...], sensor: str) -> None:
    notices = notices_later(stream(BEGINS + 10.0, BEGINS, frozen=channels))
    assert [notice.cause for notice in notices] == [f"{sensor} frozen"]
    assert notices[0].time <= BEGINS + BAR
    assert notices[0].since == pytest.approx(BEGINS, abs=0.11)


def test_a_sensor_that_comes_back_is_reported() -> None:
    ill = list(stream(BEGINS + 5.0, BEGINS, frozen=(2,)))
    well = list(stream(BEGINS + 10.0))[len(ill) :]
    assert [notice.cause for notice in notices_later([*ill, *well])] == ["heading frozen", "heading back"]


def test_a_receiver_of_one_fix_a_second_is_not_frozen() -> None:
    held: list[Sample] = []
    for number, sample in enumerate(stream(90.0)):
        senses = sample.senses.copy()
        if number % 10:
            senses[:2] = held[-1].senses[:2]
        held.append(replace(sample, senses=senses))
    assert notices(held) == []


def test_a_single_wild_fix_is_no_fault() -> None:
    samples = list(stream(60.0))
    samples[450].senses[:2] += 40.0
    assert notices_later(samples) == []


def test_samples_that_come_twice_or_late_change_nothing() -> None:
    effect = {"effect": "thruster_failure", "thruster": "ss", "time": 0.0}
    plain = list(stream(BEGINS + 5.0, BEGINS, [effect]))
    shuffled = [one for number, sample in enumerate(plain) for one in (sample, plain[max(0, number - 3)])]
    assert notices(shuffled) == notices_later(plain)


def test_channels_that_are_not_measured_are_done_without() -> None:
    effect = {"effect": "thruster_failure", "thruster": "bp", "time": 0.0}
    samples = [
        replace(sample, senses=np.where([1, 1, 1, 0, 0, 1], sample.senses, np.nan))
        for sample in stream(BEGINS + 8.0, BEGINS, [effect])
    ]
    first = notices(samples)[0]
    assert "bp" in " ".join((first.cause, *first.rivals))


def test_a_fault_that_is_named_once_is_not_named_again() -> None:
    effect = {"effect": "thruster_failure", "thruster": "bp", "time": 0.0}
    assert len(notices_later(stream(BEGINS + 40.0, BEGINS, [effect]))) == 1
