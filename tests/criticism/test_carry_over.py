"""Which causes are written: none that makes predictions worse once the measured wind acts."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.cause_share import Witness, in_its_weather, witnesses, written_fit
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates, differing
from swamp_rl.criticism.selection.continuation import Continuation, continuation_of
from tests.support.criticism import DT, SECONDS, driven

SPEED, FROM = 6.0, 0.5  # from ahead of the first run
WIND = {"effect": "wind", "speed": SPEED, "from": FROM}
MIDDLE = 1  # stage of a continuation


def zig_zag(*effects: dict[str, Any]) -> RunSet:
    """Two minutes of a slight zig-zag, with the throttle up and down."""
    time = np.arange(1200) * DT
    given = np.zeros((1, len(time), 8))
    given[0, :, :4] = np.outer(0.1 * np.sign(np.sin(2 * np.pi * time / 9.0)), [1, 1, -1, -1])
    given[0, :, 4:] = (0.7 + 0.2 * np.sign(np.sin(2 * np.pi * time / 40.0)))[:, None]
    return driven(list(effects), given, 0.8, 0)


BLOWN, CALM = zig_zag(WIND), zig_zag()


def ignored(runs: RunSet, angle: float) -> RunSet:
    """The runs with an anemometer's columns, which a fit leaves out."""
    rows = np.full((*runs.measured.shape[:2], 3), np.nan)
    rows[..., 0], rows[..., 1] = SPEED, angle
    return replace(runs, ignored=rows)


def fitted(runs: RunSet, *labels: str) -> tuple[Continuation, Fit]:
    """Effects of those labels fitted to windows of runs, from their first starts."""
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    every = by_label(candidates(runs.boat, SECONDS, runs.groups))
    instances = sorted((every[label] for label in labels), key=lambda one: one.label)
    begin = [x for one in instances for x in (one.starts or one.grid)[0] * one.count]
    return continuation, continuation.fit(MIDDLE, Hypothesis(tuple(instances)), np.array(begin))


def judged(runs: RunSet, *labels: str) -> tuple[list[str], list[str]]:
    """Labels of what is written of a fit, and of what is left out."""
    continuation, winner = fitted(runs, *labels)
    on = Witness(runs, weights(runs, noise_levels(runs)), others=False)
    rng = np.random.default_rng(0)
    written, _, left_out = written_fit(continuation, winner, MIDDLE, witnesses(on, rng), rng)
    return [one.label for one in written.hypothesis.instances], left_out


def test_a_resistance_that_stands_for_the_wind_is_written_only_where_no_wind_was_measured() -> None:
    assert judged(BLOWN, "resistance") == (["resistance"], [])
    assert judged(ignored(BLOWN, FROM), "resistance") == ([], ["resistance"])


def test_a_thrust_that_is_lost_is_written_beside_the_wind_that_was_left_out() -> None:
    runs = ignored(zig_zag(WIND, {"effect": "thrust_scale", "scale": 0.8}), FROM)
    assert judged(runs, "thrust_scale", "wind") == (["thrust_scale", "wind"], [])


def test_what_each_run_has_of_its_own_is_not_judged_on_other_runs() -> None:
    wind = by_label(candidates(BLOWN.boat, SECONDS))["wind"]
    own = differing(wind, "run", (0, 1))
    for others in (False, True):
        on = Witness(BLOWN, weights(BLOWN, noise_levels(BLOWN)), others)
        assert on.judges(wind) and on.judges(own) is not others


@pytest.mark.parametrize("other", [BLOWN, CALM], ids=["the same wind", "another day"])
def test_the_runs_weather_is_that_of_other_runs_only_if_these_are_predicted_better_with_it(
    other: RunSet,
) -> None:
    continuation, winner = fitted(BLOWN, "wind")
    on = Witness(other, weights(other, noise_levels(other)), others=True)
    found = in_its_weather(on, continuation, winner, MIDDLE)
    (wind,) = winner.hypothesis.instances
    assert found.judges(wind) is (other is BLOWN)
    with_wind, boat_file = (
        found.errors(continuation, MIDDLE, fit, 10.0)[0] for fit in (winner, continuation.boat_file(MIDDLE))
    )
    assert (with_wind == boat_file).all() == (other is CALM)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("seconds", "known"), [(15.0, True), (5.0, False)])
def test_short_runs_of_another_day_are_judged_as_far_ahead_as_they_last(seconds: float, known: bool) -> None:
    continuation, winner = fitted(BLOWN, "wind")
    rows = round(seconds / DT)
    short = replace(CALM, measured=CALM.measured[:, :rows], lengths=np.array([rows]))
    short = replace(short, commands=CALM.commands[:, :rows], within=None, instants=None)
    on = Witness(short, weights(CALM, noise_levels(CALM))[:, :rows], others=True)
    assert in_its_weather(on, continuation, winner, MIDDLE).apart is known


def test_the_boats_own_effects_are_judged_on_runs_of_another_day() -> None:
    continuation, winner = fitted(
        zig_zag(WIND, {"effect": "thrust_scale", "scale": 0.8}), "thrust_scale", "wind"
    )
    on = Witness(CALM, weights(CALM, noise_levels(CALM)), others=True)
    found = in_its_weather(on, continuation, winner, MIDDLE)
    assert [one.label for one in winner.hypothesis.instances if found.judges(one)] == ["thrust_scale"]


@pytest.mark.parametrize("angle", [FROM, FROM + np.pi])
def test_an_anemometer_is_heard_only_where_its_wind_predicts_better_than_none(angle: float) -> None:
    runs = ignored(BLOWN, angle)
    on = Witness(runs, weights(runs, noise_levels(runs)), others=False)
    found = witnesses(on, np.random.default_rng(0))
    assert [one.wind for one in found] == (["fitted", "measured"] if angle == FROM else ["fitted"])
