"""The printed steps and rates of the azimuths (thesis 5.7, 6.1, 6.2): rows of docs/validation.md."""

import math

import numpy as np

from benchmarks.link.steps import ENCODER, EXAMPLE_ANGLE, EXAMPLE_STEPS, READINGS, example_angle
from benchmarks.validation.swamp import FULL, Row
from swamp_rl.boat import load_boat
from swamp_rl.link.addresses import LOOPBACK, addresses
from swamp_rl.link.module import GEAR
from swamp_rl.link.protocol import AZIMUTH_MOTOR, ENABLE, POWER, REFERENCE, Command, encoded
from swamp_rl.link.vehicle import Conduct, Vehicle
from swamp_rl.runs.thruster_telemetry import STEPS_PER_TURN
from swamp_rl.simulator.state import ACTUATORS

TABLE_5_5 = ((45.0, 61926), (-135.0, -185779), (720.0, 990822))  # deg, steps: three of its rows
TURN_RATE = 490.0  # deg/s, 5.7.1


def angle_reached(steps: int) -> float:
    """Angle [deg] of the first jet ten seconds after `1004 1 STEPS`, on the virtual vehicle."""
    vehicle = turning(steps, Conduct(timeout=math.inf))
    vehicle.advance(10.0)
    return math.degrees(vehicle.state[0, ACTUATORS])


def turning(steps: int, conduct: Conduct) -> Vehicle:
    """A virtual vehicle whose first jet has been told to turn."""
    boat = load_boat(FULL)
    vehicle = Vehicle(boat, addresses(LOOPBACK, len(boat.thrusters)), conduct=conduct)
    for command in (
        *(Command(opcode, (AZIMUTH_MOTOR, 1)) for opcode in (POWER, ENABLE)),
        Command(REFERENCE, (AZIMUTH_MOTOR, steps)),
    ):
        vehicle.receive(encoded(command), vehicle.addresses.recipient, vehicle.addresses.modules[0])
    return vehicle


def turn_rate() -> float:
    """Greatest rate [deg/s] of the first jet while it turns half a turn."""
    vehicle = turning(STEPS_PER_TURN // 2, Conduct(timeout=math.inf))
    angles = []
    for tick in range(20):
        vehicle.advance(0.05 * tick)
        angles.append(math.degrees(vehicle.state[0, ACTUATORS]))
    return float(np.diff(angles).max() / 0.05)


def link_rows() -> list[Row]:
    """Printed steps, angles and rates beside those of the virtual vehicle."""
    rows = [
        (f"angle of {steps:,} steps, deg", "table 5.5", f"{angle:g}", angle, angle_reached(steps), "")
        for angle, steps in TABLE_5_5
    ]
    turn = float(ENCODER * GEAR)
    rows.append(("steps of a turn, by the encoder and the gear", "6.1", "483328", 483_328.0, turn, ""))
    number = f"angle of {EXAMPLE_STEPS:,} steps, deg"
    for name, steps in list(READINGS.items())[:2]:
        ours = example_angle(steps)
        rows.append((f"{number}, by {name}", "6.2, example", "45", EXAMPLE_ANGLE, ours, number))
    rows.append(("rate of an azimuth, deg/s", "5.7.1", "about 490", TURN_RATE, turn_rate(), ""))
    return [
        Row(what, source, printed, value, ours, math.nan, FULL, reading_of=reading)
        for what, source, printed, value, ours, reading in rows
    ]
