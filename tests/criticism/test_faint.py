"""Causes that are too small for short windows, and those whose first try runs away."""

from dataclasses import replace

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.candidates import Atom, Hypothesis, by_label, candidates, hull_nuisance
from swamp_rl.criticism.conclude import climb
from swamp_rl.criticism.cost import needed
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.faint import is_small
from swamp_rl.criticism.heldout import confirmation_by_stretches, stretch_losses
from swamp_rl.criticism.ladder import UNBROKEN, Ladder, ladder_of
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.score import beside_nothing, prospects
from swamp_rl.simulator import parameters
from tests.support.criticism import SECONDS, searched, trials

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

UNSTABLE = "swamp-thesis"  # whose unbroken runs show what short windows do not
BOAT = load_boat(UNSTABLE)
ATOMS = [*candidates(BOAT, SECONDS), *filter(None, [hull_nuisance()])]
SMALL = [
    {"effect": "current", "north": 0.0015, "east": -0.001},
    {"effect": "mass", "mass": 58.12},
    {"effect": "thrust_scale", "scale": 0.9972},
]


def climbed(found: Trials) -> Ladder:
    return ladder_of(found, weights(found, noise_levels(found)))


@pytest.mark.parametrize(
    "atom", [one for one in ATOMS if is_small(one) and one.effect.name != "waves"], ids=lambda one: one.label
)
def test_what_changes_nothing_leaves_the_boat_as_its_file_has_it(atom: Atom) -> None:
    plain = parameters(BOAT)[0]
    softly = Hypothesis((beside_nothing(atom, BOAT),))
    record = softly.records(BOAT, np.array(softly.atoms[0].starts))[0]
    moved = {name for name in plain.dtype.names if not np.allclose(record[name], plain[name], atol=0.005)}
    assert moved <= {"wind_from"}


@pytest.mark.parametrize("effect", SMALL, ids=lambda one: one["effect"])
def test_a_cause_that_windows_of_twenty_seconds_do_not_show_is_found(effect: dict[str, object]) -> None:
    made = trials([effect], seed=21, name=UNSTABLE)
    ladder, atom = climbed(made), by_label(ATOMS)[str(effect["effect"])]
    nothing = climb(ladder, Hypothesis(), np.zeros(0))
    at = climb(ladder, Hypothesis((atom,)), np.array(atom.starts[0]))
    assert nothing.chi2 - at.chi2 < needed(atom)
    found = searched(made)
    assert found.adequate
    assert atom.label in [one.hypothesis.accused for one in (found.winner, *found.rivals)]


def test_a_run_is_judged_by_its_stretches_of_twenty_seconds() -> None:
    ladder = climbed(trials([], seed=21, name=UNSTABLE))
    problem, nothing = ladder.problems[UNBROKEN], ladder.fit(UNBROKEN, Hypothesis(), np.zeros(0))
    lost = stretch_losses(problem, nothing).reshape(problem.windows.count, -1)
    squares = nothing.residual.reshape(problem.windows.count, -1, 6) ** 2
    for run in range(problem.windows.count):
        for stretch, first in enumerate(range(0, squares.shape[1], 200)):
            rows = slice(first, first + 200)
            seen = (problem.windows.weight[run, rows] > 0).sum()
            assert lost[run, stretch] == pytest.approx(seen * np.log(1 + squares[run, rows].sum() / seen))


def test_numbers_of_other_runs_explain_a_run_less_well_than_its_own() -> None:
    ladder = climbed(trials([{"effect": "current", "north": 0.004, "east": -0.003}], seed=21, name=UNSTABLE))
    atom = by_label(ATOMS)["current"]
    made = ladder.fit(UNBROKEN, Hypothesis((atom,)), np.zeros(2))
    problem, own = ladder.problems[UNBROKEN], made.loss.sum()
    lost, seen = stretch_losses(problem, made), (problem.windows.weight > 0).sum()
    assert own < seen * np.expm1(np.nansum(lost) / seen) < 1.01 * own + 20.0


@pytest.mark.parametrize(("size", "is_there"), [(0.004, True), (0.0, False)])
def test_a_current_is_confirmed_where_there_is_one_and_only_there(size: float, is_there: bool) -> None:
    ladder = climbed(trials([{"effect": "current", "north": size, "east": -size}], seed=22, name=UNSTABLE))
    atom = by_label(ATOMS)["current"]
    nothing = ladder.fit(UNBROKEN, Hypothesis(), np.zeros(0))
    made = ladder.fit(UNBROKEN, Hypothesis((atom,)), np.zeros(2), nothing.states)
    assert confirmation_by_stretches(ladder.problems[UNBROKEN], made, nothing, 120).holds == is_there


def test_a_cause_whose_first_try_runs_away_is_tried_beside_nothing() -> None:
    found = trials([{"effect": "yaw_damping", "scale": 0.5}], velocities=False, name=UNSTABLE)
    ladder = climbed(found)
    nothing = ladder.fit(0, Hypothesis(), np.zeros(0))
    atom = by_label(ATOMS)["yaw_damping"]
    wild = replace(atom, starts=((-3.0,),))
    ahead = prospects(ladder.problems[0], nothing, [wild])[0]
    assert np.isfinite(ahead.promised)
    assert ahead.seen > 1000.0


def test_what_the_data_show_of_a_cause_they_show_wherever_its_fit_begins() -> None:
    ladder = climbed(trials([], name=UNSTABLE))
    problem, nothing = ladder.problems[0], ladder.fit(0, Hypothesis(), np.zeros(0))
    atoms = [one for one in ATOMS if is_small(one) and one.effect.name != "waves"]
    softly = {one.label: beside_nothing(one, BOAT) for one in atoms}
    alone = {one.atom.label: one.seen for one in prospects(problem, nothing, list(softly.values()))}
    ahead = prospects(problem, nothing, atoms)
    assert all(one.seen >= alone[one.atom.label] for one in ahead)
    larger = [one for one in ahead if one.seen > 1.5 * alone[one.atom.label]]
    assert any(np.array_equal(one.x, softly[one.atom.label].starts[0]) for one in larger)
