"""Charge of the battery in episodes: counted, observed, and missing where it begins low."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import Boat, load_boat
from swamp_rl.energy import discharge, pack_power
from swamp_rl.errors import UserError
from swamp_rl.evaluation import drive, episode_table
from swamp_rl.guidance.flight import in_sea
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.runs import Run, RunMeta
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.teleop.afloat import Afloat
from swamp_rl.teleop.rows import sailed_again

SWAMP = load_boat("swamp")
SENSES = ("surge", "charge")
ALL_AHEAD = np.array([1.0, 0.2])


def low(charge: Any) -> list[dict[str, Any]]:
    return [{"effect": "low_battery", "charge": charge}]


@pytest.fixture(scope="module")
def sagging(tmp_path_factory: pytest.TempPathFactory) -> Boat:
    """SWAMP with motors at the battery's voltage and a single pack."""
    file = tmp_path_factory.mktemp("boats") / "sagging.yaml"
    file.write_text("extends: swamp\nname: sagging\nbattery: {thrust_exponent: 1.5, packs: 1}\n")
    return load_boat(file)


def sailed(steps: int, levers: Any = ALL_AHEAD, **task: Any) -> tuple[np.ndarray, np.ndarray]:
    """Observations (T + 1, d) and states (T + 1, S) of an episode under steady levers."""
    env = GatesEnv(**{"observation": SENSES, **task})
    seen = [env.reset(seed=3)[0]]
    states = [env.fleet.boats["state"][0].copy()]
    for _ in range(steps):
        seen.append(env.step(levers)[0])
        states.append(env.fleet.boats["state"][0].copy())
    return np.array(seen), np.array(states)


def test_the_charge_falls_as_the_thrusters_and_the_hotel_load_draw_it() -> None:
    seen, states = sailed(80)
    power = pack_power(SWAMP, states[1:, ACTUATORS + 4 :])
    assert SWAMP.battery is not None
    expected = discharge(SWAMP.battery, power, 0.1).charge.min(axis=1)
    np.testing.assert_allclose(seen[:, 1], expected, rtol=1e-6)
    assert seen[0, 1] == 1.0 and 0.999 < seen[-1, 1] < 0.9995


def test_to_observe_the_charge_changes_nothing_else(sagging: Boat) -> None:
    for boat in (SWAMP, sagging):
        with_it, without = (sailed(60, boat=boat, observation=names)[1] for names in (SENSES, ("surge",)))
        np.testing.assert_array_equal(with_it, without)


def test_a_battery_that_runs_empty_leaves_no_thrust() -> None:
    seen, _ = sailed(100, disturbances=low(5e-4))
    surge, charge = seen.T
    empty = int(np.argmax(charge == 0.0))
    assert 10 < empty < 60 and (np.diff(charge) <= 0.0).all()
    assert np.diff(surge[:empty]).min() > 0.0 and surge[-1] < 0.8 * surge.max()
    np.testing.assert_array_equal(surge[:empty], sailed(100)[0][:empty, 0])


def test_the_thrust_follows_the_voltage_where_the_drives_do_not_regulate(sagging: Boat) -> None:
    _, weak = sailed(60, boat=sagging, disturbances=low(0.1))
    share = ((32.0 + 0.1 * 8.0) / 40.0) ** 1.5
    _, scaled = sailed(60, boat=sagging, disturbances=[{"effect": "thrust_scale", "scale": share}])
    np.testing.assert_allclose(weak[-1, :6], scaled[-1, :6], rtol=2e-3)


def test_a_boat_alone_has_the_bits_that_it_has_in_a_batch(sagging: Boat) -> None:
    task = {"boat": sagging, "observation": SENSES, "disturbances": low({"uniform": [0.0, 0.01]})}
    boats, alone = GatesVectorEnv(300, **task), GatesEnv(**task)
    seen, _ = boats.reset(seed=5)
    own, _ = alone.reset(seed=5 + 11)
    np.testing.assert_array_equal(own, seen[11])
    for _ in range(60):
        seen = boats.step(np.tile(ALL_AHEAD, (300, 1)))[0]
        own = alone.step(ALL_AHEAD)[0]
        np.testing.assert_array_equal(own, seen[11])
    np.testing.assert_array_equal(alone.fleet.boats["state"][0], boats.fleet.boats["state"][11])
    np.testing.assert_array_equal(alone.fleet.supply.drawn[0], boats.supply.drawn[11])


def test_each_episode_begins_with_its_own_charge() -> None:
    boats = GatesVectorEnv(4, observation=SENSES, disturbances=low({"uniform": [0.2, 0.9]}), time_limit=1.0)
    first = boats.reset(seed=1)[0][:, 1]
    for _ in range(11):  # the last of these begins the next episode
        second = boats.step(np.tile(ALL_AHEAD, (4, 1)))[0][:, 1]
    assert len({*first.tolist(), *second.tolist()}) == 8
    assert (boats.supply.drawn == 0.0).all()


def test_a_step_that_is_sailed_anew_is_counted_once() -> None:
    afloat = Afloat(GatesEnv(observation=SENSES, disturbances=low(0.5)))
    afloat.begin(3)
    afloat.start(0.0)
    for _ in range(20):
        for lever in (0.0, 0.5, 1.0):
            afloat.heed(0.0, (lever, 0.2))
        afloat.go_on()
    seen, _ = sailed(20, disturbances=low(0.5))
    assert afloat.observation[1] == seen[-1, 1]


def test_an_evaluation_counts_from_the_charge_that_was_left() -> None:
    tables = []
    for level in (None, low(1.0), low(0.3)):

        def make(n: int, senses: tuple[str, ...], level: Any = level) -> GatesVectorEnv:
            return GatesVectorEnv(n, observation=senses, disturbances=level)

        tables.append(episode_table(drive(LineOfSightPilot(), make, np.arange(2)), SWAMP, 0.1))
    full, counted, weak = tables
    for name in ("electric_energy", "range", "time"):
        np.testing.assert_allclose(counted[name], full[name], rtol=1e-9)
    np.testing.assert_allclose(weak["electric_energy"], full["electric_energy"], rtol=1e-9)
    assert (weak["range"] < 0.3 * full["range"]).all()


@pytest.mark.parametrize("task", [{"observation": ["charge"]}, {"disturbances": low(0.5)}])
def test_a_boat_without_a_battery_is_refused(task: dict[str, Any]) -> None:
    with pytest.raises(UserError, match=r"^boat esso_osaka: .* is missing; .* needs it, add it"):
        GatesEnv(boat="esso_osaka", **task)


def test_a_low_battery_is_refused_where_no_charge_is_counted(tmp_path: Path) -> None:
    message = "low_battery acts in the episodes of an environment alone"
    file = tmp_path / "flat.yaml"
    file.write_text("extends: swamp\nname: flat\neffects: [{effect: low_battery, charge: 0.1}]\n")
    with pytest.raises(UserError, match=message):
        load_boat(file)
    with pytest.raises(UserError, match=message):
        in_sea(SWAMP, low(0.1), [], 0)
    columns = {name: np.zeros(2) for name in ("time", "north", "east", "heading")}
    with pytest.raises(UserError, match=f"run r: disturbances: {message}"):
        sailed_again(Run("r", columns, RunMeta(disturbances=low(0.1))), SWAMP)
