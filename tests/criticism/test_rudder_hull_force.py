"""The force that a rudder induces on the hull, hidden in simulated runs of a propeller and a rudder."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import PropellerRudder, load_boat
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import candidates, instances_of
from swamp_rl.effects import LIBRARY, apply_effects, parse_effects
from swamp_rl.errors import UserError
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.sensors import observe
from tests.support.criticism import select_effects

BOAT = load_boat("esso_osaka")
NAME = "rudder_hull_force"
SIGMA = np.array([0.005, 0.005, 0.002, 0.003, 0.003, 0.0005])
RIVALS = ("sway_drag", "yaw_damping", "azimuth_offset")
DT, SECONDS = 0.25, 60.0


def steered_runs(a_h: float, x_h: float) -> RunSet:
    """Two zig-zags of a boat whose rudder induces that force."""
    entry = {"effect": NAME, "thruster": "main", "a_h": a_h, "x_h": x_h}
    record = parameters(BOAT, 2)
    apply_effects(record, parse_effects([entry], "test", BOAT.thruster_names), BOAT.thruster_names)
    time = np.arange(round(SECONDS / DT)) * DT
    given = np.array(
        [
            np.column_stack([angle * np.sign(np.sin(2.0 * math.pi * time / period)), np.full(len(time), n)])
            for angle, period, n in ((0.6, 40.0, 10.0), (0.35, 25.0, 12.0))
        ]
    )
    start = initial_state(record, np.zeros((2, 3)), np.tile([0.3, 0.0, 0.0], (2, 1)))
    track = simulate(record, tank(BOAT), start, given[:, :-1].copy(), np.zeros(2, np.uint64), DT, 5)
    noise = SIGMA * np.random.default_rng(5).standard_normal((*given.shape[:2], 6))
    lengths = np.full(2, given.shape[1])
    return RunSet(BOAT, DT, ("a", "b"), given, observe(track, record, DT) + noise, lengths)


def test_a_rudder_that_pulls_less_of_the_hull_along_is_named_among_its_rivals() -> None:
    found = select_effects(steered_runs(0.15, -0.42), NAME, *RIVALS)
    assert found.winner.hypothesis.label == f"{NAME} main"
    assert found.winner.x[0] == pytest.approx(0.15, abs=0.04)
    assert not found.rivals


def test_the_force_is_a_candidate_on_each_boat_with_a_rudder_and_begins_at_the_boat_files_numbers() -> None:
    assert not instances_of(LIBRARY[NAME], load_boat("swamp"))
    (one,) = [each for each in candidates(BOAT, SECONDS) if each.effect.name == NAME]
    (main,) = BOAT.thrusters
    assert isinstance(main, PropellerRudder)
    assert one.label == f"{NAME} main"
    assert one.starts == ((main.rudder.a_h, main.rudder.x_h),)


def test_the_bounds_hold_the_boat_files_own_number() -> None:
    (main,) = BOAT.thrusters
    assert isinstance(main, PropellerRudder)
    strong = main.model_copy(update={"rudder": main.rudder.model_copy(update={"a_h": 0.9})})
    boat = BOAT.model_copy(update={"thrusters": (strong,)})
    for known, highest in ((BOAT, 0.6), (boat, 0.9)):
        (one,) = instances_of(LIBRARY[NAME], known)
        assert (one.specs[0].low, one.specs[0].high) == (0.0, highest)


def test_a_boat_file_without_a_rudder_is_refused_the_effect_and_one_with_a_rudder_has_it(
    tmp_path: Path,
) -> None:
    for base in ("swamp", "esso_osaka"):
        (main, *_) = load_boat(base).thruster_names
        entry = f"{{effect: {NAME}, thruster: {main}, a_h: 0.2, x_h: -0.4}}"
        (tmp_path / f"of_{base}.yaml").write_text(f"extends: {base}\neffects: [{entry}]\n")
    with pytest.raises(
        UserError, match=r"of_swamp.yaml: effects: rudder_hull_force needs a rudder, of which"
    ):
        load_boat(tmp_path / "of_swamp.yaml")
    record = parameters(load_boat(tmp_path / "of_esso_osaka.yaml"))
    assert record["rudder_a_h"].tolist() == [[0.2]] and record["rudder_x_h"].tolist() == [[-0.4]]
