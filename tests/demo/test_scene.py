"""Runs on one clock: aligned at the first gate, drawn where they are, plotted as they were."""

import json

import numpy as np
import pytest

from swamp_rl.course import load_course
from swamp_rl.demo.clock import instants, poses_at, values_at
from swamp_rl.demo.page import page
from swamp_rl.demo.scene import Shown, demo_scene, first_gate_time
from swamp_rl.demo.series import current, series_of, speed, wind
from swamp_rl.demo.shapes import corners, mesh
from swamp_rl.demo.weather import flows
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, RunMeta

CAMOGLI = load_course("camogli")
GATE = CAMOGLI.gates[0]
TIME = np.arange(400) * 0.1


def northward(speed: float, east: float = 0.0, name: str = "run", late: float = 0.0) -> Run:
    columns = {"time": TIME + late, "north": speed * TIME, "east": east + 0.0 * TIME, "heading": 0.0 * TIME}
    return Run(name, columns)


def test_a_boat_at_steady_speed_is_at_the_gate_when_way_over_speed_says() -> None:
    for pace in (0.3, 0.77, 1.1):
        assert first_gate_time(northward(pace, late=9.0), CAMOGLI) == pytest.approx(GATE.centre.north / pace)


def test_a_boat_that_misses_the_gate_counts_where_it_was_nearest() -> None:
    beside = northward(0.5, east=GATE.width)
    assert first_gate_time(beside, CAMOGLI) == pytest.approx(GATE.centre.north / 0.5, abs=0.05)


def test_a_gate_passed_backwards_is_not_passed() -> None:
    there_and_back = northward(0.0)
    there_and_back.columns["north"][:] = np.abs(0.5 * TIME - 10.0)
    assert first_gate_time(there_and_back, CAMOGLI) == pytest.approx((10.0 + GATE.centre.north) / 0.5)


def test_aligned_boats_are_all_at_the_gate_together_and_the_first_starts_at_zero() -> None:
    runs = {"human": [northward(0.4, name="slow")], "ppo": [northward(0.9, name="fast")]}
    scene = demo_scene("a", runs, CAMOGLI, (1.24, 1.1), "gate")
    at = GATE.centre.north / 0.4
    for item in scene.shown:
        assert poses_at(item, np.array([at]))[0, 0] == pytest.approx(GATE.centre.north)
    assert min(item.start for item in scene.shown) == 0.0
    assert f"{at:.1f} s" in scene.aligned


def test_a_run_of_one_row_is_refused_by_name() -> None:
    still = Run("lone", {name: np.zeros(1) for name in ("time", "north", "east", "heading")})
    with pytest.raises(UserError, match=r"run lone: has 1 row\(s\)"):
        demo_scene("a", {"human": [northward(0.5), still]}, CAMOGLI, (1.24, 1.1))


def test_people_come_first_in_name_and_colour() -> None:
    runs = {"ppo": [northward(0.5)], "scripted": [northward(0.6)]}
    scene = demo_scene("a", runs, CAMOGLI, (1.24, 1.1))
    assert scene.groups == ["scripted", "ppo"]
    assert [fleet.path[0] for fleet in scene.fleets] == scene.groups
    assert len({fleet.colour for fleet in scene.fleets}) == 2


def test_between_rows_boats_move_straight_and_before_and_after_they_wait() -> None:
    item = Shown("a", "a", northward(1.0), start=2.0)
    north = poses_at(item, np.array([0.0, 2.05, 3.0, 1000.0]))[:, 0]
    assert north == pytest.approx([0.0, 0.05, 1.0, TIME[-1]])


def test_headings_turn_the_short_way() -> None:
    run = northward(1.0)
    run.columns["heading"][:] = np.pi - np.mod(np.pi - (3.0 + 0.1 * TIME), 2.0 * np.pi)
    turned = poses_at(Shown("a", "a", run), np.arange(0.0, 39.0, 0.013))[:, 2]
    assert np.abs(np.diff(turned)).max() < 0.0015


def test_values_are_held_and_there_are_none_before_and_after_the_run() -> None:
    item = Shown("a", "a", northward(1.0), start=1.0)
    values = values_at(item, TIME, np.array([0.9, 1.0, 1.19, 40.9, 41.1]))
    assert np.array_equal(values, [np.nan, 0.0, TIME[1], TIME[-1], np.nan], equal_nan=True)


def test_the_clock_keeps_the_rows_of_runs_that_start_together() -> None:
    scene = demo_scene("a", {"x": [northward(1.0, late=3.3)]}, None, (1.0, 1.0))
    assert np.array_equal(instants(scene), np.round(TIME, 6))


def test_speed_is_the_slope_of_the_track_where_it_was_not_measured() -> None:
    run = northward(0.7)
    assert speed(run) == pytest.approx(np.full(len(TIME), 0.7))
    run.columns.update(surge=np.full(len(TIME), 3.0), sway=np.full(len(TIME), 4.0))
    assert speed(run) == pytest.approx(np.full(len(TIME), 5.0))


def test_distance_to_go_ends_at_nought_only_through_all_gates() -> None:
    red = CAMOGLI.gates[1].centre
    north = np.linspace(0.0, red.north + 1.0, len(TIME))
    east = np.interp(north, [GATE.centre.north, red.north - 1.0], [GATE.centre.east, red.east])
    through = Run("a", {"time": TIME, "north": north, "east": east, "heading": 0.0 * TIME})
    way = series_of(through, CAMOGLI)["distance to go [m]"][""]
    assert way[-1] == 0.0 and way[0] > 20.0
    assert series_of(northward(1.0, east=9.0), CAMOGLI)["distance to go [m]"][""][-1] > 5.0


def test_wind_from_the_north_blows_south_and_the_current_flows_where_it_says() -> None:
    listed = [{"effect": "wind", "speed": 4.0, "from": 0.0}, {"effect": "current", "east": 0.3}]
    run = Run("a", northward(1.0).columns, RunMeta(disturbances=listed))
    blows, flows = wind(run), current(run)
    assert blows is not None and blows[0] == pytest.approx([-4.0, 0.0], abs=1e-12)
    assert flows is not None and flows[7] == pytest.approx([0.0, 0.3])
    named = Run("a", northward(1.0).columns, RunMeta(disturbances="standard"))
    assert wind(named) is None and current(named) is None


def test_a_measured_wind_goes_before_the_one_that_was_set() -> None:
    columns = northward(1.0).columns | {"wind_speed": 2.0 + 0 * TIME, "wind_from": np.pi / 2 + 0 * TIME}
    blows = wind(Run("a", columns, RunMeta(disturbances=[{"effect": "wind", "speed": 9.0, "from": 0.0}])))
    assert blows is not None and blows[3] == pytest.approx([0.0, -2.0], abs=1e-12)


def test_a_wind_that_was_recorded_as_nought_throughout_is_not_drawn() -> None:
    calm = northward(1.0).columns | {"wind_speed": 0 * TIME, "wind_from": 0 * TIME}
    windy = northward(1.0).columns | {"wind_speed": np.minimum(TIME, 3.0), "wind_from": 0 * TIME}
    for columns, drawn in ((calm, []), (windy, ["wind"])):
        scene = demo_scene("a", {"human": [Run("a", columns)]}, CAMOGLI, (1.24, 1.1))
        assert [flow.name for flow in flows(scene, scene.shown, TIME)] == drawn
        data = json.loads(page(scene).split('type="application/json">')[1].split("</script>")[0])
        assert list(data["runs"][0]["flows"]) == drawn


def test_the_bow_points_along_the_heading() -> None:
    for heading in (0.0, 1.0, -2.5):
        outline = corners(np.array([[3.0, 4.0, heading]]), 2.0, 1.0)[0]
        bow = outline[np.argmax((outline - [3.0, 4.0]) @ [np.cos(heading), np.sin(heading)])]
        assert bow == pytest.approx([3.0 + np.cos(heading), 4.0 + np.sin(heading)])
        assert np.array_equal(outline[0], outline[-1])


@pytest.mark.parametrize("size", [(1.24, 1.1), (3.0, 0.5)])
def test_the_mesh_has_the_boats_size_and_no_empty_faces(size: tuple[float, float]) -> None:
    vertices, triangles = mesh(*size)
    assert np.ptp(vertices[:, :2], axis=0) == pytest.approx(size)
    assert triangles.max() == len(vertices) - 1
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 1e-6
