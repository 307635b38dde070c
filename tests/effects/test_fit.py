"""Levels of disturbances made for SWAMP, for boats of other sizes and other thrusters."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from swamp_rl.effects import load_disturbances
from swamp_rl.effects.fit import Size, fitted_level
from swamp_rl.errors import UserError
from swamp_rl.files import config_names, find_config

SWAMP = Size(1.24, 1.39, 58.0)
NAMES = ("bs", "bp", "ss", "sp")
LARGE = Size(4.0 * 1.24, 2.0 * 1.39, 100.0 * 58.0)


def level(name: str) -> dict[str, Any]:
    return yaml.safe_load(find_config("disturbances", name).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", config_names("disturbances"))
def test_a_level_stands_as_it_is_for_the_boat_that_it_names(name: str) -> None:
    given = level(name)
    own = {key: value for key, value in given.items() if key != "boat"}
    assert fitted_level(given, name, SWAMP._replace(mass=48.0), NAMES) == own


def test_speeds_times_masses_and_lengths_are_in_proportion() -> None:
    found = fitted_level(level("severe"), "severe", LARGE, NAMES)
    by_name = {entry["effect"]: entry for entry in found["effects"]}
    assert by_name["current"]["disc"] == pytest.approx(0.8)
    assert by_name["wind"]["speed"] == {"uniform": pytest.approx([0.0, 14.0])}
    assert by_name["wind"]["from"] == level("severe")["effects"][1]["from"]
    assert by_name["gusts"]["time_constant"] == pytest.approx(10.0)
    assert by_name["mass"]["mass"] == {"uniform": pytest.approx([4800.0, 6000.0])}
    assert by_name["thruster_gain"]["gain"] == {"uniform": [0.5, 0.9]}
    start = fitted_level(level("elsewhere"), "elsewhere", LARGE, NAMES)["start"]
    assert start["north"] == {"uniform": pytest.approx([-36.0, -12.0])}


def test_an_effect_on_thrusters_that_the_boat_lacks_is_left_out() -> None:
    found = fitted_level(level("severe"), "severe", LARGE, ("bs", "main"))
    thrusters = [entry.get("thruster") for entry in found["effects"]]
    assert thrusters == [None, None, None, {"choice": ["bs"]}, None]


@pytest.mark.parametrize("name", config_names("disturbances"))
def test_every_level_serves_a_boat_with_one_thruster(name: str) -> None:
    assert load_disturbances(name, ("main",), LARGE).thruster_names == ("main",)


def test_a_level_that_names_no_boat_is_refused_where_a_thruster_is_lacking(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text("effects: [{effect: thruster_gain, thruster: ss, gain: 0.5}]\n")
    with pytest.raises(UserError, match="unknown thruster 'ss'"):
        load_disturbances(path, ("main",), LARGE)


@pytest.mark.parametrize(
    ("boat", "message"),
    [
        ("swamp", "boat must be {length"),
        ("{length: 1.2}", "boat must be {length"),
        ("{length: 0, speed: 1, mass: 1}", "boat.length must be 0.01 to 1000, not 0"),
        ("{length: 1, speed: 1e-320, mass: 1}", "boat.speed must be 0.01 to 100, not 1e-320"),
        ("{length: 1, speed: 1, mass: 1e300}", r"boat.mass must be 0.001 to 1e\+09, not 1e\+300"),
    ],
)
def test_a_boat_that_is_no_size_is_refused(tmp_path: Path, boat: str, message: str) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(f"boat: {boat}\n")
    with pytest.raises(UserError, match=rf"own\.yaml: {message}"):
        load_disturbances(path, NAMES, SWAMP)
