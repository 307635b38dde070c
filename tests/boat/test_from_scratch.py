"""Boats written from nothing, of every size, go through the whole chain as SWAMP does."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.runs import read_dataset, read_run
from swamp_rl.simulator import initial_state, parameters
from swamp_rl.simulator.state import ACTUATORS, HEADING
from tests.support.boats import track
from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture
from tests.support.from_scratch import BOATS, with_tunnel, written

SCALE = {
    "twin": 1.6,
    "ferry": 4.0,
    "large": 14.0,
    "toy": 1.0,
    "crossed": 1.6,
}  # of the course, so that a run lasts the 20 s of a diagnosis


def scaled_course(folder: Path, name: str) -> Path:
    """The course for a boat, written into the folder."""
    path = folder / "course.yaml"
    path.write_text(f"extends: camogli\nscale: {SCALE[name]}\n")
    return path


@pytest.mark.parametrize("name", ["twin", "toy", "large"])  # the ferry is between toy and large
def test_a_boat_from_scratch_is_recorded_simulated_tried_and_diagnosed(
    call: Call, tmp_path: Path, name: str
) -> None:
    length = load_boat(written(tmp_path, name)).length
    scaled_course(tmp_path, name)
    first = BOATS[name]["thrusters"][0]["name"]
    effect = f"{{effect: thruster_gain, thruster: {first}, gain: 0.7}}"
    (tmp_path / "worn.yaml").write_text(f"extends: {name}.yaml\neffects: [{effect}]\n")
    own = ["--boat", "worn.yaml"]

    asked = ["--course", "course.yaml", "--out", "runs", "--count", 1, "--failed", 0]
    assert call("record-scripted", *own, *asked)[0] == 0
    assert len(read_dataset("runs").successful) == 1

    path = next(Path("runs").glob("*.parquet"))
    assert call("simulate", *own, "--commands", path, "--out", "again.parquet")[0] == 0
    again, was = read_run("again.parquet").columns, read_run(path).columns
    assert np.hypot(again["north"] - was["north"], again["east"] - was["east"]).max() < 1e-3 * length

    asked = ["--angle", 30, "--throttle", 0.6, "--turns", 2, "--out", "trial"]
    assert call("trial", "turning-circle", "--boat", f"{name}.yaml", *asked)[0] == 0
    figures = json.loads(Path("trial/analysis/analysis.json").read_text())["runs"][0]["corrected"]
    assert 1.0 < figures["steady_diameter"]["value"] / length < 15.0

    assert call("diagnose", "runs", "--boat", f"{name}.yaml", "--out", "diagnosis")[0] == 0
    record = parameters(load_boat("diagnosis/extended_boat.yaml"))[0]
    assert record["thrust_scale"] * record["thruster_gain"][0] == pytest.approx(0.7, abs=0.02)


def test_twin_fixed_thrusters_push_ahead_and_turn_by_their_difference(tmp_path: Path) -> None:
    boat = load_boat(written(tmp_path, "twin"))
    both = np.tile([0.0, 0.0, 1.0, 1.0], (30, 1))
    port = np.tile([0.0, 0.0, 1.0, 0.0], (30, 1))
    ahead, turned = track(boat, both), track(boat, port)
    assert np.isfinite(ahead).all() and np.isfinite(turned).all()
    assert ahead[-1, 0] > 1.0 and abs(ahead[-1, HEADING]) < 1e-9
    assert turned[-1, HEADING] > 0.1  # the port one alone turns the bow to starboard


def test_a_fixed_thruster_stands_where_it_points_from_the_start(tmp_path: Path) -> None:
    path = written(tmp_path, "twin")
    tunnel = tmp_path / "tunnel.yaml"
    tunnel.write_text("extends: twin.yaml\nthrusters: {port: {azimuth_min: 1.5, azimuth_max: 1.5}}\n")
    assert path.is_file()
    start = initial_state(parameters(load_boat(tunnel)), np.zeros((1, 3)))
    assert start[0, ACTUATORS : ACTUATORS + 2].tolist() == [1.5, 0.0]


@pytest.mark.parametrize("name", BOATS)
@pytest.mark.parametrize("lever", [-1.0, 1.0])
def test_the_lever_to_starboard_turns_the_bow_to_starboard(tmp_path: Path, name: str, lever: float) -> None:
    env = GatesEnv(boat=written(tmp_path, name), course=scaled_course(tmp_path, name))
    env.reset(seed=0)
    before = env.fleet.pose[0, 2]
    for _ in range(15):
        env.step(np.array([0.6, lever], np.float32))
    assert lever * (env.fleet.pose[0, 2] - before) > 0.0


@pytest.mark.parametrize(
    ("throttle", "angle", "expected"),
    [
        (1.0, 0.0, (1, 1)),
        (1.0, 1.0, (1, 0)),
        (0.5, 0.25, (0.75, 0.25)),
        (0.0, -1.0, (-1, 1)),
        (0.0, 0.0, (0, 0)),
    ],
)
def test_the_levers_of_twin_fixed_thrusters_are_mixed_as_differential_thrust(
    tmp_path: Path, throttle: float, angle: float, expected: tuple[float, float]
) -> None:
    env = GatesEnv(boat=written(tmp_path, "twin"))
    env.reset(seed=0)
    env.step(np.array([throttle, angle], np.float32))
    assert env.fleet.commands[0, 2:] == pytest.approx(expected)


@pytest.mark.parametrize(("name", "degrees"), [("ferry", 60.0), ("toy", math.degrees(0.7))])
def test_a_joypad_without_an_azimuth_turns_its_thrusters_as_far_as_they_go_or_60_degrees(
    tmp_path: Path, name: str, degrees: float
) -> None:
    joypad = {key: value for key, value in BOATS[name]["joypad"].items() if key != "azimuth"}
    reach = load_boat(written(tmp_path, name, joypad=joypad)).joypad.azimuth
    assert reach == pytest.approx((-math.radians(degrees), math.radians(degrees)))


def test_the_levers_command_no_azimuth_beyond_the_limits_of_a_thruster(tmp_path: Path) -> None:
    joypad = BOATS["toy"]["joypad"] | {"azimuth": [-1.0, 1.0]}  # the thrusters turn by 0.7
    env = GatesEnv(boat=written(tmp_path, "toy", joypad=joypad))
    env.reset(seed=0)
    env.step(np.array([0.5, 1.0], np.float32))
    assert np.abs(env.fleet.commands[0, :2]) == pytest.approx([0.7, 0.7])


def test_a_tunnel_thruster_takes_the_angle_s_lever_alone(tmp_path: Path) -> None:
    env = GatesEnv(boat=with_tunnel(written(tmp_path, "twin"), ("port", "starboard", "tunnel")))
    env.reset(seed=0)
    env.step(np.array([0.6, 0.0], np.float32))
    assert env.fleet.commands[0, 3:] == pytest.approx([0.6, 0.6, 0.0])
    env.step(np.array([0.6, 0.3], np.float32))
    assert env.fleet.commands[0, 3:] == pytest.approx([0.9, 0.3, 0.3])


def test_a_course_is_laid_out_for_another_boat_by_its_scale(tmp_path: Path) -> None:
    (tmp_path / "wide.yaml").write_text("extends: camogli\nscale: 4\n")
    small, wide = load_course("camogli"), load_course(tmp_path / "wide.yaml")
    assert wide.name == "wide"
    assert wide.gates[1].centre.east == 4.0 * small.gates[1].centre.east
    assert (wide.buoy_radius, wide.bounds.north) == (4.0 * small.buoy_radius, 4.0 * small.bounds.north)
    assert wide.time_limit == pytest.approx(2.0 * small.time_limit)
    assert wide.start.spread.heading == small.start.spread.heading
    (tmp_path / "limit.yaml").write_text("extends: wide.yaml\ntime_limit: 7.0\n")
    assert load_course(tmp_path / "limit.yaml").time_limit == 7.0
    assert load_course(tmp_path / "limit.yaml").bounds == wide.bounds


@pytest.mark.parametrize("scale", ["0", "-1", ".inf", "big", "true"])
def test_a_scale_that_is_none_is_refused(tmp_path: Path, scale: str) -> None:
    (tmp_path / "odd.yaml").write_text(f"extends: camogli\nscale: {scale}\n")
    with pytest.raises(Exception, match=r"odd\.yaml: scale: must be a number above 0"):
        load_course(tmp_path / "odd.yaml")


@pytest.mark.parametrize("sensors", [[], [{"effect": "position_lever_arm", "x": 0.1}]])
def test_an_episode_whose_motion_diverges_is_cut_with_its_last_finite_observation(
    tmp_path: Path, sensors: list[dict[str, Any]]
) -> None:
    env = GatesEnv(boat=written(tmp_path, "twin"), disturbances=sensors)
    last, _ = env.reset(seed=0)
    ahead = np.array([1.0, 0.0], np.float32)
    for _ in range(3):
        last = env.step(ahead)[0]
    env.fleet.params["mass"] = math.nan
    seen, reward, terminated, truncated, info = env.step(ahead)
    assert np.array_equal(seen, last)
    assert (reward, terminated, truncated, info["outcome"]) == (0.0, False, True, "diverged")
