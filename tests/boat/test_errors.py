"""A boat file that cannot be used is refused with its name, the key and what is allowed."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.schema import Hull, Joypad, Thruster, Wind
from swamp_rl.errors import UserError
from swamp_rl.files import find_config


def refused(folder: Path, text: str) -> str:
    path = folder / "broken.yaml"
    path.write_text(text)
    with pytest.raises(UserError) as error:
        load_boat(path)
    lines = str(error.value).splitlines()
    assert all(line.startswith(str(path)) for line in lines)
    return "\n".join(line.removeprefix(str(path)) for line in lines)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("mass: 0", "mass: must be greater than 0"),
        ("mass: .nan", "mass: must be a finite number"),
        ("mass: .inf", "mass: must be a finite number"),
        (f"mass: 1{'0' * 99}", "mass: an integer of many digits is out of range"),
        ("length: 1.0e+160", "length: 1e+160 is out of range: numbers are 0 or 1e-30 to 1e+20"),
        ("hull: {c_d: 1.0e-320}", "hull.c_d: 9.99989e-321 is out of range"),
        (
            "thrusters: {bs: {propeller: {diameter: 1.0e+80}}}",
            "thrusters.bs.propeller.diameter: 1e+80 is out of range",
        ),
        (
            "thruster_model: {foil: {area: 0, aspect_ratio: 1}}",
            "thrusters.bs.foil.area: must be greater than 0",
        ),
        ("thruster_model: {foil: {area: 0.01}}", "thrusters.bs.foil.aspect_ratio: is missing; add it"),
        (
            "thruster_model: {foil: {area: 0.01, aspect_ratio: 1, stall_angle: 20}}",
            "thrusters.bs.foil.stall_angle: must be at most 1.5",
        ),
        (f"mass: 1{'0' * 400}", "a number of more than 100 characters"),
        ("mass: '48'", "mass: must be a number, not '48'"),
        ("mass: true", "mass: must be a number"),
        ("mass: [48]", "mass: must be a number"),
        ("mass:", "mass: is missing; add it"),
        ("mass: 400", "mass: 400 kg is implausible: mass / (water_density length breadth draught) is 2.04"),
        ("name: 3", "name: must be text"),
        ('name: "two\\nlines"', "name: 'two lines' must print on one line"),
        ("draught: 0.03", "hull.c_d: the regression 'yoshimura' gives -0.595"),
        ("draught: -0.1", "draught: must be greater than 0"),
        ("x_g: 0.7", "x_g: 0.7 m is implausible: distance from midship / length is 0.565"),
        ("added_mass_sway: 23.2", "added_mass_sway: must be at most 0"),
        ("hull: {c_d: yoshi}", "hull.c_d: must be a number, not 'yoshi'"),
        ("hull: 3", "hull: must be a mapping of keys"),
        ("hull: {2: 3}", "hull.2: "),
        (
            "thrust_deduction: {throttle_low: 0, factor_low: 1.2, throttle_high: 1, factor_high: 1}",
            "thrust_deduction.factor_low: must be at most",
        ),
        (
            "thrust_deduction: {throttle_low: 0.3, factor_low: 1, throttle_high: 0.2, factor_high: 1}",
            "thrust_deduction: throttle_low must be below throttle_high",
        ),
        ("current: {model: dnv}", "current.model: must be 'relative' or 'dnv_force', not 'dnv'"),
        ("joypad: {thrusters: [bs, aft]}", "joypad.thrusters must be different names out of bs, bp, ss, sp"),
        ("joypad: {thrusters: [bs, bs]}", "joypad.thrusters must be different names out of bs, bp, ss, sp"),
        ("joypad: {throttle: [0.0, 100.0]}", "joypad: throttle must be [low, high] within [-1, 1]"),
        ("joypad: {azimuth: [-90.0, 90.0]}", "joypad: azimuth must be [low, high] in radians"),
        ("joypad: {azimuth: [1.0]}", "joypad.azimuth.1: is missing"),
        ("thruster_model: 3", "thruster_model must be a mapping"),
        (
            "thruster_model: {azimuth_time_constant: -0.1}",
            "thrusters.bs.azimuth_time_constant: must be",
        ),
        (
            "thruster_model: {azimuth_min: 1.0, azimuth_max: 0.5}",
            "thrusters.bs: azimuth_min must be below azimuth_max",
        ),
        ("thruster_model: {azimuth_max: 3.0}", "thrusters.bs: has one of azimuth_min and azimuth_max"),
        ("thruster_model: {azimuth_rate: 0}", "thrusters.bs.azimuth_rate: must be greater than 0"),
        (
            "thruster_model: {thrust_quadratic: 0}",
            "thrusters.bs: thrust_linear and thrust_quadratic are both 0",
        ),
        ("thruster_model: {kind: fixed}", "thrusters.bs: a fixed thruster pushes one way"),
        ("thrusters: 3", "thrusters: must be a list"),
        ("thrusters: []", "thrusters: must have 1 or more entries"),
        ("thrusters: [3]", "thrusters.0: must be a mapping of keys"),
        ("thrusters: [{x: 0.1}]", "thrusters.0.name: is missing"),
        ("thrusters: {ss: {azimuth_max: 90}}", "thrusters.ss.azimuth_max: must be at most 6.28319"),
        (
            "thrusters: [{name: ss, x: 0, y: 0}, {name: ss, x: 1, y: 0}]",
            "thruster names must differ, but are ss, ss",
        ),
        ("thrusters: {ss: {x: -350}}", "thrusters.ss.x: -350 m is implausible"),
        ("thrusters: {tunnel: {x: 0.3}}", "thrusters.tunnel.y: is missing"),
        ("thrusters: {all: {x: 0.3, y: 0.0}}", "thrusters.all: a thruster cannot be named 'all'"),
        ("thrusters: {a b: {x: 0.3, y: 0.0}}", "thrusters.a b.name: "),
        ("resistance: {table: []}", "resistance.table: must have 1 or more entries"),
        (
            "resistance: {table: [{h_over_t: 2, speed: [1, 2], resistance: [1]}]}",
            "resistance.table.0: needs two or more speeds and as many resistances",
        ),
        (
            "resistance: {table: [{h_over_t: 2, speed: [1, 1], resistance: [1, 2]}]}",
            "resistance.table.0: the speeds must increase",
        ),
        (
            "resistance: {table: [{h_over_t: 2, speed: [1, 2], resistance: [1, 2]}, "
            "{h_over_t: 2, speed: [1, 2], resistance: [1, 2]}]}",
            "resistance.table: h_over_t must increase",
        ),
        ("effects: 3", "effects must be a list"),
        ("effects: [{effect: curent}]", "effects[0]: unknown effect 'curent'; did you mean 'current'?"),
        ("effects: [{effect: shallow_water, depth_over_draught: 1.4}]", "the towing-tank tests end at 1.5"),
        ("extends: [swamp]", "extends must be the name or the path"),
        ("extends: swmp", "did you mean 'swamp'?"),
        ("extends: ./nowhere.yaml", "no such file"),
        ("extends: broken.yaml", "extends forms a cycle"),
    ],
)
def test_an_impossible_value_is_refused_by_key(tmp_path: Path, line: str, message: str) -> None:
    text = line if line.startswith("extends") else f"extends: swamp\n{line}\n"
    assert message in refused(tmp_path, text)


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        (
            "{value: 50, unit: lb, provenance: measured, source: scales}",
            "unit 'lb', allowed is 'kg' (1 lb is 0.45359237 kg)",
        ),
        ("{value: 50, unit: A, provenance: measured, source: scales}", "unit 'A', allowed is 'kg'; write"),
        (
            "{value: 50, unit: kg, provenance: guessed, source: scales}",
            "allowed are measured, fitted, assumed",
        ),
        ("{value: 50, unit: kg, provenance: measured, source: ''}", "empty source"),
        ("{value: 50, unit: kg, source: scales}", "lacks provenance"),
        ("{value: 50}", "lacks unit"),
        ("{value: 50, unit: kg, provenance: measured, source: scales, date: 2020}", "unknown key 'date'"),
        ("{vaule: 50, unit: kg, provenance: measured, source: scales}", "lacks value"),
    ],
)
def test_a_number_with_half_its_provenance_is_refused(tmp_path: Path, quantity: str, message: str) -> None:
    assert message in refused(tmp_path, f"extends: swamp\nmass: {quantity}\n")


def test_a_capacity_in_ampere_hours_is_refused_with_what_one_is_in_coulombs(tmp_path: Path) -> None:
    capacity = "{value: 13, unit: Ah, provenance: measured, source: its label}"
    message = refused(tmp_path, f"extends: swamp\nbattery: {{capacity: {capacity}}}\n")
    assert "battery.capacity: the number has unit 'Ah', allowed is 'C' (1 Ah is 3600 C); write" in message


@pytest.mark.parametrize("sd", ["-1.0", ".nan", "wide", "[1.0]", "true"])
def test_a_standard_deviation_that_is_none_is_refused(tmp_path: Path, sd: str) -> None:
    quantity = f"{{value: 50, unit: kg, provenance: assumed, source: scales, sd: {sd}}}"
    assert "has an sd that is not a number" in refused(tmp_path, f"extends: swamp\nmass: {quantity}\n")


def test_a_key_that_is_left_out_is_named(tmp_path: Path) -> None:
    lines = find_config("boats", "swamp").read_text().splitlines()
    text = "\n".join(line for line in lines if not line.startswith("breadth"))
    assert ": breadth: is missing" in refused(tmp_path, text)


def test_a_fault_is_laid_to_the_file_of_the_chain_that_holds_it(tmp_path: Path) -> None:
    (tmp_path / "middle.yaml").write_text("extends: swamp\nmass: -1\n")
    (tmp_path / "top.yaml").write_text("extends: middle.yaml\ndraught: 0.12\n")
    with pytest.raises(UserError, match=r"middle\.yaml: mass"):
        load_boat(tmp_path / "top.yaml")


SECTIONS = {"": Boat, "hull": Hull, "wind": Wind, "joypad": Joypad, "thruster_model": Thruster}


@given(
    section=st.sampled_from(sorted(SECTIONS)),
    key=st.from_regex(r"[a-z][a-z_]{0,12}", fullmatch=True),
)
def test_an_unknown_key_is_always_named_with_its_file(
    tmp_path_factory: pytest.TempPathFactory, section: str, key: str
) -> None:
    also_known = {"extends", "effects", "thruster_model", "value", "unit", "provenance", "source"}
    if key in also_known | set(SECTIONS[section].model_fields):
        return
    path = tmp_path_factory.mktemp("boats") / "broken.yaml"
    entry = f"'{key}': 1.0"
    path.write_text("extends: swamp\n" + (f"{section}: {{{entry}}}\n" if section else f"{entry}\n"))
    with pytest.raises(UserError) as error:
        load_boat(path)
    place = {"": "", "thruster_model": "thrusters.bs."}.get(section, f"{section}.")
    assert str(error.value).startswith(f"{path}: {place}{key}: unknown key")
