"""Model criticism of small simulated runs with known causes."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from swamp_rl.angles import turned
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import CHANNELS, Gap, run_set_of
from swamp_rl.criticism.diagnose import labels_without_number
from swamp_rl.criticism.inference.identifiability import separating_manoeuvre
from swamp_rl.criticism.inference.residual_force import residual_forces
from swamp_rl.criticism.likelihood.cross_validation import heldout_loss
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.model.extended_boat import write_extended
from swamp_rl.criticism.model.manoeuvres import manoeuvres
from swamp_rl.criticism.nuisance.lost_rows import with_best_commands, with_relevant_gaps
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.criticism.selection.backward_elimination import with_special_cases
from swamp_rl.criticism.selection.continuation import continuation_of
from swamp_rl.criticism.selection.frequency_scan import wave_starts
from swamp_rl.effects import LIBRARY
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from tests.support.criticism import DT, SECONDS, SIGMA, driven, joined, select_effects, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def test_the_noise_is_estimated_from_the_data_alone() -> None:
    assert noise_levels(simulated_runs([])) == pytest.approx(SIGMA, rel=0.1)


def test_an_outlier_and_a_repeated_sample_have_no_weight() -> None:
    found = simulated_runs([])
    found.measured[0, 100, 0] += 3.0
    found.measured[1, 50, 2] = found.measured[1, 49, 2]
    weight = weights(found, noise_levels(found))
    assert weight[0, 100, 0] == 0.0
    assert weight[1, 50, 2] == 0.0
    assert (weight > 0).mean() > 0.99


def test_a_gain_is_recovered_within_its_standard_error() -> None:
    found = simulated_runs([{"effect": "thruster_gain", "thruster": "bs", "gain": 0.8}])
    problem = Shooting(found, weights(found, noise_levels(found)), 10.0)
    instance = by_label(candidates(found.boat, SECONDS))["thruster_gain bs"]
    made = fit(problem, Hypothesis((instance,)), np.array([1.0]), problem.initial_states())
    error = float(np.sqrt(made.covariance[0, 0]))
    assert error < 0.01
    assert abs(made.x[0] - 0.8) < 4.0 * error
    assert made.chi2 / problem.samples == pytest.approx(1.0, abs=0.1)
    assert heldout_loss(problem, made).sum() >= made.loss.sum()


def test_nothing_is_found_wrong_with_clean_data() -> None:
    found = select_effects(simulated_runs([], seed=3))
    assert found.adequate
    assert found.winner.hypothesis.label == "nothing"


def test_wind_is_named_and_not_a_current_or_a_push() -> None:
    found = select_effects(simulated_runs([{"effect": "wind", "speed": 4.0, "from": 1.0}], seed=4))
    assert found.adequate
    assert found.winner.hypothesis.label == "wind"
    assert np.hypot(*found.winner.x) == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize(("rate", "name"), [(0.0, "current"), (0.002, "drifting_current")])
def test_a_drifting_current_is_named_where_held_out_runs_confirm_it(rate: float, name: str) -> None:
    effect = {"effect": "drifting_current", "north": 0.1, "east": 0.05, "north_rate": rate, "east_rate": 0.0}
    found = simulated_runs([effect], seed=6)
    continuation = continuation_of(found, weights(found, noise_levels(found)))
    every = candidates(found.boat, SECONDS)
    drifting = Hypothesis((by_label(every)["drifting_current"],))
    best = continuation.fit(1, drifting, np.array([0.1, 0.05, 0.0, 0.0]))
    assert with_special_cases(continuation, best, every, 1).hypothesis.label == name


def test_the_proposed_manoeuvre_separates_drag_and_thrust_which_straight_runs_do_not() -> None:
    truth = [{"effect": "linear_drag", "coefficient": 6.0}]
    possible = ("linear_drag", "thrust_scale", "thruster_gain", "current")
    straight = np.zeros((3, round(SECONDS / DT), 8))
    straight[..., 4:] = 0.7
    steady = driven(truth, straight, 0.8, seed=9)
    found = select_effects(steady, *possible)
    names = {found.winner.hypothesis.label, *(one.hypothesis.label for one in found.rivals)}
    assert {"linear_drag", "thrust_scale"} <= names
    trial = separating_manoeuvre(steady, noise_levels(steady), found.winner, found.rivals)
    assert trial.separation > 10.0
    proposed = manoeuvres(steady.boat, DT)[trial.manoeuvre][None, : straight.shape[1]]
    sailed = driven(truth, proposed, 0.0, seed=10)
    settled = select_effects(joined(steady, sailed), *possible)
    assert settled.winner.hypothesis.label == "linear_drag"
    assert not settled.rivals


def test_two_swapped_channels_are_named() -> None:
    truth = simulated_runs([{"effect": "channel_swap", "thruster": ["bs", "sp"]}], seed=5)
    found = select_effects(truth, "channel_swap", "thruster_gain", "azimuth_offset")
    assert found.winner.hypothesis.label == "channel_swap bs sp"


def test_a_residual_force_has_the_direction_and_size_of_the_hidden_one() -> None:
    found = simulated_runs([{"effect": "external_force", "north": 1.5, "east": -0.8}], seed=6)
    forces = residual_forces(found, weights(found, noise_levels(found)), Hypothesis(), np.zeros(0))
    surge, sway = forces.force[:, :2].T
    north, east = np.median(turned(surge, sway, forces.variables["heading"]), axis=1)
    assert np.arctan2(east, north) == pytest.approx(np.arctan2(-0.8, 1.5), abs=0.2)
    assert np.hypot(north, east) == pytest.approx(np.hypot(1.5, 0.8), rel=0.1)


def test_a_command_that_changed_in_a_lost_row_is_estimated() -> None:
    truth = simulated_runs([], seed=7)
    change = int(np.flatnonzero(np.diff(truth.commands[0, :, 0]))[2]) + 1
    for lost in (change - 1, change):
        commands = truth.commands.copy()
        commands[0, lost] = 0.5 * (commands[0, lost - 1] + commands[0, lost + 1])
        gap = Gap(0, lost, 1)
        found = replace(truth, commands=commands, gaps=(gap,))
        weight = weights(found, noise_levels(found))
        assert with_relevant_gaps(found, weight).gaps == (gap,)
        read = with_best_commands(found, weight, (gap,), Hypothesis(), np.zeros(0))
        assert read.commands == pytest.approx(truth.commands)


def test_waves_are_found_by_a_scan_of_frequencies() -> None:
    found = simulated_runs([{"effect": "waves", "force": 2.0, "frequency": 0.23, "from": 1.0}], seed=8)
    problem = Shooting(found, weights(found, noise_levels(found)), 5.0)
    at = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states())
    start = wave_starts(problem, at, np.zeros((*at.residual.shape, 0)))[0]
    values = by_label(candidates(load_boat("swamp"), SECONDS))["waves"].values(start)
    assert values["frequency"] == pytest.approx(0.23, abs=0.01)
    assert values["force"] == pytest.approx(2.0, rel=0.15)
    assert values["from"] == pytest.approx(1.0, abs=0.2)


def test_every_effect_that_is_not_random_or_external_is_a_candidate() -> None:
    found = {
        instance.effect.name
        for boat in ("swamp", "esso_osaka")
        for instance in candidates(load_boat(boat), SECONDS)
    }
    nuisance = {name for name, effect in LIBRARY.items() if effect.nuisance}
    assert found | nuisance == set(LIBRARY) - {
        "gusts",
        "thruster_kick",
        "force_curve",
        "low_battery",
    }


def test_only_thrusters_that_push_astern_may_be_reversed() -> None:
    names = {
        boat: {instance.effect.name for instance in candidates(load_boat(boat), SECONDS)}
        for boat in ("swamp", "esso_osaka")
    }
    assert "throttle_reversed" in names["esso_osaka"] - names["swamp"]


def test_the_extended_boat_can_be_loaded_and_holds_the_effect(tmp_path: Any) -> None:
    boat = load_boat("swamp")
    instance = by_label(candidates(boat, 60.0))["channel_swap bs sp"]
    lag = by_label(candidates(boat, 60.0))["azimuth_lag"]
    write_extended(tmp_path, "swamp", Hypothesis((lag, instance)), np.array([0.4]))
    effects = load_boat(tmp_path / "extended_boat.yaml").effects
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
        run_set_of([Run("short", columns | {"time": time})], boat, "folder")
    long: dict[str, Any] = {name: np.zeros(400) for name in columns}
    long["time"] = np.arange(400) * DT
    with pytest.raises(UserError, match="no thruster ever runs"):
        run_set_of([Run("still", long)], boat, "folder")


def test_the_schema_names_the_four_verdicts() -> None:
    schema = json.dumps(Diagnosis.model_json_schema())
    for verdict in ("nothing_wrong", "cause", "indistinguishable", "unexplained"):
        assert verdict in schema
    assert len(CHANNELS) == 6


def test_effects_without_a_number_are_told_and_no_effect_is_none_of_them() -> None:
    exchanged, weak = (
        next(one for one in candidates(load_boat("swamp"), SECONDS) if one.effect.name == name)
        for name in ("channel_swap", "thruster_gain")
    )
    tried = [Hypothesis(), Hypothesis((exchanged,)), Hypothesis((weak,)), Hypothesis((exchanged, weak))]
    assert labels_without_number(tried) == [exchanged.label]
