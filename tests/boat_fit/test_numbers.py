"""The free numbers of each kind of boat, their priors, and the identified boat file."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.mapping import boat_mapping
from swamp_rl.boat_fit.boat_file import Fitted, identified_mapping
from swamp_rl.boat_fit.hypothesis import FreeBoat, free_boat
from swamp_rl.boat_fit.identify import supported
from swamp_rl.boat_fit.report import far_from_start, left_out, number_rows, start_sentence
from swamp_rl.boat_numbers.number import Number, log_width
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.criticism.result import Predictors
from swamp_rl.effects import LIBRARY
from swamp_rl.files import write_yaml
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.resistance import surge_resistance, towing
from swamp_rl.simulator import parameters, tank
from tests.support.from_scratch import written


def boat_of(kind: str, folder: Path) -> Boat:
    if kind in OTHERS:
        (folder / f"{kind}.yaml").write_text(OTHERS[kind])
        return load_boat(folder / f"{kind}.yaml")
    return load_boat(written(folder, kind) if kind in ("twin", "ferry") else kind)


def whole(boat: Boat) -> FreeBoat:
    return free_boat(boat, free_numbers(boat, positions=True))


def moved(hypothesis: FreeBoat) -> np.ndarray:
    """Numbers half a prior width from the file, within their bounds."""
    low, high = hypothesis.bounds()
    mean, precision = hypothesis.prior()
    up, down = mean + 0.5 / np.sqrt(precision), mean - 0.5 / np.sqrt(precision)
    return np.where(up <= high, np.maximum(up, low), down)


KINDS = ("twin", "ferry", "swamp", "esso_osaka", "open_water", "table", "foil")
OTHERS = {  # a propeller with a rudder by its open-water model, jets by a measured table, and with foils
    "foil": """
extends: swamp
thruster_model: {foil: {area: 0.01, aspect_ratio: 1.5, gamma: 0.7}}
""",
    "open_water": """
extends: esso_osaka
thrusters:
  main:
    propeller:
      k_t: null
      astern_thrust: null
      open_water: {kind: linear, bollard_coefficient: 0.33, null_advance: 0.8}
""",
    "table": """
extends: swamp
thruster_model:
  thrust_linear: null
  thrust_quadratic: null
  astern_linear: null
  astern_quadratic: null
  advance_loss: null
  thrust_table: {speed: [0.0, 1.0], rows: [{throttle: 1.0, thrust: [12.0, 8.0]}]}
""",
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_records_at_the_prior_mean_are_the_boat_files(kind: str, tmp_path: Path) -> None:
    boat = boat_of(kind, tmp_path)
    hypothesis = whole(boat)
    record, plain = hypothesis.records(boat, hypothesis.prior()[0][None]), parameters(boat)
    for field in plain.dtype.names:
        np.testing.assert_allclose(record[field], plain[field], rtol=1e-12, err_msg=field)


@pytest.mark.parametrize("kind", KINDS)
def test_the_written_boat_simulates_as_the_fitted_numbers(kind: str, tmp_path: Path) -> None:
    boat = boat_of(kind, tmp_path)
    hypothesis = whole(boat)
    x = moved(hypothesis)
    fitted = [
        Fitted(number, float(own), 0.1 * number.sd) for number, own in zip(hypothesis.numbers, x, strict=True)
    ]
    write_yaml(tmp_path / "new.yaml", identified_mapping(boat, "new", fitted, "runs"))
    record, again = hypothesis.records(boat, x[None]), load_boat(tmp_path / "new.yaml")
    read = parameters(again)
    for field in set(record.dtype.names) - {"resistance_scale"}:
        np.testing.assert_allclose(read[field], record[field], rtol=1e-4, atol=1e-12, err_msg=field)
    assert again.provenance["mass"].provenance == "fitted"
    assert "standard error" in again.provenance["mass"].source
    mass = next(one for one in fitted if one.number.name == "mass")
    assert again.provenance["mass"].sd == pytest.approx(mass.standard_error, rel=1e-4)


def test_the_width_that_a_boat_file_gives_is_the_prior_of_the_fit(tmp_path: Path) -> None:
    (tmp_path / "wide.yaml").write_text(
        "extends: swamp\n"
        "mass: {value: 58.0, unit: kg, provenance: assumed, source: guess, sd: 11.6}\n"
        "x_g: {value: 0.0, unit: m, provenance: assumed, source: guess, sd: 0.05}\n"
    )
    width = {number.name: number.sd for number in free_numbers(load_boat(tmp_path / "wide.yaml"))}
    assert width["mass"] == pytest.approx(0.2, rel=0.03)  # of ln(mass)
    assert width["x_g"] == pytest.approx(0.05)


@pytest.mark.parametrize("sd", [1e-3, 0.4, 1.0, 4.3, 30.0])
def test_a_number_that_keeps_its_sign_has_the_standard_deviation_of_the_file(sd: float) -> None:
    number = Number("mass", "kg", "mass", 2.0, log_width(sd / 2.0), "", scaled=True)
    assert number.spread(number.mean, number.sd) == pytest.approx(sd)
    drawn = 2.0 * np.exp(log_width(0.5) * np.random.default_rng(0).standard_normal(200_000))
    assert drawn.std() == pytest.approx(1.0, rel=0.02)


def test_a_boat_as_a_mapping_is_the_boat_again(tmp_path: Path) -> None:
    for name in ("swamp", "esso_osaka"):
        boat = load_boat(name)
        write_yaml(tmp_path / f"{name}.yaml", boat_mapping(boat))
        again = load_boat(tmp_path / f"{name}.yaml")
        assert again == boat
        assert again.provenance == boat.provenance


def with_effect(kind: str, name: str, folder: Path) -> Boat:
    """A boat with a tenth more of all that the effect alters, at its first thruster where it selects one."""
    boat, effect = boat_of(kind, folder), LIBRARY[name]
    record, entry = parameters(boat)[0], {"effect": name}
    if effect.thruster:
        entry["thruster"] = boat.thruster_names[0]
    for parameter in effect.parameters:
        neutral = parameter.neutral
        value = 1.1 * (float(np.ravel(record[parameter.field])[0]) if neutral is None else neutral) + 0.05
        entry[parameter.name] = float(np.clip(value, parameter.low, parameter.high))
    write_yaml(folder / "start.yaml", boat_mapping(boat) | {"name": "start", "effects": [entry]})
    return load_boat(folder / "start.yaml")


NEEDS = {"swamp": ("", "azimuth", "astern"), "esso_osaka": ("", "rudder")}


def on_numbers(kind: str, folder: Path) -> list[str]:
    """The effects that alter a number of such a boat that a fit moves."""
    fields = {number.field for number in free_numbers(boat_of(kind, folder), positions=True)}
    return [
        name
        for name, effect in LIBRARY.items()
        if any(p.field in fields for p in effect.parameters) and effect.needs in NEEDS[kind]
    ]


@pytest.mark.parametrize("share", [1.0, 0.5])
@pytest.mark.parametrize("kind", NEEDS)
def test_no_effect_of_the_start_file_is_lost_with_all_or_some_of_its_numbers_fitted(
    kind: str, share: float, tmp_path: Path
) -> None:
    for name in on_numbers(kind, tmp_path):
        boat = with_effect(kind, name, tmp_path)
        numbers = free_numbers(boat, positions=True)
        numbers = numbers[: round(share * len(numbers))]
        fitted = [Fitted(number, number.mean, 0.1 * number.sd) for number in numbers]
        hypothesis = free_boat(boat, numbers)
        write_yaml(tmp_path / "new.yaml", identified_mapping(boat, "new", fitted, "runs"))
        again = load_boat(tmp_path / "new.yaml")
        for read, wanted, curves in (
            (parameters(again), hypothesis.records(boat, hypothesis.prior()[0][None]), tank(again)),
            (parameters(again), parameters(boat), tank(again)),
        ):
            same_but_for_the_scale_of_the_tank(read, wanted, curves, tank(boat), name)


def same_but_for_the_scale_of_the_tank(
    read: np.ndarray, wanted: np.ndarray, curves: np.ndarray, before: np.ndarray, message: str
) -> None:
    for field in set(wanted.dtype.names) - {"resistance_scale", "reference_mass", "x_0_ahead", "x_0_astern"}:
        np.testing.assert_allclose(
            read[field], wanted[field], rtol=1e-4, atol=1e-12, err_msg=f"{message} {field}"
        )
    forces = [
        surge_resistance(speed, 0.1, record[0], table, towing(record[0], table))
        for record, table in ((read, curves), (wanted, before))
        for speed in (0.7, -0.4)
    ]
    assert forces[:2] == pytest.approx(forces[2:], rel=1e-4), message


def test_a_number_that_only_an_effect_of_the_start_file_gives_is_not_called_measured(tmp_path: Path) -> None:
    boat = with_effect("swamp", "mass", tmp_path)
    mass = next(one for one in free_numbers(boat) if one.name == "mass")
    made = identified_mapping(boat, "new", [Fitted(mass, mass.mean, mass.sd)], "runs")["mass"]
    assert made["value"] == pytest.approx(parameters(boat)["mass"][0], rel=1e-4)
    assert (made["provenance"], made["source"]) == (
        "assumed",
        "the start file with its effects; not identifiable from runs",
    )


def test_a_number_that_the_runs_do_not_show_keeps_its_prior_and_names_its_start_value() -> None:
    boat = load_boat("swamp")
    mass = next(one for one in free_numbers(boat) if one.name == "mass")
    unseen = Fitted(mass, mass.mean + 0.1, mass.sd)
    made = identified_mapping(boat, "new", [unseen], "runs")["mass"]
    assert made["value"] == pytest.approx(boat.mass * math.exp(0.1), rel=1e-4)
    assert made.get("sd") == boat_mapping(boat)["mass"].get("sd")
    assert made["source"].endswith(f"; not identifiable from runs, moved from {boat.mass:g} by the fit")


def test_the_level_of_the_thrust_multiplies_that_of_the_start_file(tmp_path: Path) -> None:
    for text, scale in (("[]", 0.8), ("[{effect: thrust_scale, scale: 0.9}]", 0.72)):
        (tmp_path / "worn.yaml").write_text(f"extends: swamp\neffects: {text}\n")
        boat = load_boat(tmp_path / "worn.yaml")
        write_yaml(tmp_path / "new.yaml", identified_mapping(boat, "new", [], "runs", level=0.8))
        made = load_boat(tmp_path / "new.yaml")
        assert parameters(made)["thrust_scale"][0] == pytest.approx(scale)
        assert len(made.effects) == 1


def test_saturation_is_free_unless_the_start_file_has_a_curve_below_full_throttle(tmp_path: Path) -> None:
    def named(text: str) -> list[str]:
        (tmp_path / "bent.yaml").write_text(f"extends: swamp\neffects: [{text}]\n")
        boat = load_boat(tmp_path / "bent.yaml")
        return [number.name for number in free_numbers(boat) if number.field == "efficiency_100"]

    curve = "effect: thruster_efficiency_curve, thruster: all"
    assert len(named(f"{{{curve}, at_100: 0.8}}")) == len(load_boat("swamp").thrusters)
    assert named(f"{{{curve}, at_60: 0.9}}") == []


def test_saturation_stays_free_only_where_it_is_seen(tmp_path: Path) -> None:
    every = free_numbers(load_boat(written(tmp_path, "twin")))
    saturation = next(number for number in every if number.field == "efficiency_100")
    band = next(number for number in every if number.field == "dead_band")
    assert supported(Fitted(saturation, 0.5, 0.1))
    assert not supported(Fitted(saturation, 0.9, 0.1))
    assert supported(Fitted(band, 0.0, 0.08))


def test_an_offset_of_the_compass_stays_free_only_where_it_is_seen() -> None:
    boat = load_boat("swamp")
    every = free_numbers(boat)
    compass = next(number for number in every if number.field == "heading_bias")
    assert supported(Fitted(compass, -0.02, 0.005))
    assert not supported(Fitted(compass, -0.01, 0.005))
    made = [Fitted(number, number.mean, number.sd) for number in every if number is not compass]
    assert left_out(boat, made)[-1].endswith("kept as in the start file: offset of the compass.")


def test_the_thrusters_without_a_fitted_saturation_are_named(tmp_path: Path) -> None:
    boat = load_boat(written(tmp_path, "twin"))
    every = [Fitted(number, number.mean, number.sd) for number in free_numbers(boat)]
    assert left_out(boat, every) == []
    (message,) = left_out(boat, [one for one in every if one.number.field != "efficiency_100"])
    assert message.endswith("saturation of the thrust of port, starboard.")


def test_a_time_constant_of_zero_is_fitted_only_where_it_leaves_the_least_one() -> None:
    every = free_numbers(load_boat("swamp"))
    lag = next(number for number in every if number.field == "pump_time_constant")
    assert lag.start == 0.0 < lag.low
    assert not supported(Fitted(lag, lag.low, lag.sd))
    assert supported(Fitted(lag, 2.0 * lag.low, lag.sd))
    made = [Fitted(number, number.mean, number.sd) for number in every if number is not lag]
    assert left_out(load_boat("swamp"), made)[0].endswith("time constants thrusters.bs.pump_time_constant.")


def test_a_measured_number_has_a_narrower_prior_than_an_assumed_one(tmp_path: Path) -> None:
    by_name = {number.name: number for number in free_numbers(load_boat("swamp"))}
    assumed = load_boat(written(tmp_path, "twin"))
    assert by_name["mass"].sd < 0.5 * {n.name: n for n in free_numbers(assumed)}["mass"].sd


def test_the_derivative_of_a_prediction_by_a_scaled_number_is_that_of_its_record(tmp_path: Path) -> None:
    boat = load_boat(written(tmp_path, "twin"))
    number = Number("mass", "kg", "mass", boat.mass, 0.1, "", scaled=True)
    hypothesis = free_boat(boat, (number,))
    up, down = (float(hypothesis.records(boat, np.array([[h]]))["mass"][0]) for h in (1e-4, -1e-4))
    assert (up - down) / 2e-4 == pytest.approx(boat.mass, rel=1e-6)
    assert number.spread(0.2, 1e-4) == pytest.approx(boat.mass * math.exp(0.2) * 1e-4)


@pytest.mark.parametrize(
    ("other", "correlation"), [("", 0.9), ("thrusters: {port: {thrust_quadratic: 7.0}}", 0)]
)
def test_thrust_coefficients_of_equal_thrusters_are_correlated_and_keep_their_widths(
    other: str, correlation: float, tmp_path: Path
) -> None:
    written(tmp_path, "twin")
    (tmp_path / "own.yaml").write_text(f"extends: twin.yaml\nname: own\n{other}\n")
    hypothesis = whole(load_boat(tmp_path / "own.yaml"))
    covariance = np.linalg.inv(hypothesis.prior_precision)
    sd = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(sd, [number.sd for number in hypothesis.numbers])
    names = [number.name for number in hypothesis.numbers]
    port, starboard = (names.index(f"thrusters.{name}.thrust_quadratic") for name in ("port", "starboard"))
    assert covariance[port, starboard] == pytest.approx(correlation * sd[port] * sd[starboard])
    assert covariance[port, names.index("mass")] == 0.0


def test_a_number_far_from_its_prior_is_named_and_one_near_it_is_not() -> None:
    numbers = {number.name: number for number in free_numbers(load_boat("swamp"))}
    mass, x_g = numbers["mass"], numbers["x_g"]

    def at(number: Number, widths: float) -> Fitted:
        return Fitted(number, number.mean + widths * number.sd, 0.1 * number.sd)

    assert at(mass, -4.0).distance == pytest.approx(4.0)
    assert at(x_g, 2.0).distance == pytest.approx(2.0)
    (result,) = far_from_start([at(mass, -4.0), at(x_g, 2.0)])
    assert "mass (4.0)" in result and "x_g" not in result
    assert far_from_start([at(mass, 2.0)]) == []
    _, ended = far_from_start([at(mass, -6.0), at(x_g, 5.9)])
    assert ended.startswith("At the bound of the fit, 6 standard deviations of the prior: mass. ")


def test_the_report_gives_the_priors_width_about_the_start_value() -> None:
    mass = Number("mass", "kg", "mass", 100.0, 0.1, "", scaled=True)
    fitted = Fitted(mass, math.log(2.0), 0.05)
    ((_, start, identified, error, prior, *_, information),) = number_rows([fitted])
    assert (start, identified, error, prior) == ("100", "200", "10", "10")
    assert information == "75%"


def test_the_summary_says_where_the_start_file_predicts_as_well() -> None:
    def errors(*own: float) -> list[Predictors]:
        others = {"at_rest": 9.0, "constant_velocity": 9.0, "no_thrust": 9.0}
        return [Predictors(horizon_s=h, boat_file=e, **others) for h, e in zip((1.0, 5.0), own, strict=True)]

    before = errors(0.3, 0.5)
    assert (
        start_sentence(before, errors(0.2, 0.4)) == "It predicts better than the start file at each horizon."
    )
    assert (
        start_sentence(before, errors(0.3, 0.4))
        == "It does not predict better than the start file 1 s ahead."
    )
    assert (
        start_sentence(before[1:], errors(0.4, 0.4))
        == "It predicts better than the start file at each horizon."
    )


def test_of_the_two_signs_of_the_cross_flow_factor_that_are_one_motion_one_is_free() -> None:
    boat = load_boat("swamp")
    record, of_tank = parameters(boat)[0], tank(boat)
    forces = []
    for sign in (1.0, -1.0):
        turned = record.copy()
        turned["c_ry"] *= sign
        forces.append(hull_forces(0.4, 0.1, 0.3, turned, of_tank, towing(turned, of_tank)))
    assert forces[0] == pytest.approx(forces[1], rel=1e-12)
    (free,) = [one for one in free_numbers(boat) if one.name == "hull.c_ry"]
    assert free.bounds[0] == 0.0 < free.start


def test_no_fit_lets_the_cross_flow_drive_a_turn_on_the_spot() -> None:
    boat = load_boat("swamp")
    of_tank = tank(boat)
    (free,) = [one for one in free_numbers(boat) if one.name == "hull.c_rn"]
    for factor in (max(free.bounds[0], -0.7), 0.5 * free.start):
        turned = parameters(boat)[0].copy()
        turned["c_rn"] = factor
        assert hull_forces(0.0, 0.0, 0.8, turned, of_tank, towing(turned, of_tank))[2] <= 0.0
