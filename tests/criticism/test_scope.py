"""Effects whose parameters differ between runs: their records, sensitivities, special cases and files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from swamp_rl.angles import turned
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.estimate import causes_of
from swamp_rl.criticism.likelihood.cross_validation import heldout_numbers
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import at_states, fit
from swamp_rl.criticism.model.candidates import (
    EffectInstance,
    Hypothesis,
    by_label,
    candidates,
    differing,
)
from swamp_rl.criticism.model.extended_boat import write_extended
from swamp_rl.criticism.report.words import spread_sets
from swamp_rl.criticism.selection.backward_elimination import nested
from tests.support.criticism import SECONDS, simulated_runs

RUNS = simulated_runs([{"effect": "wind", "speed": 4.0, "from": 0.5}])
EVERY = by_label(candidates(RUNS.boat, SECONDS, RUNS.groups))
WINDS = np.array([3.0, 1.0, -2.0, 0.5, 0.0, 4.0])  # of three runs: components towards where it comes from


def hypothesis(*labels: str) -> Hypothesis:
    return Hypothesis(tuple(sorted((EVERY[label] for label in labels), key=lambda one: one.label)))


def shooting(runs: RunSet = RUNS) -> Shooting:
    return Shooting(runs, weights(runs, noise_levels(runs)), 10.0)


def test_the_weather_and_a_battery_may_differ_between_runs_and_what_is_loaded_between_days() -> None:
    every = candidates(RUNS.boat, SECONDS, replace(RUNS, days=("monday", "tuesday", "monday")).groups)
    by_run, by_day = ({one.effect.name for one in every if one.by == by} for by in ("run", "day"))
    weather = {"wind", "current", "external_force", "shallow_water"}
    assert by_run == weather | {"thrust_sag"}
    assert by_day == by_run | {"mass", "thrust_scale", "heading_bias"}


def test_each_run_has_the_record_of_its_own_wind() -> None:
    records = hypothesis("wind by_run").records(RUNS.boat, WINDS[None], runs=np.array([2, 0, 1, 0]))
    expected = WINDS.reshape(3, 2)[[2, 0, 1, 0]]
    np.testing.assert_allclose(records["wind_speed"], np.hypot(*expected.T))
    np.testing.assert_allclose(records["wind_from"], np.arctan2(expected[:, 1], expected[:, 0]))


def test_the_same_wind_in_every_run_predicts_what_a_shared_one_does() -> None:
    problem = shooting()
    states = problem.initial_states()[None]
    shared = problem.predict(hypothesis("mass", "wind"), np.array([[60.0, 3.0, 1.0]]), states)
    each = problem.predict(hypothesis("mass", "wind by_run"), np.array([[60.0, *([3.0, 1.0] * 3)]]), states)
    np.testing.assert_array_equal(each, shared)


def test_sensitivities_to_a_runs_own_wind_are_finite_differences_and_zero_in_other_runs() -> None:
    problem, both = shooting(), hypothesis("mass", "wind by_run")
    x, states = np.array([60.0, *WINDS]), problem.initial_states()
    base = problem.predict(both, x[None], states[None])[0]
    slopes = parameter_jacobian(problem, both, x, states, base)
    for column, spec in enumerate(both.specs):
        moved = x.copy()
        moved[column] += spec.difference
        track = problem.predict(both, moved[None], states[None])[0]
        expected = problem.standardised((track - base) / (moved[column] - x[column]))
        np.testing.assert_allclose(
            slopes[..., column], expected, rtol=1e-4, atol=1e-4 * np.abs(expected).max()
        )
    assert not slopes[problem.windows.run != 1][:, :, 3:5].any()


def test_a_shared_effect_is_a_special_case_of_one_that_differs() -> None:
    assert nested(hypothesis("wind"), hypothesis("mass", "wind by_run"))
    assert not nested(hypothesis("wind by_run"), hypothesis("wind"))


def test_a_run_held_out_takes_what_the_others_share_and_its_own_wind_beside_that() -> None:
    wind = {"effect": "wind", "speed": 4.0, "from": 0.5}
    one, other = (simulated_runs([wind, {"effect": "resistance", "scale": scale}]) for scale in (1.0, 1.3))
    run = np.array([0.0, 1.0, 0.0])[:, None, None]  # the second run is of another boat
    problem = shooting(replace(one, measured=np.where(run, other.measured, one.measured)))
    both = hypothesis("resistance", "wind by_run")
    at = fit(problem, both, np.array([1.0, *([3.5, 1.9] * 3)]), problem.initial_states())
    x = heldout_numbers(problem, at)[1]
    assert abs(x[0] - 1.0) < 0.05 < at.x[0] - 1.0
    mine, own = problem.windows.run == 1, slice(3, 5)
    tried = np.array([x, x, x])
    tried[1, own], tried[2, own] = at.x[own], 2.0 * x[own] - at.x[own]
    fitted, kept, beyond = (at_states(problem.part(mine), both, x, at.states[mine], 30).chi2 for x in tried)
    assert fitted < min(kept, beyond) - 1.0


def test_the_conditions_of_each_run_are_a_file_of_their_own(tmp_path: Path) -> None:
    write_extended(tmp_path, "swamp", hypothesis("mass", "wind by_run"), np.array([60.0, *WINDS]), RUNS.names)
    assert [
        one["effect"] for one in yaml.safe_load((tmp_path / "extended_boat.yaml").read_text())["effects"]
    ] == ["mass"]
    (wind,) = yaml.safe_load((tmp_path / "conditions" / "b.yaml").read_text())["effects"]
    assert wind["speed"] == pytest.approx(np.hypot(-2.0, 0.5))


def test_the_boats_own_effects_are_in_its_file_where_all_runs_share_them(tmp_path: Path) -> None:
    write_extended(tmp_path, "swamp", hypothesis("thrust_sag", "wind"), np.array([0.001, 3.0, 1.0]))
    boat = yaml.safe_load((tmp_path / "extended_boat.yaml").read_text())
    conditions = yaml.safe_load((tmp_path / "conditions.yaml").read_text())
    assert [one["effect"] for one in boat["effects"]] == ["thrust_sag"]
    assert [one["effect"] for one in conditions["effects"]] == ["wind"]


def test_a_cause_of_each_run_has_their_mean_and_the_spread_between_them() -> None:
    problem, both = shooting(), hypothesis("mass", "wind by_run")
    at = fit(problem, both, np.array([RUNS.boat.mass, *([3.5, 1.9] * 3)]), problem.initial_states())
    wind = next(cause for cause in causes_of(problem, at) if cause.effect == "wind")
    assert set(wind.groups) == set(RUNS.names)
    assert set(wind.spread) == {"north", "east"}
    assert wind.spread["north"].low <= wind.spread["north"].value < wind.spread["north"].high < 2.0
    assert abs(wind.parameters["speed"].value - 4.0) < 4.0 * wind.parameters["speed"].standard_error
    assert next(name for name, *_ in spread_sets(wind)) == "standard deviation of north between runs"


def test_waves_that_differ_between_runs_are_fitted_run_by_run() -> None:
    true = [(15.0, 0.30, 0.4, 0.3), (12.0, 0.22, -1.0, -0.5), (20.0, 0.40, 2.0, 0.0)]  # N, Hz, rad, rad
    names = ("force", "frequency", "from", "phase")
    sailed = [
        simulated_runs([{"effect": "waves"} | dict(zip(names, one, strict=True))], seed)
        for seed, one in enumerate(true)
    ]
    measured = np.stack([one.measured[run] for run, one in enumerate(sailed)])
    runs = replace(RUNS, measured=measured)
    each = differing(by_label(candidates(runs.boat, SECONDS))["waves"], "run", (0, 1, 2))
    components = [(f * np.cos(a), hz, f * np.sin(a), phase) for f, hz, a, phase in true]
    problem = Shooting(runs, weights(runs, noise_levels(runs)), 20.0)
    # a frequency as a spectrum tells it: to less than half a period in a run
    begin = np.array(components) * [0.85, 1.0, 0.85, 1.0] + [0.0, 0.005, 0.0, 0.1]
    at = fit(problem, Hypothesis((each,)), begin.ravel(), problem.initial_states())
    (found,) = causes_of(problem, at)
    off = {"force": 1.5, "frequency": 0.005, "from": 0.1, "phase": 0.2}  # N, Hz, rad, rad
    for run, one in zip(RUNS.names, true, strict=True):
        for name, value in zip(names, one, strict=True):
            number = found.groups[run][name]
            assert abs(number.value - value) < min(4.0 * number.standard_error, off[name]), (run, name)


def test_a_bias_of_the_compass_fits_velocities_that_it_turned() -> None:
    runs = simulated_runs([{"effect": "heading_bias", "bias": 0.1}])
    bias = by_label(candidates(runs.boat, SECONDS))["heading_bias"]
    measured = runs.measured.copy()
    measured[..., 3], measured[..., 4] = turned(measured[..., 3], measured[..., 4], np.array(-0.1))
    biased = replace(runs, measured=measured, of_earth=(True, True, True))
    chi2 = {}
    for name, one in {"given": biased, "not given": replace(biased, of_earth=())}.items():
        problem = Shooting(one, weights(one, noise_levels(one)), 5.0)
        made = fit(problem, Hypothesis((bias,)), np.array([0.05]), problem.initial_states())
        chi2[name] = made.chi2 / problem.samples, float(made.x[0])
    assert chi2["given"] == (pytest.approx(1.0, abs=0.15), pytest.approx(0.1, abs=0.003))
    assert chi2["not given"][0] > 1.5


def test_days_are_groups_where_a_dataset_names_them() -> None:
    two_days = replace(RUNS, days=("monday", "tuesday", "monday"))
    found: EffectInstance = by_label(candidates(RUNS.boat, SECONDS, two_days.groups))["wind by_day"]
    assert (found.groups, found.size) == ((0, 1, 0), 4)


def test_runs_of_which_each_is_a_day_differ_by_day() -> None:
    days = replace(RUNS, days=("tuesday", "monday", "wednesday"))
    assert days.groups == {"day": (1, 0, 2)}
    assert days.group_names("day") == ["monday", "tuesday", "wednesday"]
    assert set(RUNS.groups) == {"run"} and set(replace(RUNS, days=("monday",) * 3).groups) == {"run"}
