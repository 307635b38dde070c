"""Exchanges of an effect for a neighbour, and of a local minimum for another, beside all other effects."""

from typing import Any

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.output_error import at_states
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, by_label, candidates, joined
from swamp_rl.criticism.selection.continuation import MIDDLE, Continuation, continuation_of
from swamp_rl.criticism.selection.exchange_search import exchange_search, single_exchanges
from tests.support.criticism import SECONDS, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

CURVE = {
    "effect": "thruster_efficiency_curve",
    "thruster": "bp",
    "at_30": 0.6,
    "at_60": 0.7,
    "at_100": 1.2,
}
DELAY = {"effect": "command_delay", "delay": 0.48}
CURRENT = {"effect": "current", "north": 0.08, "east": -0.05}


def begun(
    effects: list[dict[str, Any]], *names: str, velocities: bool = True
) -> tuple[Continuation, list[EffectInstance]]:
    """A continuation of runs with those effects, and the candidates of those names."""
    runs = simulated_runs(effects, velocities=velocities)
    every = [one for one in candidates(runs.boat, SECONDS) if one.label in names]
    return continuation_of(runs, weights(runs, noise_levels(runs))), every


def test_a_neighbour_of_the_true_effect_gives_way_to_it() -> None:
    labels = "current", "thruster_gain bp", "thruster_efficiency_curve bp", "resistance"
    continuation, every = begun([CURVE, CURRENT], *labels)
    known = by_label(every)
    caught = Hypothesis((known["current"], known["thruster_gain bp"]))
    at = continuation.fit(0, caught, np.array([0.08, -0.05, 0.8]))
    assert not continuation.is_adequate(0, at)
    found = exchange_search(continuation, at, every)[-1]
    assert "thruster_efficiency_curve bp" in found.hypothesis.label
    assert continuation.is_adequate(MIDDLE, found)


def test_effects_that_are_no_candidates_of_short_windows_give_way_too() -> None:
    continuation, every = begun(
        [CURVE, CURRENT], "current", "thruster_gain bp", "thruster_efficiency_curve bp"
    )
    known = by_label(every)
    caught = Hypothesis((known["current"], known["thruster_gain bp"]))
    at = continuation.fit(0, caught, np.array([0.08, -0.05, 0.8]))
    found = single_exchanges(continuation, at, [known["thruster_efficiency_curve bp"]])
    labels = [one.hypothesis.label for one in found]
    assert "current + thruster_efficiency_curve bp" in labels


def test_a_delay_caught_at_another_sample_begins_again_beside_the_other_effects() -> None:
    continuation, every = begun([DELAY, CURRENT], "command_delay", "current")
    known, problem = by_label(every), continuation.problems[0]
    both = joined([(known["current"], np.array([0.08, -0.05])), (known["command_delay"], np.array([0.39]))])
    at = at_states(problem, *both, problem.initial_states(), 4)
    found = exchange_search(continuation, at, every)[-1]
    assert found.x[found.hypothesis.columns("command_delay")] == pytest.approx([0.48], abs=0.01)
    assert continuation.is_adequate(MIDDLE, found)


def test_the_rivals_of_the_first_set_that_leaves_noise_are_fitted_too() -> None:
    """Without measured velocities a late position and a late clock are the same."""
    late = {"effect": "position_delay", "delay": 0.3}
    labels = "current", "position_delay", "clock_offset"
    continuation, every = begun([late, CURRENT], *labels, velocities=False)
    at = continuation.fit(0, Hypothesis((by_label(every)["current"],)), np.array([0.08, -0.05]))
    found = {one.hypothesis.label for one in exchange_search(continuation, at, every)}
    assert {"current + position_delay", "clock_offset + current"} <= found


def test_nothing_is_exchanged_for_what_explains_no_more() -> None:
    labels = "current", "thruster_gain bp", "resistance"
    continuation, every = begun([CURRENT], *labels)
    known = by_label(every)
    at = continuation.fit(0, Hypothesis((known["current"],)), np.array([0.0, 0.0]))
    assert exchange_search(continuation, at, every) == []
