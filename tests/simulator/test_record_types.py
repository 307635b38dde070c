"""The types of parameter records, for each of which the step of a boat is compiled once: few of them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import KINDS
from swamp_rl.physics.screw import thrust_at
from swamp_rl.simulator.parameters import file_record
from tests.support.new_boats import new_boat

NO_CURVE = dict.fromkeys(
    ("thrust_linear", "thrust_quadratic", "astern_linear", "astern_quadratic", "advance_loss", "power"), None
)
LINEAR = {"kind": "linear", "bollard_coefficient": 0.45, "null_advance": 1.05}
SERIES = {"kind": "four_quadrant", "cosines": [0.01, 0.2, 0.0], "sines": [0.0, -0.75, 0.02]}


def propeller(model: dict[str, Any]) -> dict[str, Any]:
    return {"propeller": {"diameter": 0.08, "revolutions_max": 25.0, "open_water": model}}


def table(throttles: int, speeds: int = 2) -> dict[str, Any]:
    """A table of a thruster that loses thrust with speed, and pushes by the square of the throttle."""
    levels = np.linspace(0.0, 1.0, throttles)[1:].tolist()
    rows = [{"throttle": p, "thrust": [(10.0 - x) * p * p for x in range(speeds)]} for p in levels]
    return {"thrust_table": {"speed": [float(x) for x in range(speeds)], "rows": rows}}


def swamp_with(**thrust: Any) -> Boat:
    return load_boat("swamp", {"thruster_model": {**NO_CURVE, **thrust}})


def fitted_out(*names: str) -> Boat:
    """SWAMP's hull with a stern thruster of a table and a bow jet, in the order of `names`."""
    ahead = {"kind": "fixed", "azimuth_min": 0.0, "azimuth_max": 0.0, "y": 0.0, "pump_time_constant": 0.1}
    of = {"stern": {"x": -0.5, **table(4)}, "bow": {"x": 0.5, "thrust_quadratic": 6.0}}
    thrusters = [{"name": name, **ahead, **of[name]} for name in names]
    keys = {"thruster_model": None, "thrusters": thrusters, "joypad": {"thrusters": ["stern"]}}
    return load_boat("swamp", {**keys, "battery": None})


@pytest.mark.parametrize(
    "thrust",
    [propeller(SERIES), {**propeller(LINEAR), "throttle_rate": 0.5}, table(2), table(5, 3)],
    ids=["series", "rate", "short table", "table"],
)
def test_propellers_of_any_model_and_tables_of_usual_length_share_one_record_type(
    thrust: dict[str, Any],
) -> None:
    assert file_record(swamp_with(**thrust)).dtype is file_record(swamp_with(**propeller(LINEAR))).dtype


def test_only_a_boat_with_a_foil_has_the_fields_of_one() -> None:
    foil = {"area": 0.01, "aspect_ratio": 1.5}
    plain, foiled = load_boat("swamp"), load_boat("swamp", {"thrusters": {"bs": {"foil": foil}}})
    added = set(file_record(foiled).dtype.names or ()) - set(file_record(plain).dtype.names or ())
    assert added == {"foil_area", "foil_aspect_ratio", "foil_gamma", "foil_stall"}
    assert file_record(foiled)["foil_area"].tolist() == [[0.01, 0.0, 0.0, 0.0]]


def test_the_order_of_the_thrusters_makes_no_other_record_type() -> None:
    one, other = (file_record(fitted_out(*names)) for names in (("stern", "bow"), ("bow", "stern")))
    assert one.dtype is other.dtype
    assert one["drive"][0].tolist() == other["drive"][0, ::-1].tolist()


def test_longer_tables_share_the_next_wider_record_type() -> None:
    one, other, usual = (file_record(swamp_with(**table(throttles))).dtype for throttles in (8, 30, 7))
    assert one is other
    assert one != usual


def test_new_boats_with_as_many_thrusters_without_rudders_share_one_record_type(tmp_path: Path) -> None:
    boats = [new_boat(tmp_path, kind) for kind in KINDS if kind != "propeller-rudder"]
    types = {(len(boat.thrusters), file_record(boat).dtype) for boat in boats}
    assert sorted(count for count, _ in types) == [1, 2, 4]


@pytest.mark.parametrize("throttles", [3, 20])
def test_a_table_of_any_length_gives_the_thrust_of_its_own_points(throttles: int) -> None:
    record = file_record(swamp_with(**table(throttles, 3)))[0]
    levels = np.linspace(0.0, 1.0, throttles)
    for throttle in (0.0, 0.31, 0.77, 1.0):
        for speed in (0.0, 0.4, 2.0, 9.0):
            known = np.interp(throttle, levels, levels**2) * (10.0 - min(speed, 2.0))
            assert thrust_at(throttle, speed, 3, record) == pytest.approx(known, rel=1e-12)


def test_a_short_series_beside_a_longer_one_counts_its_own_orders_alone() -> None:
    longer = {"kind": "four_quadrant", "cosines": [0.2, *[0.01] * 19], "sines": [0.0, *[0.02] * 19]}
    beside = {"thruster_model": {**NO_CURVE, **propeller(SERIES)}, "thrusters": {"bp": propeller(longer)}}
    alone, mixed = file_record(swamp_with(**propeller(SERIES)))[0], file_record(load_boat("swamp", beside))[0]
    for speed in (-0.5, 0.0, 1.5):
        assert thrust_at(0.6, speed, 0, mixed) == thrust_at(0.6, speed, 0, alone)
        assert thrust_at(0.6, speed, 1, mixed) != thrust_at(0.6, speed, 0, mixed)
