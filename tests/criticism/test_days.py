"""What differs between the days of runs is told from what all days share."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import candidates, hull_nuisance
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.continuation import continuation_of
from tests.support.criticism import SECONDS, simulated_runs

Effects = list[dict[str, Any]]


def sailed(monday: Effects, tuesday: Effects) -> RunSet:
    """Three runs, the second of another day."""
    one, other = (simulated_runs(effects) for effects in (monday, tuesday))
    on_tuesday = np.array([False, True, False])[:, None, None]
    return replace(
        one, measured=np.where(on_tuesday, other.measured, one.measured), days=("mon", "tue", "mon")
    )


@pytest.mark.parametrize(
    ("monday", "tuesday", "named"),
    [
        ([{"effect": "mass", "mass": 50.0}], [{"effect": "mass", "mass": 50.0}], ["mass"]),
        ([], [{"effect": "thrust_scale", "scale": 0.9}], ["thrust_scale by_day"]),
        (
            [{"effect": "heading_bias", "bias": 0.06}],
            [{"effect": "heading_bias", "bias": -0.05}],
            ["heading_bias by_day"],
        ),
    ],
    ids=["the same payload", "other batteries", "a compass calibrated anew"],
)
def test_what_differs_between_days_is_named_so(monday: Effects, tuesday: Effects, named: list[str]) -> None:
    runs = sailed(monday, tuesday)
    every = candidates(runs.boat, SECONDS, runs.groups)
    at = continuation_of(runs, weights(runs, noise_levels(runs)))
    found = beam_search(at, every, hull_nuisance(runs.boat))
    assert [one.label for one in found.winner.hypothesis.instances] == named and not found.rivals
