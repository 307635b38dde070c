"""Estimates of a boat's numbers against published figures, and the boats that are made of them."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import load_boat
from swamp_rl.boat.estimate import KINDS, Kind, annotated, boat_file
from swamp_rl.boat.estimate_drive import loss_at_speed, speed_of_thrust
from swamp_rl.boat.estimate_hull import (
    added_masses,
    cross_flow_drag,
    draught_of,
    ellipsoid_shares,
    hull_derivatives,
)
from swamp_rl.boat.quantity import units
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, YAW_RATE
from tests.support.new_boats import GRAVITY, SIZES, file_of, new_boat, sailed

LAMB = [  # Hydrodynamics, article 115: a/b, k_1 ahead, k_2 abeam, k' in rotation
    (1.5, 0.305, 0.621, 0.094),
    (2.0, 0.209, 0.702, 0.240),
    (2.51, 0.156, 0.763, 0.367),
    (2.99, 0.122, 0.803, 0.465),
    (3.99, 0.082, 0.860, 0.608),
    (4.99, 0.059, 0.895, 0.701),
    (6.01, 0.045, 0.918, 0.764),
    (9.97, 0.021, 0.960, 0.883),
]


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers of every size between two."""
    return st.floats(math.log10(low), math.log10(high)).map(lambda power: 10.0**power)


@pytest.mark.parametrize("kind", KINDS)
@given(
    length=decades(0.3, 20.0),
    breadth=decades(0.02, 3.0),
    depth=decades(0.003, 1.0),
    block=decades(0.01, 5.0),
    thrust=decades(1e-5, 10.0),
    froude=st.none() | decades(1e-4, 5.0),
    floats=st.booleans(),
)
def test_any_particulars_give_a_boat_that_loads_or_one_line(
    kind: Kind,
    length: float,
    breadth: float,
    depth: float,
    block: float,
    thrust: float,
    froude: float | None,
    floats: bool,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    mass = block * 1025.0 * length**3 * breadth * depth
    speed = None if froude is None else froude * math.sqrt(GRAVITY * length)
    draught = None if floats else depth * length
    path = tmp_path_factory.getbasetemp() / f"{kind}.yaml"
    try:
        content = boat_file(
            "any", kind, length, breadth * length, mass, thrust * mass * GRAVITY, speed, draught
        )
        path.write_text(annotated(content, "a test"), encoding="utf-8")
        parameters(load_boat(path))
    except UserError as error:
        assert all(
            line.startswith((f"{path}: ", "boat any: ", "these sizes: ", "--"))
            for line in str(error).splitlines()
        )


@pytest.mark.parametrize("row", LAMB, ids=lambda row: f"a/b={row[0]}")
def test_added_masses_of_spheroids_are_those_of_lambs_table(row: tuple[float, ...]) -> None:
    assert ellipsoid_shares(row[0], 1.0, 1.0) == pytest.approx(row[1:], abs=0.0025)


def test_a_sphere_takes_half_its_water_along_and_none_in_rotation() -> None:
    assert ellipsoid_shares(1.0, 1.0, 1.0) == pytest.approx((0.5, 0.5, 0.0))


def test_a_long_cylinder_takes_all_its_water_along_abeam() -> None:
    assert ellipsoid_shares(1e3, 1.0, 1.0)[1] == pytest.approx(1.0, abs=1e-3)


def test_added_masses_are_shares_of_the_displaced_water() -> None:
    surge, sway, yaw = added_masses(100.0, 8.0, 2.0, 1.0)
    k = ellipsoid_shares(4.0, 1.0, 1.0)
    assert (surge, sway, yaw) == pytest.approx((100.0 * k[0], 100.0 * k[1], 340.0 * k[2]))


def test_hull_derivatives_of_a_demihull_are_those_that_the_thesis_prints() -> None:
    found = hull_derivatives(1.24, 0.24, 0.14, 29.0 / (1025.0 * 1.24 * 0.24 * 0.14))
    printed = {"y_v": -0.54, "y_r": 0.066, "n_v": -0.226, "x_vr": 0.168}  # thesis 8.1.3
    assert {name: found[name] for name in printed} == pytest.approx(printed, abs=0.006)
    assert found["n_r"] == pytest.approx(-0.135 / 0.95 / 2.0, rel=0.01)  # twice Kijima's, less 5 %


def test_hull_derivatives_of_a_tanker_are_near_those_of_its_captive_tests() -> None:
    osaka = load_boat("esso_osaka")
    found = hull_derivatives(osaka.length, osaka.breadth, osaka.draught, 0.83)
    for name in ("y_v", "y_r", "n_v", "n_r"):
        assert found[name] == pytest.approx(getattr(osaka.hull, name), rel=0.15), name


def test_cross_flow_drag_is_hoerners_curve_and_constant_beyond_it() -> None:
    assert cross_flow_drag(2.0, 1.0) == pytest.approx(0.826, abs=0.005)
    assert cross_flow_drag(100.0, 1.0) == pytest.approx(0.5593)
    assert cross_flow_drag(0.001, 1.0) == pytest.approx(1.9661)


def test_the_speed_of_a_thrust_is_that_of_swamps_tank() -> None:
    # 40.3 N at 1.49 m/s in the deepest water, of the model as towed (thesis table 4.7)
    assert speed_of_thrust(1.24, 58.0, 40.3) == pytest.approx(1.49, rel=0.05)


def test_a_boat_floats_on_the_water_that_it_displaces() -> None:
    draught = draught_of(1025.0, 4.0, 2.0, 1025.0, block=0.5)
    assert 0.5 * 4.0 * 2.0 * draught == pytest.approx(1.0)


def dimensionless(content: dict, ratio: float) -> dict[str, float]:
    """The numbers of a boat file, each divided by what Froude's law makes of its unit at that ratio."""
    powers = {"m": 1.0, "m2": 2.0, "kg": 3.0, "kg m2": 5.0, "N": 3.0, "s": 0.5, "rad/s": -0.5, "rps": -0.5}
    found = {}

    def walk(part: object, at: str) -> None:
        if isinstance(part, dict) and "unit" in part:
            value = np.atleast_1d(part["value"]) / ratio ** powers.get(part["unit"], 0.0)
            found.update({f"{at}.{i}": one for i, one in enumerate(value.tolist())})
        elif isinstance(part, dict):
            for key, inner in part.items():
                walk(inner, f"{at}.{key}")
        elif isinstance(part, list):
            for index, inner in enumerate(part):
                walk(inner, f"{at}.{index}")

    walk(content, "")
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_a_boat_enlarged_keeps_every_number_without_dimension(kind: Kind) -> None:
    small = boat_file("a", kind, 1.2, 0.5, 30.0, 40.0)
    large = boat_file("a", kind, 12.0, 5.0, 30e3, 40e3)
    assert dimensionless(large, 10.0) == pytest.approx(dimensionless(small, 1.0), rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("length", SIZES)
def test_every_kind_and_size_reaches_its_speed_and_turns_the_way_it_steers(
    tmp_path: Path, kind: Kind, length: float
) -> None:
    boat = new_boat(tmp_path, kind, length)
    parameters(boat)  # refuses what diverges
    froude = reference_of(boat).speed / math.sqrt(GRAVITY * length)
    assert 0.15 < froude < 0.7
    starboard, port = sailed(boat, 0.3), sailed(boat, -0.3)
    assert np.isfinite(starboard).all()
    assert starboard[10, HEADING] > 0.0
    assert starboard[-1, YAW_RATE] > 0.0
    assert starboard[-1, SURGE] > 0.0
    assert port[:, NORTH] == pytest.approx(starboard[:, NORTH], abs=1e-6 * length)
    assert port[:, EAST] == pytest.approx(-starboard[:, EAST], abs=1e-6 * length)


@pytest.mark.parametrize("kind", KINDS)
def test_the_top_speed_that_is_given_is_reached(tmp_path: Path, kind: Kind) -> None:
    assert reference_of(new_boat(tmp_path, kind, top_speed=2.0)).speed == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("kind", KINDS)
def test_without_a_thrust_it_is_that_of_the_top_speed(tmp_path: Path, kind: Kind) -> None:
    """The default top speed of a thrust gives the thrust back, with a wider prior."""
    length, mass, thrust = 1.2, 35.0, 12.0
    loss = loss_at_speed(kind)
    speed = speed_of_thrust(length, mass, (1.0 - loss) * thrust)
    boat = new_boat(tmp_path, kind, length, mass=mass, thrust=None, top_speed=speed)
    assert reference_of(boat).thrust == pytest.approx(thrust, rel=0.01)
    assert reference_of(boat).speed == pytest.approx(speed, rel=0.01)

    def prior(**pull: float | None) -> float:
        content = boat_file("a", kind, length, 0.48, mass, top_speed=speed, **pull)["thrusters"][0]
        number = content["revolutions_max" if "revolutions_max" in content else "thrust_quadratic"]
        return float(number["sd"] / number["value"])

    assert prior(thrust=None) == pytest.approx(2.5 * prior(thrust=thrust))


def test_a_boat_of_neither_thrust_nor_top_speed_is_refused() -> None:
    with pytest.raises(UserError, match=r"--thrust: give the total bollard pull \[N\], or --top-speed"):
        boat_file("a", "azimuth", 1.2, 0.5, 30.0, None)


@pytest.mark.parametrize("kind", KINDS)
def test_the_thrust_at_rest_is_the_one_given(tmp_path: Path, kind: Kind) -> None:
    assert reference_of(new_boat(tmp_path, kind, thrust=33.0)).thrust == pytest.approx(33.0, rel=0.01)


SCREWS = [  # length, breadth [m], mass [kg], thrust [N], top speed [m/s]; diameters [m] and revolutions [rps]
    ((0.5, 0.16, 0.8, 2.0, None), (0.02, 0.04), (80.0, 350.0)),
    ((0.7, 0.3, 1.8, 2.0, None), (0.025, 0.05), (80.0, 350.0)),
    ((0.7, 0.3, 1.8, 4.0, None), (0.025, 0.05), (80.0, 350.0)),
    ((1.0, 0.3, 5.0, 20.0, None), (0.03, 0.06), (80.0, 350.0)),
    ((3.0, 0.49, 245.0, 20.0, None), (0.08, 0.16), (10.0, 30.0)),
    ((5.0, 2.0, 800.0, 2500.0, None), (0.25, 0.4), (20.0, 60.0)),
    ((10.0, 3.0, 6000.0, 8000.0, None), (0.4, 0.7), (10.0, 40.0)),
    ((30.0, 9.0, 6e5, 3e5, 6.5), (2.0, 3.0), (3.0, 7.0)),
]
"""Of model boats, a ship model (that of the Esso Osaka: 3 m, 0.084 m), a workboat, a launch and a tug."""


@pytest.mark.parametrize(("sizes", "diameters", "rates"), SCREWS)
def test_a_propeller_has_the_size_of_those_of_such_boats(
    sizes: tuple[float, float, float, float, float | None],
    diameters: tuple[float, float],
    rates: tuple[float, float],
    tmp_path: Path,
) -> None:
    content = boat_file("new", "propeller-rudder", *sizes)
    (main,) = content["thrusters"]
    assert diameters[0] < main["propeller"]["diameter"]["value"] < diameters[1]
    assert rates[0] < main["revolutions_max"]["value"] < rates[1]
    path = tmp_path / "boat.yaml"
    path.write_text(annotated(content, "a test"), encoding="utf-8")
    parameters(load_boat(path))


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_of_a_new_file_is_assumed_with_its_source(tmp_path: Path, kind: Kind) -> None:
    boat = new_boat(tmp_path, kind)
    untold = {".".join(key) for key, _ in units(boat)} - set(boat.provenance)
    assert {key.rpartition(".")[2] for key in untold} <= {
        "azimuth_offset",
        "azimuth_time_constant",
        "azimuth",
    }
    assert all(origin.provenance == "assumed" for origin in boat.provenance.values())
    assert not any(origin.source.startswith("set in") for origin in boat.provenance.values())
    for key in ("mass", "hull.n_r", "resistance.x_0_ahead", "added_mass_sway"):
        sd = boat.provenance[key].sd
        assert isinstance(sd, float) and sd > 0.0


def test_the_text_of_a_file_explains_each_number_and_reads_back(tmp_path: Path) -> None:
    path = file_of(tmp_path, "propeller-rudder")
    lines = path.read_text(encoding="utf-8").splitlines()
    assert all("#" in line for line in lines if "value:" in line)
    content = boat_file("new", "propeller-rudder", 1.2, 0.48, 20.5 * 1.2**3, 0.14 * 20.5 * 1.2**3 * GRAVITY)
    again, made = dimensionless(yaml.safe_load("\n".join(lines)), 1.0), dimensionless(content, 1.0)
    assert again == pytest.approx(made, rel=5e-4)


@pytest.mark.parametrize("word", ["length", "breadth", "mass", "thrust", "top_speed", "draught"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_size_that_is_none_is_refused_by_its_option(word: str, value: float) -> None:
    given = {"length": 1.2, "breadth": 0.5, "mass": 30.0, "thrust": 40.0} | {word: value}
    with pytest.raises(UserError, match=f"--{word.replace('_', '-')} .*above 0"):
        boat_file("a", "azimuth", **given)


def test_bare_numbers_count_as_assumed_and_sections_have_defaults(tmp_path: Path) -> None:
    content = yaml.safe_load(file_of(tmp_path, "twin-fixed").read_text(encoding="utf-8"))

    def bare(part: object) -> object:
        if isinstance(part, dict):
            return part["value"] if "unit" in part else {key: bare(inner) for key, inner in part.items()}
        return [bare(inner) for inner in part] if isinstance(part, list) else part

    whole = bare({key: part for key, part in content.items() if key not in ("wind", "current", "joypad")})
    assert isinstance(whole, dict)
    (tmp_path / "bare.yaml").write_text(yaml.safe_dump(whole | {"wind": {"c_x": 0.5}}), encoding="utf-8")
    boat, full = load_boat(tmp_path / "bare.yaml"), load_boat(tmp_path / "twin-fixed.yaml")
    for name in set(parameters(full).dtype.names) - {"air_c_x"}:
        assert parameters(boat)[0][name] == pytest.approx(parameters(full)[0][name], rel=1e-3), name
    assert boat.joypad == full.joypad
    assert (boat.wind.c_x, boat.wind.c_y) == (0.5, 0.9)
    result = boat.provenance
    assert (result["mass"].provenance, result["mass"].source) == ("assumed", "set in bare.yaml")
    assert result["wind.c_y"].source == "DNV-GL, as in configs/boats/swamp.yaml"


def test_a_dead_band_of_the_file_gives_no_thrust_below_it(tmp_path: Path) -> None:
    file_of(tmp_path, "twin-fixed")
    (tmp_path / "stiff.yaml").write_text(
        "extends: twin-fixed.yaml\nthrusters: {port: {dead_band: 0.2}, starboard: {dead_band: 0.2}}\n"
    )
    stiff, plain = load_boat(tmp_path / "stiff.yaml"), load_boat(tmp_path / "twin-fixed.yaml")
    assert sailed(stiff, 0.0, throttle=0.19)[-1, SURGE] == 0.0
    assert sailed(plain, 0.0, throttle=0.19)[-1, SURGE] > 0.0
    full = [sailed(boat, 0.0, throttle=1.0)[-1, SURGE] for boat in (stiff, plain)]
    assert full[0] == pytest.approx(full[1])
    assert tank(stiff).shape == (1, 6, 1)
