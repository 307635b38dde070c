"""The published schema of boat files agrees with the loader."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from swamp_rl.boat import load_boat
from swamp_rl.boat.estimate import KINDS, Kind, annotated, boat_file
from swamp_rl.boat.json_schema import schema_text
from swamp_rl.errors import UserError

ROOT = Path(__file__).parents[2]
PUBLISHED = ROOT / "docs" / "boat.schema.json"
SHIPPED = sorted((ROOT / "configs" / "boats").glob("*.yaml"))
VALIDATOR = jsonschema.Draft202012Validator(json.loads(schema_text()))


def test_the_published_schema_is_that_of_the_code() -> None:
    assert PUBLISHED.read_text(encoding="utf-8") == schema_text(), (
        "write it anew: python -m swamp_rl.boat.json_schema docs/boat.schema.json"
    )
    VALIDATOR.check_schema(VALIDATOR.schema)


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_a_shipped_boat_file_fits_the_schema(file: Path) -> None:
    VALIDATOR.validate(yaml.safe_load(file.read_text()))


@pytest.mark.parametrize("kind", KINDS)
def test_an_estimated_boat_file_fits_the_schema(kind: Kind) -> None:
    VALIDATOR.validate(
        yaml.safe_load(annotated(boat_file("skiff", kind, 4.0, 1.6, 300.0, 400.0), "A skiff."))
    )


JET = "thrust_linear: null, thrust_quadratic: null, advance_loss: null"
PROPELLER = "{diameter: 0.08, revolutions_max: 25, open_water: {kind: disc, pitch_ratio: 1.0}}"


@pytest.mark.parametrize(
    "text",
    [
        "mass: 62\nhull: {n_r: -0.1, c_d: yoshimura}",
        "thrusters: {bs: {x: 0.36}, bp: null}\njoypad: {thrusters: [bs]}",
        f"thruster_model: {{{JET}, propeller: {PROPELLER}}}",
        "effects: [{effect: thruster_gain, thruster: bs, gain: 0.7}]",
        'mass: {value: 62, unit: kg, provenance: measured, source: "scales", sd: 0.5}',
    ],
)
def test_what_the_loader_reads_fits_the_schema(tmp_path: Path, text: str) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(f"extends: swamp\n{text}\n")
    load_boat(file)
    VALIDATOR.validate(yaml.safe_load(file.read_text()))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("mass", {"value": 62.0, "unit": "t", "provenance": "measured", "source": "scales"}),
        ("mass", {"value": 62.0, "unit": "kg", "provenance": "guessed", "source": "scales"}),
        ("length", -1.0),
        ("draft", 0.1),
        ("hull", {"n_q": 0.1}),
        ("thrusters", []),
        ("thrusters", {"bs": {"azimut_min": 0.1}}),
        ("effects", [{"effect": "thruster_gian", "thruster": "bs", "gain": 0.7}]),
    ],
)
def test_what_the_loader_refuses_does_not_fit_the_schema(tmp_path: Path, key: str, value: Any) -> None:
    content = {"extends": "swamp", key: value}
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(UserError):
        load_boat(tmp_path / "mine.yaml")
    assert not VALIDATOR.is_valid(content)


def test_a_file_that_extends_nothing_needs_what_has_no_default() -> None:
    assert not VALIDATOR.is_valid({"name": "mine", "length": 4.0})
