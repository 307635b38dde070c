"""Azimuths of a log, as a boat's thrusters obey them."""

import math

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.logs.azimuths import with_nearest_azimuths
from swamp_rl.runs.check import check_column
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.table import Table


def swamp(**limits: float) -> Boat:
    boat = load_boat("swamp-light")
    return boat.model_copy(
        update={"thrusters": tuple(one.model_copy(update=limits) for one in boat.thrusters)}
    )


def given(degrees: list[float], boat: Boat) -> tuple[np.ndarray, Foreign]:
    column = boat.thrusters[0].command_columns[0]
    table = Table({column: np.radians(degrees)}, np.arange(len(degrees)), {})
    found = with_nearest_azimuths(Foreign("log.csv", "log", table), boat)
    return np.degrees(found.table.columns[column]), found


def test_a_thruster_without_limits_turns_the_shorter_way() -> None:
    turned, found = given(
        [350.0, 5.0, 20.0, 340.0, 200.0], swamp(azimuth_min=-math.inf, azimuth_max=math.inf)
    )
    assert turned == pytest.approx([350.0, 365.0, 380.0, 340.0, 200.0])
    assert "nearest equivalent angle" in (found.meta.model_extra or {})["azimuths"]


def test_a_log_that_counts_turns_and_missing_values_stay_as_they_are() -> None:
    boat = swamp(azimuth_min=-math.inf, azimuth_max=math.inf)
    counted, found = given([-350.0, 170.0, 10.0, 30.0], boat)
    assert counted == pytest.approx([-350.0, 170.0, 10.0, 30.0])
    assert not found.meta.model_extra
    gap, _ = given([350.0, math.nan, 5.0], boat)
    assert gap == pytest.approx([350.0, math.nan, 365.0], nan_ok=True)


def test_an_angle_outside_the_limits_is_the_equivalent_one_within_them() -> None:
    within, _ = given([330.0, 30.0, -120.0, 100.0], swamp(azimuth_min=-math.pi / 4, azimuth_max=math.pi / 4))
    assert within == pytest.approx([-30.0, 30.0, -120.0, 100.0])  # the last two: none within


@pytest.mark.parametrize(("limit", "factor"), [(0.6, "0.6"), (math.inf, "3.142")])
def test_a_pulse_width_is_no_angle_and_reported_as_such(limit: float, factor: str) -> None:
    boat = swamp(azimuth_min=-limit, azimuth_max=limit)
    pulses = [1500.0, 1508.0, 1708.0, 1320.0]  # 1508 rad are 240 turns
    stays, found = given(np.degrees(pulses).tolist(), boat)
    assert np.radians(stays) == pytest.approx(pulses)
    column = str(boat.thrusters[0].command_columns[0])
    (fault,) = check_column("log.csv", column, found.table, boat)
    assert (fault.row, fault.last) == (0, 3)
    assert f"looks like a pulse width in us, map it to the range, as in (pwm - 1500) / 400 * {factor}" in str(
        fault
    )
