"""Straight-line stability: linear roots against what the simulated boat does after a small disturbance."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.effects import parse_effects
from swamp_rl.manoeuvres.controller import Order
from swamp_rl.manoeuvres.steering import commands_of
from swamp_rl.manoeuvres.straight_line_stability import straight_line_stability
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import ACTUATORS, SURGE, YAW_RATE


@pytest.fixture
def outboard(tmp_path: Path) -> Boat:
    path = tmp_path / "skiff.yaml"
    path.write_text(annotated(boat_file("skiff", "outboard", 4.0, 1.6, 300.0, 400.0), "A skiff."))
    return load_boat(path)


def with_yaw_damping(boat: Boat, n_r: float) -> Boat:
    return boat.model_copy(update={"hull": boat.hull.model_copy(update={"n_r": n_r})})


def yaw_rates(boat: Boat, seconds: float) -> np.ndarray:
    """Of a boat at full ahead that has turned a little, every tenth of a second."""
    params, speed = parameters(boat), reference_of(boat).speed
    state = initial_state(params, np.zeros((1, 3)))
    command = commands_of(boat, "opposed")(Order(0.0, 1.0))
    state[0, ACTUATORS:], state[0, SURGE], state[0, YAW_RATE] = command, speed, 1e-4 * speed / boat.length
    given = np.tile(command, (1, round(10 * seconds), 1))
    return np.asarray(
        simulate(params, tank(boat), state, given, np.zeros(1, np.uint64), 0.1, 4)[0, :, YAW_RATE]
    )


def test_an_unstable_boat_s_yaw_rate_grows_at_the_root_and_a_stable_one_s_decays(outboard: Boat) -> None:
    found = straight_line_stability(outboard)
    rates = yaw_rates(outboard, 20.0)
    assert found.growth == pytest.approx(np.log(rates[200] / rates[100]) / 10.0, rel=0.05)
    swamp = load_boat("swamp")
    decayed = yaw_rates(swamp, 60.0)
    assert straight_line_stability(swamp).growth < 0.0
    assert abs(decayed[600]) < 0.5 * abs(decayed[100])


def test_the_yaw_damping_that_is_named_separates_stable_from_unstable(outboard: Boat) -> None:
    limit = straight_line_stability(outboard).stable_n_r
    assert limit is not None and limit < outboard.hull.n_r
    for n_r, grows in ((0.9 * limit, True), (1.1 * limit, False)):
        boat = with_yaw_damping(outboard, n_r)
        rates = yaw_rates(boat, 60.0)
        assert (rates[600] > rates[100]) == grows == (straight_line_stability(boat).growth > 0.0)


def test_weather_of_the_boat_file_does_not_count(outboard: Boat) -> None:
    wind = parse_effects([{"effect": "wind", "speed": 8.0, "from": 1.5}], "here", outboard.thruster_names)
    windy = outboard.model_copy(update={"effects": wind})
    assert straight_line_stability(windy) == straight_line_stability(outboard)
