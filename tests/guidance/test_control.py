"""Guidance and control against closed forms, and in the simulator: lines, waypoints, heading, speed."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from swamp_rl.allocation import jets_of
from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.guidance.following import INTEGRAL, LOOKAHEAD, PathFollower
from swamp_rl.guidance.integral_line_of_sight import drift_corrected
from swamp_rl.guidance.line_of_sight import Waypoint
from swamp_rl.guidance.loop import Seen, drive
from swamp_rl.guidance.servo import VelocityServo, inertia_of
from swamp_rl.simulator.state import ACTUATORS, EAST, HEADING, NORTH, SURGE

pytestmark = pytest.mark.numerical

Array = NDArray[np.float64]

BOAT = load_boat("swamp")


def among(*effects: dict[str, object]) -> Boat:
    """The boat in these effects."""
    entries = parse_effects(list(effects), "test", BOAT.thruster_names)
    return BOAT.model_copy(update={"effects": tuple(entries)})


def follower(boat: Boat, waypoints: list[Waypoint], speed: float = 0.7) -> PathFollower:
    return PathFollower(jets_of(boat), VelocityServo(inertia_of(boat)), waypoints, speed)


@pytest.mark.parametrize("damping", [1.0, 0.7])
def test_a_steady_push_is_forgotten_with_the_poles_that_were_placed(damping: float) -> None:
    """On m dv/dt = F + d the loop answers a step of d with (d/m) t exp(-ωt), or its underdamped sister."""
    m, omega, push, dt = 60.0, 0.8, 12.0, 1e-3
    servo = VelocityServo(np.full(3, m), np.full(3, omega), damping)
    v, seen = np.zeros(3), []
    time = np.arange(8000) * dt
    for _ in time:
        seen.append(v[0])
        force = servo.force(np.zeros(3), v)
        servo.learn(np.zeros(3), v, force, force, dt)
        v = v + dt * (force + push) / m
    if damping == 1.0:
        exact = push / m * time * np.exp(-omega * time)
    else:
        fast = omega * math.sqrt(1 - damping**2)
        exact = push / m / fast * np.exp(-damping * omega * time) * np.sin(fast * time)
    assert np.array(seen) == pytest.approx(exact, abs=3e-4)
    assert servo.memory == pytest.approx(np.full(3, -push), rel=0.03)


def test_the_integral_does_not_wind_up_while_nothing_is_achieved() -> None:
    servo = VelocityServo(np.full(3, 60.0))
    wanted, still = np.array([1.0, 0.0, 0.0]), np.zeros(3)
    for _ in range(3000):
        asked = servo.force(wanted, still)
        servo.learn(wanted, still, asked, np.array([5.0, 0.0, 0.0]), 0.1)
    assert servo.force(wanted, still)[0] < 3 * 60.0  # two gains and a little, not 300 s of error


def test_the_memory_settles_where_the_closed_form_says() -> None:
    """A point at speed U of given heading, in a current c across: across' = U sin(heading) + c."""
    U, c, dt = 0.7, 0.2, 0.02
    north, east, memory = 0.0, -3.0, 0.0
    for _ in range(20_000):
        heading, memory = drift_corrected(
            Waypoint(north, east), Waypoint(0, 0), Waypoint(1e4, 0), LOOKAHEAD, INTEGRAL, memory, dt
        )
        north += dt * U * math.cos(heading)
        east += dt * (U * math.sin(heading) + c)
    assert east == pytest.approx(0.0, abs=1e-3)
    assert INTEGRAL * memory == pytest.approx(LOOKAHEAD * math.tan(math.asin(c / U)), rel=1e-3)


def test_the_line_is_kept_in_a_current_across_to_a_centimetre() -> None:
    boat = among({"effect": "current", "north": -0.1, "east": 0.2})
    track = drive(boat, follower(boat, [Waypoint(0, 0), Waypoint(200, 0)]), (0.0, 2.0, 0.0), 100.0, dt=0.2)
    assert np.abs(track[-100:, EAST]).max() < 0.01
    assert track[-100:, SURGE] == pytest.approx(np.full(100, 0.7), abs=0.005)


def test_without_the_integral_the_boat_lies_beside_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("swamp_rl.guidance.following.INTEGRAL", 0.0)
    boat = among({"effect": "current", "north": 0.0, "east": 0.2})
    track = drive(boat, follower(boat, [Waypoint(0, 0), Waypoint(200, 0)]), (0.0, 0.0, 0.0), 100.0, dt=0.2)
    assert track[-1, EAST] > 0.8  # about lookahead times 0.2 / 0.7


def test_waypoints_are_passed_in_turn_and_the_thrust_stops_at_the_last() -> None:
    corners = [Waypoint(0, 0), Waypoint(15, 0), Waypoint(15, 15), Waypoint(0, 15), Waypoint(0, 3)]
    track = drive(BOAT, follower(BOAT, corners), (0.0, 0.0, 0.0), 130.0, dt=0.2)
    for corner in corners:
        assert np.hypot(track[:, NORTH] - corner.north, track[:, EAST] - corner.east).min() < 1.6
    assert np.all(track[-1, ACTUATORS + 4 :] == 0.0)


def test_heading_and_speed_settle_without_much_overshoot() -> None:
    boat = among({"effect": "wind", "speed": 4.0, "from": 1.0})
    pilot = follower(boat, [Waypoint(0, 0), Waypoint(1, 0)])

    class Turning:
        def act(self, seen: Seen, dt: float) -> Array:
            return pilot.steer(math.pi / 2, seen, dt)

    track = drive(boat, Turning(), (0.0, 0.0, 0.0), 40.0)
    assert track[-50:, HEADING] == pytest.approx(np.full(50, math.pi / 2), abs=0.01)
    assert track[:, HEADING].max() < math.pi / 2 + math.radians(8)
    assert track[-50:, SURGE] == pytest.approx(np.full(50, 0.7), abs=0.01)
    assert track[:, SURGE].max() < 0.75


class AheadAfterASecond:
    """All jets at rest for a second, then ahead at full throttle."""

    def act(self, seen: Seen, dt: float) -> Array:
        return np.repeat([0.0, float(seen.time > 0.95)], 4)


def test_a_command_delay_of_the_boat_shifts_what_it_does_in_time() -> None:
    late = among({"effect": "command_delay", "delay": 0.5})
    prompt, delayed = (drive(boat, AheadAfterASecond(), (0.0, 0.0, 0.0), 5.0) for boat in (BOAT, late))
    np.testing.assert_allclose(delayed[5:, NORTH], prompt[:-5, NORTH], atol=1e-9)
    assert prompt[-1, NORTH] > 2.0
