"""Numbers that no boat of a size has are refused by name, whatever the size."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters
from tests.support.from_scratch import BOATS, number, written


def refused(path: Path) -> list[str]:
    with pytest.raises(UserError) as error:
        parameters(load_boat(path))
    return str(error.value).splitlines()


@pytest.mark.parametrize("name", BOATS)
@pytest.mark.parametrize("times", [100.0, 0.01])
@pytest.mark.parametrize("key", ["draught", "mass", "inertia_z"])
def test_a_slipped_decimal_point_is_named_at_any_size(
    tmp_path: Path, name: str, key: str, times: float
) -> None:
    given = BOATS[name][key]
    path = written(tmp_path, name, **{key: number(times * given["value"], given["unit"])})
    message = refused(path)
    assert any(
        line.startswith(f"{path}: {key}: {times * given['value']:.6g} {given['unit']} is") for line in message
    )


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("draught: 140", "draught: 140 m is implausible: draught / length is 113"),
        (
            "thrusters: {bs: {x: 12.4}}",
            "thrusters.bs.x: 12.4 m is implausible: distance from midship / length is 10",
        ),
        (
            "thrusters: {bs: {thrust_quadratic: 30000}}",
            "thrusters.bs.thrust_quadratic: 30000 N is implausible",
        ),
        ("thruster_model: {azimuth_rate: 492}", "thrusters.bs.azimuth_rate: 492 rad/s is implausible"),
        ("thruster_model: {nozzle_area: 900}", "thrusters.bs.nozzle_area: 900 m2 is implausible"),
        (
            "thruster_model: {foil: {area: 3, aspect_ratio: 1.5}}",
            "thrusters.bs.foil.area: 3 m2 is implausible: area / (length draught) is 17.3",
        ),
        ("wind: {lateral_area: 4200}", "wind.lateral_area: 4200 m2 is implausible"),
        ("resistance: {reference_mass: 58000}", "resistance.reference_mass: 58000 kg is implausible"),
        ("hull: {c_d: 11}", "hull.c_d: 11 is implausible: its magnitude is 11"),
        ("water_density: 1.025", "water_density: 1.025 kg/m3 is implausible"),
        ("added_inertia_yaw: -3940", "added_inertia_yaw: -3940 kg m2 is implausible"),
    ],
)
def test_a_wrong_unit_is_reported_with_what_it_was_set_against(
    tmp_path: Path, line: str, message: str
) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(f"extends: swamp\n{line}\n")
    lines = refused(path)
    assert message in lines[0]
    assert all("check these numbers and their units" in line for line in lines)


def test_all_faults_of_a_file_are_reported_each_on_its_line(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(
        "extends: swamp\nlenth: 3\nmass: null\nthruster_model: {azimuth_rate: -1}\nhull: {x_vr: a}\n"
        "draught: {value: 14, unit: cm, provenance: measured, source: ruler}\n"
    )
    listed = [line.removeprefix(f"{path}: ") for line in refused(path)]
    begins = [
        "lenth: unknown",
        "mass: is missing",
        "draught: the number has unit 'cm'",
        "hull.x_vr: must be a number",
    ]
    begins.append("thrusters.bs.azimuth_rate: must be greater than 0, not -1 (and bp, ss, sp alike)")
    assert len(listed) == len(begins)
    assert all(any(line.startswith(begin) for line in listed) for begin in begins)


def unstable(section: str, **changes: float) -> dict[str, Any]:
    return {section: BOATS["twin"][section] | {key: number(value, "1") for key, value in changes.items()}}


def test_a_motion_that_runs_away_is_refused_by_the_axis_and_its_numbers(tmp_path: Path) -> None:
    (line,) = refused(written(tmp_path, "twin", **unstable("hull", n_r=9.0)))
    assert "boat twin: simulated from 1.57 m/s, its motion diverges" in line
    assert "yaw first; check hull.n_v, hull.n_r" in line


def test_a_boat_that_outruns_the_simulators_steps_is_refused(tmp_path: Path) -> None:
    light = {
        "mass": number(1.3, "kg"),
        "added_mass_sway": number(0.0, "kg"),
        "inertia_z": number(0.03, "kg m2"),
    }
    (line,) = refused(written(tmp_path, "twin", **light, **unstable("hull", c_d=10.0, n_r=-9.0)))
    assert "boat twin: simulated from 1.57 m/s" in line


def test_a_lag_of_a_millisecond_is_followed_exactly(tmp_path: Path) -> None:
    path = tmp_path / "quick.yaml"
    path.write_text(
        "extends: swamp\nthruster_model: {azimuth_time_constant: 0.001, pump_time_constant: 0.001}\n"
    )
    assert np.isfinite(parameters(load_boat(path))["mass"]).all()
