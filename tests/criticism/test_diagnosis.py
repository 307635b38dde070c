"""Model criticism on small trials with a known truth; the truth is only ever in the data."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.candidates import Hypothesis, by_label, candidates, hull_nuisance, wave_values
from swamp_rl.criticism.conclude import plainest
from swamp_rl.criticism.data import CHANNELS, Gap, trials_of
from swamp_rl.criticism.extend import write_extended
from swamp_rl.criticism.fit import fit
from swamp_rl.criticism.gaps import resolved, without_harmless
from swamp_rl.criticism.harmonic import wave_starts
from swamp_rl.criticism.heldout import heldout_loss
from swamp_rl.criticism.ladder import ladder_of
from swamp_rl.criticism.leftover import missing_forces
from swamp_rl.criticism.manoeuvres import manoeuvres
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.criticism.rivals import separating_trial
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.effects import LIBRARY
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from tests.support.criticism import DT, SECONDS, SIGMA, driven, searched, trials

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def test_the_noise_is_told_from_the_data_alone() -> None:
    assert noise_levels(trials([])) == pytest.approx(SIGMA, rel=0.1)


def test_an_outlier_and_a_repeated_sample_have_no_weight() -> None:
    found = trials([])
    found.measured[0, 100, 0] += 3.0
    found.measured[1, 50, 2] = found.measured[1, 49, 2]
    weight = weights(found, noise_levels(found))
    assert weight[0, 100, 0] == 0.0
    assert weight[1, 50, 2] == 0.0
    assert (weight > 0).mean() > 0.99


def test_a_gain_is_recovered_within_its_standard_error() -> None:
    found = trials([{"effect": "thruster_gain", "thruster": "bs", "gain": 0.8}])
    problem = Shooting(found, weights(found, noise_levels(found)), 10.0)
    atom = by_label(candidates(found.boat, SECONDS))["thruster_gain bs"]
    made = fit(problem, Hypothesis((atom,)), np.array([1.0]), problem.guess())
    error = float(np.sqrt(made.covariance[0, 0]))
    assert error < 0.01
    assert abs(made.x[0] - 0.8) < 4.0 * error
    assert made.chi2 / problem.samples == pytest.approx(1.0, abs=0.1)
    assert heldout_loss(problem, made).sum() >= made.loss.sum()


def test_nothing_is_found_wrong_with_clean_data() -> None:
    found = searched(trials([], seed=3))
    assert found.adequate
    assert found.winner.hypothesis.label == "nothing"


def test_wind_is_named_and_not_a_current_or_a_push() -> None:
    found = searched(trials([{"effect": "wind", "speed": 4.0, "from": 1.0}], seed=4))
    assert found.adequate
    assert found.winner.hypothesis.label == "wind"
    assert np.hypot(*found.winner.x) == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize(("rate", "name"), [(0.0, "current"), (0.002, "drifting_current")])
def test_a_current_is_said_to_drift_where_runs_held_out_confirm_it(rate: float, name: str) -> None:
    effect = {"effect": "drifting_current", "north": 0.1, "east": 0.05, "north_rate": rate, "east_rate": 0.0}
    found = trials([effect], seed=6)
    ladder = ladder_of(found, weights(found, noise_levels(found)))
    every = candidates(found.boat, SECONDS)
    drifting = Hypothesis((by_label(every)["drifting_current"],))
    best = ladder.fit(1, drifting, np.array([0.1, 0.05, 0.0, 0.0]))
    assert plainest(ladder, best, every, 1).hypothesis.label == name


def test_straight_runs_cannot_tell_drag_from_thrust_and_the_trial_that_is_proposed_can() -> None:
    truth = [{"effect": "linear_drag", "coefficient": 6.0}]
    possible = ("linear_drag", "thrust_scale", "thruster_gain", "current")
    straight = np.zeros((3, round(SECONDS / DT), 8))
    straight[..., 4:] = 0.7
    steady = driven(truth, straight, 0.8, seed=9)
    found = searched(steady, *possible)
    names = {found.winner.hypothesis.label, *(one.hypothesis.label for one in found.rivals)}
    assert {"linear_drag", "thrust_scale"} <= names
    trial = separating_trial(steady, noise_levels(steady), found.winner, found.rivals)
    assert trial.separation > 10.0
    proposed = manoeuvres(steady.boat, DT)[trial.manoeuvre][None, : straight.shape[1]]
    sailed = driven(truth, proposed, 0.0, seed=10)
    both = replace(
        steady,
        names=("a", "b", "c", "trial"),
        commands=np.concatenate([steady.commands, sailed.commands]),
        measured=np.concatenate([steady.measured, sailed.measured]),
        lengths=np.concatenate([steady.lengths, sailed.lengths]),
    )
    settled = searched(both, *possible)
    assert settled.winner.hypothesis.label == "linear_drag"
    assert not settled.rivals


def test_two_swapped_channels_are_named() -> None:
    truth = trials([{"effect": "channel_swap", "thruster": ["bs", "sp"]}], seed=5)
    found = searched(truth, "channel_swap", "thruster_gain", "azimuth_offset")
    assert found.winner.hypothesis.label == "channel_swap bs sp"


def test_a_missing_push_shows_in_its_direction_and_size() -> None:
    found = trials([{"effect": "external_force", "north": 1.5, "east": -0.8}], seed=6)
    forces = missing_forces(found, weights(found, noise_levels(found)), Hypothesis(), np.zeros(0))
    north, east = np.median(forces.force[:, 3:5], axis=0)
    assert np.arctan2(east, north) == pytest.approx(np.arctan2(-0.8, 1.5), abs=0.2)
    assert np.hypot(north, east) == pytest.approx(np.hypot(1.5, 0.8), rel=0.1)


def test_a_command_that_changed_in_a_lost_row_is_read_as_the_boat_obeyed_it() -> None:
    truth = trials([], seed=7)
    change = int(np.flatnonzero(np.diff(truth.commands[0, :, 0]))[2]) + 1
    for lost in (change - 1, change):
        commands = truth.commands.copy()
        commands[0, lost] = 0.5 * (commands[0, lost - 1] + commands[0, lost + 1])
        gap = Gap(0, lost, 1)
        found = replace(truth, commands=commands, gaps=(gap,))
        weight = weights(found, noise_levels(found))
        assert without_harmless(found, weight).gaps == (gap,)
        read = resolved(found, weight, (gap,), Hypothesis(), np.zeros(0))
        assert read.commands == pytest.approx(truth.commands)


def test_waves_are_found_by_a_scan_of_frequencies() -> None:
    found = trials([{"effect": "waves", "force": 2.0, "frequency": 0.23, "from": 1.0}], seed=8)
    problem = Shooting(found, weights(found, noise_levels(found)), 5.0)
    at = fit(problem, Hypothesis(), np.zeros(0), problem.guess())
    start = wave_starts(problem, at, np.zeros((*at.residual.shape, 0)))[0]
    assert start[0] == pytest.approx(0.23, abs=0.01)
    values = wave_values(start)
    assert values["force"] == pytest.approx(2.0, rel=0.15)
    assert values["from"] == pytest.approx(1.0, abs=0.2)


def test_every_effect_that_is_not_chance_or_somebody_elses_doing_is_a_candidate() -> None:
    found = {atom.effect.name for atom in candidates(load_boat("swamp"), SECONDS)}
    nuisance = hull_nuisance()
    assert nuisance is not None
    assert found | {nuisance.effect.name} == set(LIBRARY) - {"gusts", "thruster_kick"}


def test_the_extended_boat_can_be_loaded_and_holds_the_effect(tmp_path: Any) -> None:
    boat = load_boat("swamp")
    atom = by_label(candidates(boat, 60.0))["channel_swap bs sp"]
    lag = by_label(candidates(boat, 60.0))["azimuth_lag"]
    write_extended(tmp_path / "boat.yaml", "swamp", Hypothesis((lag, atom)), np.array([0.4]))
    effects = load_boat(tmp_path / "boat.yaml").effects
    assert [entry.effect.name for entry in effects] == ["azimuth_lag", "channel_swap"]
    assert effects[0].values == {"time_constant": 0.4}
    assert effects[1].thruster == ("bs", "sp")


def test_too_little_data_is_refused_with_what_is_missing() -> None:
    time = np.arange(50) * DT
    boat = load_boat("swamp")
    columns: dict[str, Any] = {name: np.zeros(50) for name in ("north", "east", "heading")}
    for name in boat.thruster_names:
        columns |= {f"azimuth_{name}": np.zeros(50), f"throttle_{name}": np.zeros(50)}
    with pytest.raises(UserError, match="needs 20 s or more"):
        trials_of([Run("short", columns | {"time": time})], boat, "folder")
    long: dict[str, Any] = {name: np.zeros(400) for name in columns}
    long["time"] = np.arange(400) * DT
    with pytest.raises(UserError, match="no thruster ever runs"):
        trials_of([Run("still", long)], boat, "folder")


def test_the_schema_names_the_four_verdicts() -> None:
    schema = json.dumps(Diagnosis.model_json_schema())
    for verdict in ("nothing_wrong", "cause", "indistinguishable", "unexplained"):
        assert verdict in schema
    assert len(CHANNELS) == 6
