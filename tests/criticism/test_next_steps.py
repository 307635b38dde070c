"""What to do next where no set of effects explains the runs."""

from typing import Any

import pytest
import yaml

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import boat_file
from swamp_rl.criticism.inference.next_steps import next_steps
from swamp_rl.criticism.result import Extension, ForceCurve, HeldOut, ResidualForce

FITTED = load_boat("esso_osaka")


@pytest.fixture(scope="module")
def estimated(tmp_path_factory: pytest.TempPathFactory) -> Boat:
    """A boat from its main dimensions."""
    file = tmp_path_factory.mktemp("estimated") / "boat.yaml"
    content = boat_file("mine", "azimuth", 2.0, 1.0, 60.0, 150.0)
    file.write_text(yaml.safe_dump(content), encoding="utf-8")
    return load_boat(file)


def left(variable: str, force: str = "yaw") -> list[ResidualForce]:
    return [ResidualForce(force=force, variable=variable, explained=0.5)]


def test_a_boat_file_of_no_fitted_number_is_to_be_identified_first(estimated: Boat) -> None:
    first = next_steps(estimated, left("heading"), None, [])[0]
    assert "swamp-rl identify boat" in first and "No number of this file was fitted" in first
    assert not any("identify boat" in step for step in next_steps(FITTED, left("heading"), None, []))


@pytest.mark.parametrize(
    ("boat", "variable", "said"),
    [
        ("esso_osaka", "azimuth main", "rudder main"),
        ("esso_osaka", "throttle main", "propeller main"),
        ("esso_osaka", "azimuth", "rudder"),
        ("swamp", "azimuth bs", "azimuth bs"),
        ("swamp", "throttle", "throttle"),
    ],
)
def test_commands_are_called_as_in_the_run_format(boat: str, variable: str, said: str) -> None:
    *_, step = next_steps(load_boat(boat), left(variable), None, [])
    assert step.startswith(f"the missing force depends on {said}, which suggests the thrusters")


@pytest.mark.parametrize(
    ("variable", "force", "advice"),
    [
        ("heading", "yaw", "record the wind"),
        ("time", "north", "record the wind"),
        ("yaw rate", "yaw", "circles of two sizes"),
        ("speed", "thrust of bs", "limits of throttle, azimuth and rudder"),
        ("throttle bs", "surge", "limits of throttle, azimuth and rudder"),
    ],
)
def test_the_variable_of_the_missing_force_says_what_to_record(
    variable: str, force: str, advice: str
) -> None:
    (step,) = next_steps(FITTED, left(variable, force), None, [])
    assert step.startswith(f"the missing force depends on {variable}, which suggests ") and advice in step


def test_a_wind_that_was_measured_is_not_asked_for_again() -> None:
    (used,) = next_steps(FITTED, left("heading"), None, [], "measured")
    assert "record the wind" not in used and "beside the measured wind" in used
    (ignored,) = next_steps(FITTED, left("heading"), None, [], "ignored")
    assert "record the wind" not in ignored and "without --ignore wind" in ignored


def test_without_a_variable_repeated_manoeuvres_tell_the_boat_from_the_weather() -> None:
    (step, lack) = next_steps(FITTED, [], None, ["a second speed"])
    assert "record each manoeuvre twice" in step and "what these runs lack" in lack


def test_functions_of_the_missing_force_have_a_step_for_each_origin() -> None:
    numbers: dict[str, Any] = {"knots": [0.0, 1.0], "values": [0.0, 1.0], "standard_errors": [0.1, 0.1]}
    curves = [
        ForceCurve(component="yaw", covariate=name, units=["N m"], **numbers, **more)
        for name, more in (("azimuth", {"thruster": "main"}), ("yaw_rate", {}), ("sway", {}))
    ]
    found = Extension(curves=curves, held_out=HeldOut(gain=9.0, low=1.0, level=0.05), written=True)
    thrusters, hull, extended = next_steps(FITTED, left("heading"), found, [])
    assert thrusters.startswith("the missing force depends on rudder, which suggests the thrusters")
    assert hull.startswith("the missing force depends on yaw rate and sway, which suggests the hull")
    assert extended.startswith("simulate with extended_boat.yaml, which has the missing force")
