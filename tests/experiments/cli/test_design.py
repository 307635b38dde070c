"""`swamp-rl design`: what it writes, what a boat file takes of it, and what it refuses."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from swamp_rl.boat import load_boat
from swamp_rl.design import draught_of, load_hull
from swamp_rl.files import find_config, read_yaml, write_yaml
from swamp_rl.replacement import WRITTEN as LIST
from tests.support.command_line import Call, assert_complains

COMMON = {LIST, "design.json", "design.yaml"}
WRITTEN = {
    ("pump-jet", "swamp_pump_jet"): {"boat.yaml", "curve.csv", "triangles.csv", "pump_jet.png"},
    ("hull", "swamp_hull"): {"boat.yaml", "hydrostatics.csv", "load.csv", "levers.csv", "hull.png"},
    ("match", "typhoon_match"): {"propellers.csv", "ranges.csv", "match.png"},
}


def own(name: str, path: Path, **keys: Any) -> Path:
    """A design file of one's own: a shipped one with other keys."""
    write_yaml(path, read_yaml(find_config("designs", name)) | keys)
    return path


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize(("kind", "name"), list(WRITTEN))
def test_a_design_writes_its_tables_figure_and_file(kind: str, name: str, call: Call, tmp_path: Path) -> None:
    code, message, complaint = call("design", kind, name, "--out", "out")
    assert (code, complaint) == (0, "")
    assert {path.name for path in (tmp_path / "out").iterdir()} == COMMON | WRITTEN[kind, name]
    assert {path.name for path in tmp_path.iterdir()} == {"out"}
    result = json.loads((tmp_path / "out" / "design.json").read_text())
    assert result["design"] == kind
    for table, units in result["units"].items():
        assert table in message
        (first, *_) = rows(tmp_path / "out" / table)
        assert list(first) == list(units)
    (picture,) = (tmp_path / "out").glob("*.png")
    assert picture.read_bytes().startswith(b"\x89PNG")
    again = call("design", kind, "out/design.yaml", "--out", "out")
    assert again[0] == 0 and again[1] == message


def test_a_boat_takes_the_pump_jets_thrust(call: Call, tmp_path: Path) -> None:
    path = own("swamp_pump_jet", tmp_path / "jet.yaml", thrust=11.0)
    assert call("design", "pump-jet", path, "--out", "out")[0] == 0
    boat = load_boat(tmp_path / "out" / "boat.yaml")
    assert [jet.thrust_quadratic for jet in boat.thrusters] == [11.0] * 4
    last = rows(tmp_path / "out" / "curve.csv")[-1]
    assert (float(last["throttle"]), float(last["thrust"])) == (1.0, 11.0)


def test_a_boat_takes_the_hulls_draught(call: Call, tmp_path: Path) -> None:
    conditions = [{"name": "half", "mass": 50.0, "centre_of_gravity": 0.25}]
    path = own("swamp_hull", tmp_path / "hull.yaml", conditions=conditions)
    base = tmp_path / "base.yaml"
    write_yaml(base, {"extends": "swamp", "x_g": 0.01})
    assert call("design", "hull", path, "--out", "out", "--boat", "base.yaml")[0] == 0
    boat = load_boat(tmp_path / "out" / "boat.yaml")
    draught = draught_of(load_hull("swamp_hull"), 50.0)
    assert boat.mass == pytest.approx(50.0)
    assert (boat.draught, boat.x_g) == (pytest.approx(draught), 0.01)
    loads = [(float(row["mass"]), float(row["draught"])) for row in rows(tmp_path / "out" / "load.csv")]
    assert loads == sorted(loads)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["pump-jet", "swamp_hull"], "design: is 'hull'"),
        (["hull", "swamp_hul"], "did you mean 'swamp_hull'"),
        (["match", "nowhere.yaml"], "nowhere.yaml: no such file"),
        (["pump-jet", "swamp_pump_jet", "--boat", "esso_osaka"], "esso_osaka: main: no jet"),
        (["hull", "swamp_hull", "--boat", "nobody"], "no boat file named 'nobody'"),
    ],
)
def test_what_cannot_be_designed_is_one_line_and_nothing_written(
    words: list[str], message: str, call: Call, tmp_path: Path
) -> None:
    assert_complains(call("design", *words, "--out", "out"), message)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("kind", "name", "keys", "message"),
    [
        ("pump-jet", "swamp_pump_jet", {"thrust": 60.0}, "no solution"),
        ("hull", "swamp_hull", {"depth": 0.15, "wigley_draught": 0.15, "cut": 0.05}, "swamp hull"),
        ("match", "typhoon_match", {"efficiency": 2.0}, "efficiency"),
    ],
)
def test_a_design_without_a_solution_leaves_an_earlier_one_alone(
    kind: str, name: str, keys: dict[str, Any], message: str, call: Call, tmp_path: Path
) -> None:
    path, out = own(name, tmp_path / "own.yaml", **keys), tmp_path / "out"
    out.mkdir()
    (out / "design.json").write_text("{}")
    if kind == "hull":
        given = read_yaml(path)["conditions"]
        write_yaml(path, read_yaml(path) | {"conditions": [given[0] | {"draught": 0.15}]})
    assert_complains(call("design", kind, path, "--out", "out"), message)
    assert [path.name for path in out.iterdir()] == ["design.json"]


def test_a_folder_of_something_else_is_not_replaced(call: Call, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "letter.txt").write_text("mine")
    called = call("design", "match", "typhoon_match", "--out", "out")
    assert_complains(called, "already exists and is not an earlier result")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["letter.txt"]


def test_a_vane_angle_outside_of_the_efficient_range_is_reported(call: Call, tmp_path: Path) -> None:
    path = own("swamp_pump_jet", tmp_path / "jet.yaml", revolutions=30.0)
    code, message, _ = call("design", "pump-jet", path, "--out", "out")
    assert code == 0 and "outside of 15 to 35 deg" in message
