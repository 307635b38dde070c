"""Wind and depth that a run measured are inputs of its simulation."""

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay
from swamp_rl.simulator.restarts import replay_restarted
from swamp_rl.simulator.weather import measured_weather
from tests.support.boats import commands

BOAT = load_boat("swamp")
POSE = ("north", "east", "heading")
ROWS = 300


def under(*effects: dict[str, object]) -> Boat:
    """The boat with those effects in its file."""
    return BOAT.model_copy(update={"effects": parse_effects(list(effects), "test", BOAT.thruster_names)})


def sailed(**weather: np.ndarray | float) -> Run:
    """Half a minute of a turn at full throttle, with columns of weather."""
    command = commands(20, -10, (0.9, 0.9, 0.6, 0.6), ROWS)
    names = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in BOAT.thruster_names]
    columns = dict(zip(names, command.T, strict=True))
    columns |= {"time": 0.1 * np.arange(ROWS)} | {name: np.zeros(ROWS) for name in POSE}
    columns |= {name: np.broadcast_to(value, ROWS).astype(float) for name, value in weather.items()}
    return Run("turn", columns)


def assert_same_track(one: Run, other: Run) -> None:
    for name in POSE:
        np.testing.assert_allclose(one.columns[name], other.columns[name], rtol=0, atol=1e-12, err_msg=name)


def test_a_steady_measured_wind_acts_as_the_wind_of_a_boat_file() -> None:
    blown = under({"effect": "wind", "speed": 4.0, "from": 1.0})
    assert_same_track(replay(BOAT, sailed(wind_speed=4.0, wind_from=1.0)), replay(blown, sailed()))


def test_a_measured_depth_acts_as_shallow_water() -> None:
    shallow = under({"effect": "shallow_water", "depth_over_draught": 2.0})
    assert_same_track(replay(BOAT, sailed(depth=2.0 * BOAT.draught)), replay(shallow, sailed()))


def test_a_wind_that_starts_half_way_changes_nothing_before_and_something_after() -> None:
    speed = np.where(np.arange(ROWS) < 150, 0.0, 6.0)
    calm, blown = replay(BOAT, sailed()), replay(BOAT, sailed(wind_speed=speed, wind_from=1.0))
    np.testing.assert_array_equal(blown.pose[:151], calm.pose[:151])
    assert np.hypot(*(blown.pose[-1, :2] - calm.pose[-1, :2])) > 0.3


def test_the_measured_wind_takes_the_place_of_the_boat_files() -> None:
    blown = under({"effect": "wind", "speed": 4.0, "from": 1.0})
    assert_same_track(replay(blown, sailed(wind_speed=0.0, wind_from=0.0)), replay(BOAT, sailed()))


def test_what_is_ignored_has_no_part() -> None:
    run = sailed(wind_speed=4.0, wind_from=1.0, depth=0.4)
    assert_same_track(replay(BOAT, run, ["wind", "depth"]), replay(BOAT, sailed()))


def test_a_replay_with_restarts_takes_the_measured_wind_too() -> None:
    windy = sailed(wind_speed=4.0, wind_from=1.0)
    run = replay(BOAT, windy)
    assert replay_restarted(BOAT, run, 5.0).miss.max() < 1e-9
    assert replay_restarted(BOAT, run, 5.0, ["wind"]).miss[:, 0].max() > 0.01


def test_a_window_that_starts_where_the_wind_is_missing_starts_with_the_last_one_known() -> None:
    run = replay(BOAT, sailed(wind_speed=4.0, wind_from=1.0))
    gap = slice(95, 112)  # a window starts in it
    run.columns["wind_speed"][gap] = run.columns["wind_from"][gap] = np.nan
    assert replay_restarted(BOAT, run, 5.0).miss.max() < 1e-9


def test_a_depth_below_every_test_is_refused_with_its_row() -> None:
    depth = np.full(ROWS, 1.0)
    depth[7] = 0.1
    with pytest.raises(UserError, match=r"row 8, column depth: 0\.1 m is .* --ignore depth"):
        replay(BOAT, sailed(depth=depth))


def test_a_measurement_of_another_name_is_refused() -> None:
    with pytest.raises(UserError, match="ignore: unknown measurement 'tide'; known here: wind, depth"):
        measured_weather(sailed(), BOAT, ["tide"])
