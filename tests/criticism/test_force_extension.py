"""The force that no named effect explains, as an effect of the extended boat."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.cause_share import Witness
from swamp_rl.criticism.inference.force_curves import (
    curve_instances,
    formula_instances,
    more_knots,
    nearest_coefficients,
    variable_values,
    with_knots_moved,
)
from swamp_rl.criticism.inference.force_extension import (
    ForceExtension,
    extend_by_force,
    is_better,
    prediction_shares,
)
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, joined
from swamp_rl.criticism.model.extended_boat import write_extended
from swamp_rl.criticism.report.extension import curve_name, extension_section, extension_sentence
from swamp_rl.criticism.result import Cause, CurvePoint, Diagnosis, ForceCurve, ResidualForce, Share
from swamp_rl.physics.force_curve import KNOTS
from swamp_rl.simulator import parameters
from tests.support.unmodelled_forces import BRAKE, DROGUE, sailed

NONE = np.zeros(0)
BOAT = load_boat("swamp")


def listed(force: str, variable: str, at: list[float], values: list[float]) -> ResidualForce:
    points = zip(at, values, strict=True)
    curve = [CurvePoint(at=x, force=y, standard_error=0.1) for x, y in points]
    return ResidualForce(force=force, variable=variable, explained=0.5, gain=20.0, curve=curve)


def share(horizon: float, quantity: str, without: float, with_cause: float, low: float, high: float) -> Share:
    return Share(
        horizon_s=horizon,
        quantity=quantity,  # type: ignore[arg-type]
        without=without,
        with_cause=with_cause,
        ci95=(low, high),
        moved=abs(without - with_cause),
    )


@pytest.mark.parametrize(
    ("name", "coefficients"),
    [
        ("proportional", [2.0]),
        ("square", [-3.0]),
        ("cube", [1.5]),
        ("dead_zone", [4.0, 0.5]),
        ("outside_radius", [-2.0, 0.5]),
        ("sine", [3.0, 0.7]),
    ],
)
def test_the_coefficients_of_a_formula_are_found_from_its_values(
    name: str, coefficients: list[float]
) -> None:
    at = np.linspace(-1.2, 1.1, 12)
    a, b = [*coefficients, 0.0][:2]
    force = {
        "proportional": a * at,
        "square": a * np.abs(at) * at,
        "cube": a * at**3,
        "dead_zone": a * np.sign(at) * np.maximum(np.abs(at) - b, 0.0),
        "outside_radius": a * np.sign(at) * (np.abs(at) > b),
        "sine": a * np.sin(at - b),
    }[name]
    found = nearest_coefficients(name, at, force, np.ones(12))
    spacing = 0.95 * 1.2 / 24  # of the thresholds that are tried
    assert found[1:] == pytest.approx(coefficients[1:], abs=spacing)
    assert found[0] == pytest.approx(coefficients[0], rel=0.1 if len(coefficients) > 1 else 1e-9)


def test_knots_are_added_in_the_longest_intervals() -> None:
    knots = more_knots(np.array([0.0, 0.8, 0.9, 1.0]), NONE)
    assert len(knots) == KNOTS
    assert (np.diff(knots) > 0.0).all()
    assert np.diff(knots).max() < 0.3


def test_no_knot_is_added_where_there_is_no_sample() -> None:
    samples = np.concatenate([np.linspace(0.0, 0.48, 30), np.linspace(0.62, 1.0, 30)])
    knots = more_knots(np.array([0.0, 0.4, 0.8, 1.0]), samples)
    assert len(knots) == KNOTS
    assert not ((knots > 0.48 + 1e-9) & (knots < 0.62 - 1e-9)).any()
    assert more_knots(np.array([0.0, 1.0]), np.array([0.0, 1.0])).tolist() == [0.0, 1.0]


@pytest.mark.slow
def test_knots_move_to_the_step_of_a_function() -> None:
    run_set, step = sailed(None, "A"), 0.07
    at = np.linspace(-0.8, 0.8, KNOTS)
    (function,) = curve_instances(run_set, [listed("surge", "surge", at.tolist(), (at > step).tolist())])[1:]
    (instance,), (values,) = function.instances, function.starts
    for _ in range(3):
        moved = with_knots_moved(run_set, instance, values)
        assert moved is not None
        instance, values = moved
        assert instance.curve is not None
        knots = np.array(instance.curve.knots)
        values = (knots > step).astype(float)  # as a fit would find them
    assert len(knots) == KNOTS
    place = int(np.searchsorted(knots, step))
    assert knots[place] - knots[place - 1] < 0.1 * (at[1] - at[0])


@pytest.mark.slow
def test_a_force_that_depends_on_the_place_has_both_components() -> None:
    run_set = sailed(None, "A")
    both = curve_instances(run_set, [listed("north", "position north", [-5.0, 0.0, 5.0], [1.0, 0.0, -1.0])])
    assert [one.curve.component for one in both[0].instances if one.curve] == ["north", "east"]
    assert not both[0].starts[1].any()
    values = variable_values(run_set, "position north")
    curve = both[0].instances[0].curve
    assert curve is not None and values.min() <= curve.knots[0] < curve.knots[-1] <= values.max()


@pytest.mark.slow
def test_a_propellers_thrust_and_the_surge_force_that_it_is_are_one_function() -> None:
    run_set = replace(sailed(None, "A"), boat=load_boat("esso_osaka"))
    at, first, second = np.linspace(-0.75, 1.0, 8).tolist(), [1.0] * 8, [2.0] * 8
    both = [listed("thrust of main", "heading", at, first), listed("surge", "heading", at, second)]
    _, *others = curve_instances(run_set, both)
    assert [(np.unique(one.starts[0]).tolist(), len(one.instances)) for one in others] == [([1.0], 1)]


@pytest.mark.slow
def test_a_function_of_the_heading_goes_round_and_takes_no_power_of_it() -> None:
    at = np.linspace(-0.75, 1.0, 8) * np.pi
    instance = curve_instances(sailed(None, "A"), [listed("surge", "heading", at.tolist(), [1.0] * 8)])[-1]
    curve = instance.instances[0].curve
    assert curve is not None
    assert curve.places[0] == curve.places[-1]
    formulas = formula_instances(BOAT, instance.instances[0], np.ones(8), np.ones(8))
    assert [one.curve.formula for one, _ in formulas if one.curve] == ["sine"]


def test_nothing_is_written_that_makes_a_position_error_larger() -> None:
    good = share(10.0, "position_rmse_m", 1.0, 0.5, 0.2, 0.8)
    assert is_better([good, share(30.0, "position_rmse_m", 2.0, 1.9, -0.2, 0.4)])
    assert not is_better([good, share(30.0, "position_rmse_m", 2.0, 2.1, -0.4, 0.2)])
    assert not is_better([good, share(10.0, "heading_rmse_rad", 0.1, 0.2, -0.2, -0.05)])
    doubtful = [share(10.0, "position_rmse_m", 1.0, 0.9, -0.1, 0.3)]
    assert not is_better(doubtful)
    assert is_better(doubtful, confirmed=True)
    assert not is_better([share(10.0, "position_rmse_m", 1.0, 1.1, -0.3, 0.1)], confirmed=True)
    assert not is_better([])
    assert not is_better([], confirmed=True)


def extended(run_set: RunSet) -> ForceExtension | None:
    """What is found of a surge force that grows with the speed ahead."""
    weight = weights(run_set, noise_levels(run_set))
    problem = Shooting(run_set, weight, 10.0)
    base = fit(problem, Hypothesis(), NONE, problem.initial_states(), 1)
    at = [-1.0, -0.5, 0.0, 0.5, 1.0]
    left = [listed("surge", "surge", at, [-5.0 * x for x in at])]
    on = Witness(run_set, weight, False)
    return extend_by_force(run_set, weight, base, left, on, np.random.default_rng(0))


@pytest.fixture(scope="module")
def brake() -> ForceExtension:
    found = extended(sailed(None, "A", effects=[BRAKE]))
    assert found is not None
    return found


@pytest.mark.slow
@pytest.mark.numerical
def test_a_quadratic_drag_is_written_as_a_square_of_the_speed(brake: ForceExtension, tmp_path: Path) -> None:
    assert brake.result.written
    (curve,) = brake.result.curves
    assert (curve.component, curve.covariate, curve.formula) == ("surge", "surge", "square")
    assert curve.units == ["N/(m/s)^2"]
    (value,) = BRAKE["values"]
    assert abs(curve.values[0] - value) < 4.0 * curve.standard_errors[0]
    named = joined((one, x) for one, x in brake.fit.parts() if not one.curve)
    write_extended(tmp_path, "swamp", *named, (), brake.entries)
    boat = load_boat(tmp_path / "extended_boat.yaml")
    assert [entry.effect.name for entry in boat.effects] == ["force_curve"]
    assert (parameters(boat)["force_curves"][0, 0] != 0.0).any()


@pytest.mark.slow
@pytest.mark.numerical
def test_of_something_in_tow_the_part_ahead_lowers_the_error_on_other_runs() -> None:
    found = extended(sailed(DROGUE, "A"))
    assert found is not None
    assert found.result.written
    other = sailed(DROGUE, "A", seed=2)
    judged = Witness(other, weights(other, noise_levels(other)), True)
    shares = prediction_shares(found.problem, found.less, found.fit, judged, np.random.default_rng(0))
    for one in shares:
        if one.quantity == "position_rmse_m":
            assert one.with_cause < 0.6 * one.without
            assert one.ci95[0] > 0.0


@pytest.mark.slow
@pytest.mark.numerical
def test_the_report_says_what_was_written_and_what_was_not(brake: ForceExtension) -> None:
    empty = ("causes", "indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    given: dict[str, Any] = {name: [] for name in empty} | {"separating_trial": None, "noise": {}}
    found = Diagnosis(verdict="unexplained", **given, adequacy={}, elapsed_s=1.0, extension=brake.result)
    message = extension_sentence(found, BOAT)
    assert "extended_boat.yaml has the missing force (square)" in message
    assert "surge force as a function of surge [m/s]" in message
    assert "a |x| x" in extension_section(found, BOAT)
    replaced = found.model_copy(update={"causes": [Cause(effect="linear_drag", parameters={})]})
    assert "fitted in place of linear drag, which that file lacks" in extension_sentence(replaced, BOAT)
    kept = brake.result.model_copy(update={"written": False})
    assert "is not written" in extension_sentence(found.model_copy(update={"extension": kept}), BOAT)


def test_the_report_calls_a_rudder_what_its_column_is_called() -> None:
    curve = ForceCurve(
        component="yaw",
        covariate="azimuth",
        thruster="main",
        knots=[-0.5, 0.5],
        values=[-1.0, 1.0],
        standard_errors=[0.1, 0.1],
        units=["N m"],
    )
    assert curve_name(curve, load_boat("esso_osaka")) == "yaw moment as a function of rudder main [rad]"
    assert curve_name(curve, BOAT) == "yaw moment as a function of azimuth main [rad]"
    of_a_corner = curve.model_copy(update={"thruster": "stern_port"})
    assert curve_name(of_a_corner, BOAT) == "yaw moment as a function of azimuth stern_port [rad]"


@pytest.mark.slow
@pytest.mark.numerical
def test_no_force_is_written_where_none_is_missing() -> None:
    found = extended(sailed(None, "A"))
    assert found is None or not found.result.written
