"""A wind named from the motion of the model ship alone, on a run that was made with a known one."""

import math

import numpy as np
import pytest

from benchmarks.esso_osaka.sway import circles_table, errors, mean_interval, sway_scales, with_sway_drag
from benchmarks.esso_osaka.wind import anemometer, apart, drift_table, hidden, named, wind_of, wind_table
from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.runs import Run
from swamp_rl.simulator.replay import replay

pytestmark = pytest.mark.slow

BOAT = load_boat("esso_osaka")
FROM = 2.0


def changed(*effects: dict[str, object]) -> Boat:
    """The boat file with effects."""
    return BOAT.model_copy(update={"effects": tuple(parse_effects(list(effects), "test", ("main",)))})


def sailed(*others: dict[str, object], seconds: float = 190.0) -> Run:
    """A run in a steady wind of 2 m/s beside other effects, with the anemometer's columns."""
    rng = np.random.default_rng(0)
    time = 0.1 * np.arange(round(seconds / 0.1) + 1)
    held = (time // 20.0).astype(int)
    columns = {
        name: np.zeros_like(time) for name in ("north", "east", "heading", "surge", "sway", "yaw_rate")
    }
    columns["surge"] += 0.3
    columns["rudder_main"] = rng.uniform(-0.4, 0.4, held.max() + 1)[held]
    columns["propeller_main"] = rng.uniform(6.0, 12.0, held.max() + 1)[held]
    windy = changed({"effect": "wind", "speed": 2.0, "from": FROM}, *others)
    made = replay(windy, Run("made", {"time": time} | columns)).columns
    made |= {"wind_speed": np.full_like(time, 2.0), "wind_from": np.full_like(time, FROM)}
    kept = {name: values for name, values in made.items() if not name.startswith("applied_")}
    for name, size in (("north", 0.02), ("east", 0.02), ("heading", 0.005)):
        kept[name] = kept[name] + size * rng.standard_normal(len(time))
    return Run("made", kept)


def test_the_motion_alone_tells_the_wind() -> None:
    run = sailed()
    assert not {"wind_speed", "wind_from"} & set(hidden(run).columns)
    found = named(BOAT, run)
    speed, angle = wind_of(found.fits["wind",])
    assert speed == pytest.approx(2.0, rel=0.05)
    assert apart(angle, FROM) == pytest.approx(0.0, abs=3.0)
    assert found.fits["wind",].chi2 < found.fits["current",].chi2 < found.fits[()].chi2
    assert f"2.00 from {math.degrees(FROM):.0f}" in wind_table([found])
    assert "made" in drift_table([found])


def test_gusts_are_averaged_as_vectors_for_the_direction_and_as_speeds_for_the_size() -> None:
    columns = {"wind_speed": np.array([1.0, 1.0]), "wind_from": np.array([0.0, math.pi / 2])}
    assert anemometer(Run("two", columns)) == pytest.approx((1.0, math.pi / 4))
    assert apart(math.radians(-179.0), math.radians(179.0)) == pytest.approx(2.0)


def test_the_sway_drag_is_reported_beside_the_wind() -> None:
    found = named(BOAT, sailed({"effect": "sway_drag", "scale": 0.6}))
    assert sway_scales([found]) == pytest.approx([0.6], abs=0.05)
    assert apart(wind_of(found.fits["sway_drag", "wind"])[1], FROM) == pytest.approx(0.0, abs=3.0)


def turned(boat: Boat, seconds: float = 420.0) -> Run:
    """A circle of a boat with the rudder hard over, in no wind."""
    time = 0.1 * np.arange(round(seconds / 0.1) + 1)
    columns = {name: np.zeros_like(time) for name in ("north", "east", "heading", "sway", "yaw_rate")}
    columns |= {"surge": np.full_like(time, 0.4), "rudder_main": np.full_like(time, math.radians(35.0))}
    columns |= {"propeller_main": np.full_like(time, 10.0)}
    made = replay(boat, Run("circle", {"time": time} | columns)).columns
    made |= {"wind_speed": np.zeros_like(time), "wind_from": np.zeros_like(time)}
    return Run("circle", {name: values for name, values in made.items() if not name.startswith("applied_")})


def test_circles_of_a_boat_with_half_the_sway_drag_are_predicted_with_half_and_not_without() -> None:
    circle = turned(changed({"effect": "sway_drag", "scale": 0.5}))
    result, plain = errors(with_sway_drag(BOAT, 0.5), [circle]), errors(BOAT, [circle])
    assert all(np.abs(off).max() < 0.5 for off in result.values()), result
    assert plain["tactical diameter"][0] > 10.0 and plain["drift angle"][0] < -10.0
    shown = circles_table(BOAT, {"half": 0.5}, [circle])
    assert f"| {plain['speed'][0]:.0f} % ({plain['speed'][0]:+.0f} %) | 0 % (" in shown


def test_runs_that_agree_give_a_narrow_interval_about_their_mean() -> None:
    assert mean_interval(np.array([0.4, 0.5, 0.6])) == pytest.approx((0.5, 0.2516, 0.7484), abs=1e-4)
