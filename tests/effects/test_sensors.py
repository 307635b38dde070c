"""What the sensors report with effects at work, against shifted and turned tracks."""

import numpy as np
import pytest

from swamp_rl.effects import parse_effects
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay
from swamp_rl.simulator.sensors import observe, rows_ahead, true_motion
from swamp_rl.simulator.state import EAST, HEADING, NORTH, SURGE, SWAY, YAW_RATE
from tests.support.effects import (
    BOAT,
    DT,
    NAMES,
    STRONG,
    lively,
    record,
    times,
    track,
)


def test_sensors_report_the_antenna_late_and_the_compass_off() -> None:
    run = track(lively())
    arm = observe(run[None], record({"effect": "position_lever_arm", "x": 0.3, "y": 0.2}), DT)[0]
    turned = (run[:, NORTH] + 1j * run[:, EAST]) + (0.3 + 0.2j) * np.exp(1j * run[:, HEADING])
    assert arm[:, 0] + 1j * arm[:, 1] == pytest.approx(turned, abs=1e-12)
    late = observe(run[None], record({"effect": "position_delay", "delay": 0.35}), DT)[0]
    assert late[10:, :2] == pytest.approx(0.5 * (run[6:-4, :2] + run[7:-3, :2])[: len(late) - 10], abs=1e-12)
    assert np.array_equal(late[:, 2:], run[:, 2:6])
    off = observe(run[None], record({"effect": "heading_bias", "bias": -0.1}), DT)[0]
    assert off[:, HEADING] == pytest.approx(run[:, HEADING] - 0.1, abs=1e-12)
    assert np.array_equal(observe(run[None], record(), DT)[0], run[:, :6])


def test_the_gyro_reads_off_and_the_heading_drifts_from_the_runs_start() -> None:
    run = track(lively())
    off = observe(run[None], record({"effect": "gyro_bias", "bias": 0.02}), DT)[0]
    assert off[:, YAW_RATE] == pytest.approx(run[:, YAW_RATE] + 0.02, abs=1e-15)
    assert np.array_equal(off[:, :YAW_RATE], run[:, :YAW_RATE])
    turning = observe(run[None], record({"effect": "heading_drift", "rate": 0.003}), DT)[0]
    assert turning[:, HEADING] == pytest.approx(run[:, HEADING] + 0.003 * times(run), abs=1e-12)
    part = observe(
        run[None, 50:, :6], record({"effect": "heading_drift", "rate": 0.003}), DT, np.array([5.0])
    )
    assert part[0] == pytest.approx(turning[50:], abs=1e-12)


@pytest.mark.parametrize("offset", [0.3, -0.3])
def test_a_clock_that_is_off_shifts_positions_and_speeds_either_way_and_nothing_else(offset: float) -> None:
    run, shift = track(lively()), round(offset / DT)
    seen = observe(run[None], record({"effect": "clock_offset", "offset": offset}), DT)[0]
    inside = slice(3, -3)
    moved = np.roll(run[:, :6], shift, axis=0)
    for channel in (NORTH, EAST, SURGE, SWAY):
        assert seen[inside, channel] == pytest.approx(moved[inside, channel], abs=1e-9)
    assert np.array_equal(seen[:, [HEADING, YAW_RATE]], run[:, [HEADING, YAW_RATE]])


def test_a_drifting_clock_is_off_by_its_rate_times_the_time() -> None:
    run = track(lively())
    seen = observe(run[None], record({"effect": "clock_drift", "rate": -0.02}), DT)[0]
    north = [float(np.interp(1.02 * t, times(run), run[:, NORTH])) for t in times(run)[:190]]
    assert seen[:190, NORTH] == pytest.approx(north, abs=1e-9)
    assert rows_ahead(record({"effect": "clock_drift", "rate": -0.02}), 20.0, DT) == 4
    assert rows_ahead(record({"effect": "clock_offset", "offset": 1.0}), 20.0, DT) == 0


def test_a_replay_of_a_record_with_a_late_clock_sails_on_to_its_end() -> None:
    shifted = BOAT.model_copy(
        update={"effects": parse_effects([{"effect": "clock_offset", "offset": -0.5}], "test", NAMES)}
    )
    columns = {"time": times(track(lively())), "north": np.zeros(201), "east": np.zeros(201)}
    columns |= {"heading": np.zeros(201)} | {name: np.zeros(201) for name in ("surge", "sway", "yaw_rate")}
    asked = np.vstack([lively(), lively()[-1:]])
    names = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in NAMES]
    columns |= dict(zip(names, asked.T, strict=True))
    early = replay(shifted, Run("run", columns)).columns["north"]
    longer = {name: np.append(values, np.repeat(values[-1], 5)) for name, values in columns.items()}
    longer["time"] = DT * np.arange(206)
    plain = replay(BOAT, Run("run", longer)).columns["north"]
    assert early == pytest.approx(plain[5:], abs=1e-9)


def test_the_motion_behind_a_first_measurement_is_found_again() -> None:
    run = track(lively(), velocity=(0.5, 0.1, 0.2))
    names = (
        "position_lever_arm",
        "heading_bias",
        "heading_drift",
        "gyro_bias",
        "clock_offset",
        "clock_drift",
    )
    params = record(*({"effect": name} | STRONG[name] for name in names))
    straight = run[:1].repeat(30, axis=0)
    cos, sin = np.cos(run[0, HEADING]), np.sin(run[0, HEADING])
    ahead = DT * np.arange(30)[:, None] * [0.5 * cos - 0.1 * sin, 0.5 * sin + 0.1 * cos]
    straight[:, :2] += ahead
    for of_earth in (False, True):
        measured = observe(straight[None, :, :6], params, DT, np.array([7.0]), np.array([of_earth]))[0, :1]
        assert true_motion(measured, params, 7.0, of_earth) == pytest.approx(run[:1, :6], abs=1e-9)


def test_velocities_in_axes_of_the_earth_are_turned_by_the_measured_heading() -> None:
    run = track(lively(), velocity=(0.5, 0.1, 0.2))[None]
    off = {"effect": "heading_bias", "bias": 0.1}
    plain, biased = observe(run, record(), DT)[0], observe(run, record(off), DT, None, np.array([True]))[0]

    def north_and_east(seen: np.ndarray) -> np.ndarray:
        return (seen[:, SURGE] + 1j * seen[:, SWAY]) * np.exp(1j * seen[:, HEADING])

    assert north_and_east(biased) == pytest.approx(north_and_east(plain), abs=1e-12)
    assert np.abs(biased[:, SWAY] - plain[:, SWAY]).max() > 0.02
