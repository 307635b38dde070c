"""Forces as functions of one variable: how they act, how they are drawn and how a wrong one is refused."""

import math
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.boat.mapping import boat_mapping
from swamp_rl.effects import apply_effects, load_disturbances, parse_effects
from swamp_rl.effects.curve import formulas_of
from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml
from swamp_rl.simulator import initial_state, parameters, simulate, step, tank
from swamp_rl.simulator.state import HEADING, SURGE
from swamp_rl.simulator.step import step_parallel
from tests.support.effects import BOAT, NAMES, SURGE_MASS, at_once, lively, record, track

CURVE: dict[str, Any] = {"effect": "force_curve"}
STEADY = {**CURVE, "component": "surge", "covariate": "heading", "knots": [-3.2, 3.2], "values": [2.0, 2.0]}


def refused(entry: dict[str, Any]) -> str:
    with pytest.raises(UserError) as error:
        parse_effects([entry], "boat.yaml", NAMES)
    assert "\n" not in str(error.value)
    return str(error.value)


def pushed(**keys: Any) -> float:
    """Surge force at 0.5 m/s ahead, beside what the boat file's own is."""
    alike = {"velocity": (0.5, 0.0, 0.0)}
    return float((at_once({**CURVE, **keys}, **alike) - at_once(**alike))[0] * SURGE_MASS)


@pytest.mark.parametrize(
    ("formula", "values", "force"),
    [
        (None, [1.0, 3.0, 5.0], 4.0),
        ("proportional", [3.0], 1.5),
        ("square", [-8.0], -2.0),
        ("cube", [8.0], 1.0),
        ("dead_zone", [10.0, 0.3], 2.0),
        ("dead_zone", [10.0, 0.6], 0.0),
        ("outside_radius", [-2.0, 0.4], -2.0),
        ("outside_radius", [-2.0, 0.6], 0.0),
    ],
)
def test_a_curve_gives_the_force_of_its_knots_or_of_its_formula(
    formula: str | None, values: list[float], force: float
) -> None:
    keys = {"knots": [-1.0, 0.0, 1.0]} if formula is None else {"formula": formula, "knots": [-1.0, 1.0]}
    found = pushed(component="surge", covariate="surge", values=values, **keys)
    assert found == pytest.approx(force, abs=2e-3)


def test_a_curve_is_zero_outside_its_knots() -> None:
    assert pushed(component="surge", covariate="surge", knots=[0.0, 0.4], values=[3.0, 3.0]) == 0.0


def test_a_constant_curve_over_all_headings_is_a_steady_force_of_the_same_size() -> None:
    command = lively()
    north = {
        **CURVE,
        "component": "north",
        "covariate": "heading",
        "knots": [-3.2, 3.2],
        "values": [2.0, 2.0],
    }
    assert track(command, north) == pytest.approx(
        track(command, {"effect": "external_force", "north": 2.0}), abs=1e-9
    )


def test_a_thrust_that_is_proportional_to_the_square_of_the_throttle_is_a_thruster_gain() -> None:
    boat = load_boat("swamp-thesis")
    command = lively()
    quadratic = boat.thrusters[0].thrust_quadratic
    deduction = {"effect": "thrust_deduction", "low": 1.0, "high": 1.0}
    curve = {**CURVE, "component": "thrust", "covariate": "throttle", "thruster": "bs", "formula": "square"}
    more = {**curve, "knots": [-1.0, 1.0], "values": [0.5 * float(quadratic)]}
    gain = {"effect": "thruster_gain", "thruster": "bs", "gain": 1.5}
    assert track(command, deduction, more) == pytest.approx(track(command, deduction, gain), abs=1e-9)


def test_a_sine_over_the_heading_is_a_force_towards_one_side_of_the_earth() -> None:
    sine = {**CURVE, "component": "surge", "covariate": "heading", "formula": "sine", "knots": [-3.2, 3.2]}
    for heading in (0.3, 2.8, 2.8 + 2.0 * math.pi):
        params = record({**sine, "values": [3.0, 0.5]})
        start = initial_state(params, np.array([[0.0, 0.0, heading]]))
        moved = simulate(params, tank(BOAT), start, np.zeros((1, 1, 8)), np.zeros(1, np.uint64), 1e-5, 1)
        assert moved[0, -1, SURGE] / 1e-5 * SURGE_MASS == pytest.approx(
            3.0 * math.sin(heading - 0.5), abs=1e-3
        )


def test_a_batch_gives_the_bits_of_one_boat() -> None:
    n, command = 70, lively()[:50]
    curves = [
        {**STEADY, "values": [2.0, -1.0]},
        {
            **CURVE,
            "component": "thrust",
            "covariate": "throttle",
            "thruster": "ss",
            "knots": [0.0, 0.3, 0.9],
            "values": [0.0, -2.0, 1.0],
        },
    ]
    params = record(*curves, boats=n)
    states = initial_state(params, np.zeros((n, 3)))
    alone = states[:1].copy()
    parallel = states.copy()
    for row in command:
        commands = np.repeat(row[None], n, axis=0)
        step(states, params, tank(BOAT), commands, np.zeros(n, np.uint64), 0.1, 2)
        step_parallel(parallel, params, tank(BOAT), commands, np.zeros(n, np.uint64), 0.1, 2)
        step(alone, params[:1], tank(BOAT), row[None], np.zeros(1, np.uint64), 0.1, 2)
    assert states.tobytes() == np.repeat(alone, n, axis=0).tobytes() == parallel.tobytes()
    assert abs(states[0, HEADING]) > 0.0


def test_several_curves_add_up_and_a_fifth_is_refused() -> None:
    assert np.array_equal(track(lively(), STEADY, STEADY), track(lively(), {**STEADY, "values": [4.0, 4.0]}))
    with pytest.raises(UserError, match="a boat may have 4 of them"):
        apply_effects(parameters(BOAT), parse_effects([STEADY] * 5, "here", NAMES), NAMES)


def test_a_level_of_disturbances_has_a_curve_in_its_share_of_the_episodes() -> None:
    level = load_disturbances([{**STEADY, "probability": 0.5}], NAMES)
    params = parameters(BOAT, 2)
    level.apply(params, np.array([[0.2], [0.8]]))
    assert (params["force_curves"][:, 0, 0] != 0.0).tolist() == [True, False]
    assert level.drawn(np.array([0.2])) == [STEADY]
    assert level.drawn(np.array([0.8])) == []


def test_a_boat_file_with_a_curve_stands_alone_and_has_a_digest_of_its_own(tmp_path: Any) -> None:
    entry = {**STEADY, "standard_errors": [0.1, 0.2]}
    write_yaml(tmp_path / "one.yaml", {"extends": "swamp", "effects": [entry]})
    write_yaml(tmp_path / "two.yaml", {"extends": "swamp", "effects": [{**entry, "knots": [-3.0, 3.2]}]})
    one, two = (load_boat(tmp_path / f"{name}.yaml") for name in ("one", "two"))
    assert boat_mapping(one)["effects"] == [entry]
    assert len({boat_digest(one), boat_digest(two), boat_digest(load_boat("swamp"))}) == 3


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"component": "surg"}, "unknown component 'surg'; did you mean 'surge'?"),
        ({"component": None}, "unknown component null"),
        ({"covariate": "roll"}, "unknown covariate 'roll'"),
        ({"knots": [1.0, 0.0]}, "knots must be 2 to 9 numbers that increase"),
        ({"knots": list(range(10)), "values": [0.0] * 10}, "knots must be 2 to 9 numbers"),
        ({"knots": "0"}, "knots must be a list of numbers"),
        ({"values": [1.0, float("nan")]}, "values must be a list of numbers"),
        ({"values": [1.0]}, "values must be 2 numbers, as many as there are knots"),
        ({"standard_errors": [1.0]}, "standard_errors must be 2 numbers"),
        ({"standard_errors": [1.0, -1.0]}, "standard_errors must be at least 0"),
        ({"formula": "square"}, "unknown formula 'square'"),  # of an angle
        ({"formula": "sine", "values": [1.0]}, "values must be 2 numbers, as many of the formula sine"),
        ({"thruster": "bs"}, "thruster must be one of them"),
        ({"component": "thrust"}, "thruster is missing"),
        ({"component": "thrust", "thruster": "all"}, "thruster must be one of them"),
        ({"component": "thrust", "thruster": "stern"}, "unknown thruster 'stern'"),
        ({"knot": [1.0]}, "unknown key 'knot'; did you mean 'knots'?"),
    ],
)
def test_a_wrong_curve_is_refused_with_what_is_known(change: dict[str, Any], text: str) -> None:
    message = refused({**STEADY, **change})
    assert message.startswith("boat.yaml: effects[0]")
    assert text in message


def test_formulas_fit_the_unit_of_their_variable() -> None:
    assert formulas_of("heading") == ("sine",)
    assert "sine" not in formulas_of("speed")
    assert set(formulas_of("speed")) == {"proportional", "square", "cube", "dead_zone", "outside_radius"}
