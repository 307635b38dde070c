"""Disturbance levels: drawn within their bounds, the same in any batch, refused where they make no sense."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from swamp_rl.boat import load_boat
from swamp_rl.effects import Level, apply_effects, load_disturbances, parse_effects
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")
NAMES = BOAT.thruster_names
LEVELS = ["calm", "severe", "standard"]
CLAIMED = ["gusts", "current", "kicks", "elsewhere", "reversed"]
ALMOST_ONE = math.nextafter(1.0, 0.0)
RICH = [
    {"effect": "current", "disc": 0.3, "probability": 0.5},
    {"effect": "wind", "speed": {"log_uniform": [0.1, 7.0]}, "from": {"choice": [0.0, 1.0, 2.0]}},
    {"effect": "thruster_gain", "thruster": {"choice": ["bs", "sp", "all"]}, "gain": {"uniform": [0.2, 0.9]}},
    {"effect": "external_force", "east": {"uniform": [-1.0, 1.0]}},
]


def level(source: Any) -> Level:
    return load_disturbances(source, NAMES)


def drawn(source: Any, uniforms: Any) -> Any:
    record = parameters(BOAT, len(uniforms))
    level(source).apply(record, uniforms)
    return record


def uniforms(source: Any, boats: int, seed: int = 0) -> Any:
    return np.random.default_rng(seed).random((boats, level(source).draw_count))


def refused(source: Any) -> str:
    with pytest.raises(UserError) as error:
        level(source)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_the_shipped_levels_are_these_and_those_that_claims_are_tested_at() -> None:
    folder = Path(__file__).parents[2] / "configs" / "disturbances"
    assert sorted(path.stem for path in folder.glob("*.yaml")) == sorted([*LEVELS, *CLAIMED])


def test_calm_is_the_boat_file_itself_from_the_start_itself() -> None:
    for source in ("calm", None, []):
        assert level(source).draw_count == 0
        assert drawn(source, np.empty((3, 0))).tobytes() == parameters(BOAT, 3).tobytes()
        assert level(source).start(np.empty((3, 0))).tolist() == [[0.0, 0.0, 0.0]] * 3


@pytest.mark.parametrize(
    ("name", "current", "wind", "heading", "mass"),
    [("standard", 0.25, 4.0, math.radians(45), (58.0, 58.0)), ("severe", 0.4, 7.0, math.pi, (48.0, 60.0))],
)
def test_a_level_fills_its_ranges_and_stays_within_them(
    name: str, current: float, wind: float, heading: float, mass: tuple[float, float]
) -> None:
    block = uniforms(name, 4000)
    record, start = drawn(name, block), level(name).start(block)
    speed = np.hypot(record["current_north"], record["current_east"])
    assert 0.98 * current < speed.max() <= current * (1 + 1e-15)
    assert 0.98 * wind < record["wind_speed"].max() <= wind
    assert record["wind_speed"].min() >= 0
    assert 0.98 * heading < start[:, 2].max() <= heading
    assert -heading <= start[:, 2].min() < -0.98 * heading
    assert np.all(start[:, :2] == 0)
    assert mass[0] <= record["mass"].min() <= mass[0] * 1.01
    assert mass[1] * 0.99 <= record["mass"].max() <= mass[1]
    assert np.all(record["gust_time_constant"] > 0)
    assert record["gust_speed_std"].max() > 0


def test_the_directions_of_current_and_wind_favour_none() -> None:
    record = drawn("standard", uniforms("standard", 20000))
    towards = np.arctan2(record["current_east"], record["current_north"])
    for angles in (towards, record["wind_from"]):
        assert np.hypot(np.cos(angles).mean(), np.sin(angles).mean()) < 0.03
    # direction and length are uniform: the mean speed is half the radius
    assert np.hypot(record["current_north"], record["current_east"]).mean() == pytest.approx(0.125, rel=0.02)


@pytest.mark.parametrize("name", ["standard", "severe"])
def test_every_disturbed_episode_has_a_kick_by_a_stern_thruster_and_none_by_a_bow_one(name: str) -> None:
    record = drawn(name, uniforms(name, 500))
    kicked = (record["kick_duration"] > 0) & (record["kick_throttle"] > 0)
    assert not kicked[:, :2].any()
    assert kicked[:, 2:].any(axis=1).all()
    assert kicked[:, 2:].any(axis=0).all()


def test_severe_weakens_exactly_one_thruster_of_the_two_that_the_pilot_drives() -> None:
    gains = drawn("severe", uniforms("severe", 500))["thruster_gain"]
    weak = gains < 1
    assert (weak.sum(axis=1) == 1).all()
    assert weak.any(axis=0).tolist() == [True, True, False, False]
    assert gains.min() >= 0.5


@pytest.mark.parametrize("source", ["standard", "severe", RICH], ids=["standard", "severe", "rich"])
def test_an_episode_is_the_same_bits_in_any_batch(source: Any) -> None:
    block = uniforms(source, 37)
    whole, starts = drawn(source, block), level(source).start(block)
    for rows in (slice(0, 1), slice(5, 6), slice(3, 20), slice(None, None, 7)):
        assert drawn(source, block[rows]).tobytes() == whole[rows].tobytes()
        assert level(source).start(block[rows]).tobytes() == starts[rows].tobytes()


@pytest.mark.parametrize("source", ["standard", "severe", RICH], ids=["standard", "severe", "rich"])
def test_the_list_kept_of_an_episode_rebuilds_it_exactly(source: Any) -> None:
    block = uniforms(source, 20)
    whole = drawn(source, block)
    for row, episode in zip(block, whole, strict=True):
        kept = level(source).drawn(row)
        record = parameters(BOAT)
        apply_effects(record, parse_effects(kept, "run", NAMES), NAMES)
        assert record[0].tobytes() == episode.tobytes()
        assert drawn(kept, np.empty((1, 0)))[0].tobytes() == episode.tobytes()


@given(block=arrays(np.float64, (3, level(RICH).draw_count), elements=st.floats(0.0, ALMOST_ONE)))
def test_any_uniforms_give_values_within_the_bounds(block: Any) -> None:
    record = drawn(RICH, block)
    assert np.all(np.hypot(record["current_north"], record["current_east"]) <= 0.3 * (1 + 1e-15))
    assert np.all((record["wind_speed"] >= 0.1) & (record["wind_speed"] <= 7.0))
    assert np.isin(record["wind_from"], [0.0, 1.0, 2.0]).all()
    gain = record["thruster_gain"]
    assert np.all((gain == 1.0) | ((gain >= 0.2) & (gain <= 0.9)))
    assert np.all(np.abs(record["external_force_east"]) <= 1.0)


def test_a_log_uniform_number_has_its_median_at_the_geometric_mean() -> None:
    source = [{"effect": "mass", "mass": {"log_uniform": [10.0, 1000.0]}}]
    assert drawn(source, np.array([[0.0], [0.5]]))["mass"] == pytest.approx([10.0, 100.0])


def test_an_effect_with_a_probability_is_there_that_often_and_leaves_the_rest_alone() -> None:
    source = [{"effect": "mass", "mass": {"uniform": [30.0, 40.0]}, "probability": 0.25}]
    mass = drawn(source, uniforms(source, 8000))["mass"]
    assert np.mean(mass < 50) == pytest.approx(0.25, abs=0.02)
    assert np.all(mass[mass >= 50] == BOAT.mass)


def test_disturbances_come_on_top_of_the_boats_own_effects(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("extends: swamp\neffects: [{effect: current, north: 0.1}]\n")
    record = parameters(load_boat(tmp_path / "mine.yaml"))
    level([{"effect": "current", "north": 0.2}]).apply(record, np.empty((1, 0)))
    assert record["current_north"] == pytest.approx([0.3])


@pytest.mark.parametrize(
    ("entry", "text"),
    [
        ({"effect": "current", "disk": 0.3}, "unknown key 'disk'; did you mean 'disc'?"),
        ({"effect": "wind", "disc": 0.3}, "unknown key 'disc'"),
        ({"effect": "current", "disc": -0.3}, "disc must be a radius [m/s] of at least 0"),
        ({"effect": "current", "disc": 1e300}, "disc: north 1e+300 is out of range; allowed: at least -20"),
        ({"effect": "current", "north": 21.0}, "north 21 is out of range"),
        ({"effect": "drifting_current", "east": -1e18}, "east -1e+18 is out of range"),
        ({"effect": "wind", "speed": 1e18, "from": 0.0}, "speed 1e+18 is out of range"),
        ({"effect": "wind", "components": {"north": {"uniform": [-150, 0]}, "east": 150}}, "speed 212.132"),
        ({"effect": "gusts", "speed_std": 1e18}, "speed_std 1e+18 is out of range"),
        ({"effect": "current", "disc": 0.3, "north": 0.1}, "disc draws north and east; remove north"),
        ({"effect": "current", "north": "fast"}, "north [m/s]: must be a number, {uniform: [a, b]}"),
        ({"effect": "current", "north": {"gaussian": [0, 1]}}, "north [m/s]: must be a number, {uniform"),
        ({"effect": "current", "north": {"uniform": 0.2}}, "uniform must be a list of numbers"),
        ({"effect": "current", "north": {"uniform": [0.2]}}, "uniform must be [low, high]"),
        (
            {"effect": "current", "north": {"uniform": [0.2, -0.2]}},
            "uniform must be [low, high] with low at most",
        ),
        ({"effect": "current", "north": {"uniform": [0, float("inf")]}}, "uniform must be a list of numbers"),
        ({"effect": "current", "north": {"choice": []}}, "choice must be a list of numbers"),
        ({"effect": "mass", "mass": {"log_uniform": [0.0, 10.0]}}, "log_uniform must begin above 0"),
        (
            {"effect": "mass", "mass": {"uniform": [0.0, 10.0]}},
            "mass 0 is out of range; allowed: above 0 [kg]",
        ),
        ({"effect": "wind", "speed": 3, "from": {"uniform": [0, 360]}}, "from 360 is out of range"),
        ({"effect": "wind", "from": 0.0}, "speed [m/s] is missing"),
        ({"effect": "shallow_water", "depth_over_draught": {"choice": [1.2, 9]}}, "tests end at 1.5"),
        ({"effect": "mass", "mass": 50, "probability": 0}, "probability must be above 0 and at most 1"),
        ({"effect": "thruster_gain", "gain": 0.5}, "thruster is missing"),
        (
            {"effect": "thruster_gain", "thruster": {"choice": ["bs", "xx"]}, "gain": 0.5},
            "unknown thruster 'xx'",
        ),
        (
            {"effect": "thruster_gain", "thruster": {"uniform": ["bs"]}, "gain": 0.5},
            "thruster must be a name, all",
        ),
        ({"effect": "thruster_gain", "thruster": ["bs"], "gain": 0.5}, "unknown thruster ['bs']"),
        (3, "must be a mapping with the key effect"),
    ],
)
def test_a_wrong_entry_is_refused_with_its_place_and_what_is_allowed(entry: Any, text: str) -> None:
    message = refused([{"effect": "mass", "mass": 50}, entry])
    assert message.startswith("disturbances: effects[1]")
    assert text in message


@pytest.mark.parametrize(
    ("text", "output"),
    [
        ("efects: []", "unknown key 'efects'; did you mean 'effects'?"),
        ("effects: {effect: current}", "effects must be a list"),
        ("effects:", "effects must be a list"),
        ("start: 3", "start must be a mapping"),
        ("start: {headng: 0.1}", "unknown key start.headng; did you mean 'heading'?"),
        (
            "start: {heading: {uniform: [-45, 45]}}",
            "start.heading is beyond a full turn; give it in radians",
        ),
        ("start: {north: x}", "start.north [m]: must be a number"),
    ],
)
def test_a_wrong_level_file_is_refused_by_file_and_key(tmp_path: Path, text: str, output: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    message = refused(path)
    assert message.startswith(str(path))
    assert output in message


def test_a_level_that_does_not_exist_is_answered_with_those_that_do() -> None:
    message = refused("standrad")
    assert "did you mean 'standard'?" in message


def test_a_file_that_is_a_list_of_effects_is_reported_its_key(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("- {effect: wind, speed: 1.0}\n")
    with pytest.raises(UserError, match=r"holds a list; .*its effects a list below the key effects"):
        load_disturbances(tmp_path / "mine.yaml", ())
