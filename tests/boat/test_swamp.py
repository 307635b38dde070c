"""The shipped boat files against the thesis's own figures."""

import csv
import math
from pathlib import Path

import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.quantity import units

ROOT = Path(__file__).parents[2]
BOATS = sorted((ROOT / "configs" / "boats").glob("*.yaml"))
REFERENCE = ROOT.parent / "shared" / "reference"


@pytest.fixture(scope="module")
def swamp() -> Boat:
    return load_boat("swamp")


@pytest.mark.parametrize("path", BOATS, ids=lambda path: path.stem)
def test_every_shipped_boat_loads_under_its_own_name(path: Path) -> None:
    assert load_boat(path.stem).name == path.stem
    assert load_boat(path) == load_boat(path.stem)


@pytest.mark.parametrize("path", BOATS, ids=lambda path: path.stem)
def test_every_number_of_a_shipped_boat_says_where_it_comes_from(path: Path) -> None:
    boat = load_boat(path)
    numbers = {".".join(key): unit for key, unit in units(boat)}
    assert set(boat.provenance) == set(numbers)
    for key, unit in numbers.items():
        assert boat.provenance[key].unit == unit
        assert "set in" not in boat.provenance[key].source


def numbers_in(part: object) -> int:
    """How many finite numbers, or tuples of floats, a dumped model holds."""
    if isinstance(part, dict):
        return sum(numbers_in(value) for value in part.values())
    if isinstance(part, tuple | list):
        return 1 if part and isinstance(part[0], float) else sum(numbers_in(item) for item in part)
    number = isinstance(part, float | int) and not isinstance(part, bool)
    return int(number and math.isfinite(part))


def test_no_number_of_the_schema_lacks_a_unit(swamp: Boat) -> None:
    assert len(list(units(swamp))) == numbers_in(swamp.model_dump())


def test_swamp_has_the_particulars_of_8_1_3(swamp: Boat) -> None:
    masses = (swamp.mass, swamp.inertia_z, swamp.added_mass_surge, swamp.added_mass_sway)
    assert (*masses, swamp.added_inertia_yaw) == (58.0, 7.88, -2.9, -23.2, -3.94)
    # the thesis's rule: 5 % and 40 % of the mass, 50 % of the inertia
    assert swamp.added_mass_surge == pytest.approx(-0.05 * swamp.mass)
    assert swamp.added_mass_sway == pytest.approx(-0.40 * swamp.mass)
    assert swamp.added_inertia_yaw == pytest.approx(-0.50 * swamp.inertia_z)
    assert swamp.hull.c_d == pytest.approx(1.325, abs=5e-4)


def test_the_thrusters_stand_at_the_corners_they_are_named_after(swamp: Boat) -> None:
    assert swamp.thruster_names == ("bs", "bp", "ss", "sp")
    for thruster in swamp.thrusters:
        assert thruster.x == (0.35 if thruster.name[0] == "b" else -0.35)
        assert thruster.y == (0.40 if thruster.name[1] == "s" else -0.40)
        # 4840 RPM through a gear of 59 and one of 2: a turn is 4096 x 59 x 2 = 483,328 steps of the motor
        assert thruster.azimuth_rate == pytest.approx(4840 / 60 / 59 / 2 * 2 * math.pi, rel=1e-3)
        assert not thruster.reverses


def test_the_thrust_curve_is_that_of_table_5_5_to_its_last_digit(swamp: Boat) -> None:
    bs = swamp.thrusters[0]
    for rpm_percent, _, thrust in reference_rows("thrust_table.csv"):
        throttle = rpm_percent / 100
        assert bs.thrust_linear * throttle + bs.thrust_quadratic * throttle**2 == pytest.approx(
            thrust, abs=0.051
        )


def test_the_resistance_table_is_the_whole_of_table_4_7(swamp: Boat) -> None:
    tested = [(row[0], row[4], row[5]) for row in reference_rows("towing_tank.csv")]
    held = [
        (curve.h_over_t, speed, resistance)
        for curve in swamp.resistance.table
        for speed, resistance in zip(curve.speed, curve.resistance, strict=True)
    ]
    assert held == tested


def test_the_light_swamp_differs_in_mass_draught_and_what_follows_from_them(swamp: Boat) -> None:
    light = load_boat("swamp-light")
    assert (light.mass, light.draught) == (48.0, 0.115)
    assert light.added_mass_surge == pytest.approx(-0.05 * light.mass)
    assert light.added_mass_sway == pytest.approx(-0.40 * light.mass)
    assert light.added_inertia_yaw == pytest.approx(-0.50 * light.inertia_z)
    assert light.hull.c_d == pytest.approx(1.848 - 0.0591 * 1.24 / 0.115)
    assert light.thrusters == swamp.thrusters
    assert light.resistance == swamp.resistance
    assert light.provenance["mass"].source == "thesis 7.3.5"
    assert light.provenance["thrusters.bs.x"] == swamp.provenance["thrusters.bs.x"]


def reference_rows(name: str) -> list[list[float]]:
    if not (REFERENCE / name).is_file():
        pytest.skip(f"{name}, typed from the thesis, is not beside this checkout")
    lines = [line for line in (REFERENCE / name).read_text().splitlines() if not line.startswith("#")]
    return [[float(cell) for cell in row] for row in list(csv.reader(lines))[1:]]
