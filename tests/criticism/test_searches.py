"""Searches are declared with the effects, in sizes of the boat: any boat, any effect."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.experiments.synthetic.cases import Case, write_case

from swamp_rl.boat import Boat, load_boat
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.criticism.model.candidates import by_label, candidates
from swamp_rl.criticism.model.scales import state_scale, window_lengths
from swamp_rl.effects import LIBRARY, Effect, Parameter, Reference, Search, apply_effects, parse_effects
from swamp_rl.effects.declare import declare
from swamp_rl.runs.table import write_table
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.sensors import CHANNELS, observe
from swamp_rl.simulator.state import ACTUATORS
from tests.support.from_scratch import written

SWAMP = load_boat("swamp")
STEPS = 800


def test_the_top_speed_is_where_full_thrust_ahead_meets_the_resistance() -> None:
    of = reference_of(SWAMP)
    params = parameters(SWAMP)
    start = initial_state(params, np.zeros((1, 3)))
    ahead = np.tile([0.0] * 4 + [1.0] * 4, (1, 1500, 1))
    end = simulate(params, tank(SWAMP), start, ahead, np.zeros(1, np.uint64), 0.1, 2)[0, -1]
    assert of.speed == pytest.approx(float(end[3]), rel=1e-4)
    assert of.thrust == pytest.approx(4 * 12.2, rel=1e-9)


@pytest.mark.parametrize("ratio", [0.2, 4.0])
def test_bounds_follow_the_boat_by_the_units_of_their_parameters(ratio: float) -> None:
    """Dimensions: a number [kg^a m^b s^c] of a boat of Froude's law scales by ratio^(3 a + b + c / 2)."""
    powers = {
        "1": 0.0,
        "rad": 0.0,
        "m": 1.0,
        "m/s": 0.5,
        "m/s2": 0.0,
        "rad/s": -0.5,
        "1/s": -0.5,
        "Hz": -0.5,
        "s": 0.5,
        "s/s": 0.0,
        "kg": 3.0,
        "N": 3.0,
        "N s/m": 2.5,
        "N m s/rad": 4.5,
        "N m s2/m2": 3.0,
    }
    of = reference_of(SWAMP)
    one = replace(of, run=60.0)
    other = Reference(
        ratio * of.length,
        ratio * of.breadth,
        ratio**3 * of.mass,
        math.sqrt(ratio) * of.speed,
        ratio**3 * of.thrust,
        math.sqrt(ratio) * 60.0,
    )
    for effect in LIBRARY.values():
        for parameter in effect.parameters:
            if parameter.search is None or parameter.name in (effect.vector or ()):
                continue
            sizes = [getattr(reference, parameter.search.of) for reference in (one, other)]
            expected = ratio ** powers[parameter.unit]
            assert sizes[1] / sizes[0] == pytest.approx(expected), (effect.name, parameter.name)


def test_the_numbers_of_swamp_are_those_that_the_benchmarks_were_made_with() -> None:
    known = by_label(candidates(SWAMP, 80.0))
    for label, scale, low, high in (
        ("current", 0.1, -1.5, 1.5),
        ("wind", 2.0, -20.0, 20.0),
        ("azimuth_lag", 0.2, 0.0, 4.0),
        ("linear_drag", 3.0, -40.0, 80.0),
        ("external_force", 1.0, -30.0, 30.0),
        ("hull_asymmetry", 1.0, -30.0, 30.0),
        ("mass", 8.7, 23.2, 145.0),
        ("thruster_failure bs", 5.0, 0.0, 80.0),
    ):
        spec = known[label].specs[0]
        assert (spec.scale, spec.low, spec.high) == pytest.approx((scale, low, high), rel=5e-3, abs=1e-9)


def test_windows_last_as_long_as_a_slow_boat_takes_for_its_length() -> None:
    assert window_lengths(SWAMP) == (5.0, 20.0)
    ship = load_boat("esso_osaka")
    of = reference_of(ship)
    assert np.array(window_lengths(ship)) * of.speed / of.length == pytest.approx([5.5, 22.0])


def test_an_effect_without_a_search_is_refused_unless_it_is_no_cause() -> None:
    with pytest.raises(ValueError, match="without a search"):
        declare(
            "rough_hull",
            Parameter("scale", "1", 1.0, "resistance_scale"),
            acts_on="force",
            combine="multiply",
            description="a test",
            source="a test",
        )
    assert "rough_hull" not in LIBRARY


@pytest.mark.slow
@pytest.mark.numerical
@pytest.mark.usefixtures("no_figures")
def test_one_declaration_makes_an_effect_that_a_diagnosis_finds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(
        LIBRARY,
        "sway_added_mass",
        Effect(
            "sway_added_mass",
            (Parameter("scale", "1", 1.0, "added_mass_sway", low=0.0, search=Search(0.2, 0.0, 6.0, (1.1,))),),
            "force",
            "multiply",
            "that multiple of the added mass in sway",
            "a test",
        ),
    )
    case = Case("A", "single", [{"effect": "sway_added_mass", "scale": 1.8}])
    write_case(case, np.random.default_rng(5), tmp_path / "data", tmp_path / "truth.json")
    diagnose(tmp_path / "data", "swamp", tmp_path / "out")
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert [cause["effect"] for cause in found["causes"]] == ["sway_added_mass"]
    scale = found["causes"][0]["parameters"]["scale"]
    assert scale["value"] == pytest.approx(1.8, abs=4 * scale["standard_error"])


def sail(boat: Boat, effects: list[dict[str, Any]], folder: Path, seed: int = 3) -> None:
    """Two runs under random steps of every thruster, with noise and durations in the boat's own sizes."""
    rng, time = np.random.default_rng(seed), reference_of(boat).time
    count, dt = len(boat.thrusters), 0.05 * max(round(time / 0.5), 1)
    sigma = state_scale(boat) * [0.02, 0.02, 0.01, 0.02, 0.02, 0.01]
    names = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in boat.thruster_names]
    params, seeds = parameters(boat), np.zeros(1, np.uint64)
    apply_effects(params, parse_effects(effects, "test", boat.thruster_names), boat.thruster_names)
    low, high = np.repeat([[-0.6, 0.3], [0.6, 1.0]], count, axis=1)
    folder.mkdir()
    for number in range(2):
        asked = np.repeat(rng.uniform(low, high, (40, 2 * count)), STEPS // 40, axis=0)
        start = initial_state(params, np.zeros((1, 3)))
        start[:, ACTUATORS:] = asked[0]
        track = simulate(params, tank(boat), start, asked[None], seeds, dt, round(dt / 0.05))
        seen = observe(track, params, dt)[0, :-1] + sigma * rng.standard_normal((STEPS, 6))
        seen[:, 2] = np.pi - np.mod(np.pi - seen[:, 2], 2 * np.pi)
        commands = dict(zip(names, asked.T, strict=True))
        columns = {"time": dt * np.arange(STEPS)} | dict(zip(CHANNELS, seen.T, strict=True)) | commands
        write_table(folder / f"run_{number}.csv", columns)


@pytest.mark.slow
@pytest.mark.numerical
@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize(
    ("name", "thruster"), [("toy", "port"), ("large", "bow")], ids=["a toy of 0.3 m", "a ferry of 18 m"]
)
def test_a_weak_thruster_is_named_on_boats_of_any_size(tmp_path: Path, name: str, thruster: str) -> None:
    file = written(tmp_path, name)
    sail(
        load_boat(file), [{"effect": "thruster_gain", "thruster": thruster, "gain": 0.75}], tmp_path / "data"
    )
    diagnose(tmp_path / "data", file, tmp_path / "out")
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert [(cause["effect"], cause["thruster"]) for cause in found["causes"]] == [
        ("thruster_gain", thruster)
    ]
    gain = found["causes"][0]["parameters"]["gain"]
    assert gain["value"] == pytest.approx(0.75, abs=4 * gain["standard_error"])
