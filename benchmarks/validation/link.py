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
TURN_RATES = {"5.7.1": ("about 490", 490.0), "5.3.2": ("492", 492.0)}  # deg/s
MOTOR_RPM, GEARBOX = 4840.0, 59.0  # of the azimuth's motor, table 5.2; a gear of 2:1 follows, 5.3.2
EXAMPLE = (
    "table 5.5 prints 61,926 steps for 45° and 495,411 for a turn, 6.1 prints 483,328 for a turn; this needs "
    "330,272."
)


def angle_reached(steps: int) -> float:
    """Angle [deg] of the first jet ten seconds after `1004 1 STEPS`, on the virtual vehicle."""
    vehicle = turning(steps, Conduct(timeout=math.inf))
    vehicle.advance(10.0)
    return math.degrees(vehicle.state[0, ACTUATORS])


def turning(steps: int, conduct: Conduct) -> Vehicle:
    """A virtual vehicle whose first jet has been commanded to turn."""
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
    number, simulated = "rate of an azimuth, deg/s", turn_rate()
    behind = f"{number}, {MOTOR_RPM:.0f} rpm behind the gearbox of {GEARBOX:.0f}:1 alone"
    rate = MOTOR_RPM / GEARBOX * 360.0 / 60.0
    for source, (printed, value) in TURN_RATES.items():
        rows.append((f"{number}, simulated", source, printed, value, simulated, number))
        rows.append((behind, source, printed, value, rate, number))
    return [
        Row(
            *(what, source, printed, value, ours, math.nan, FULL),
            reading_of=reading,
            reason=EXAMPLE if source == "6.2, example" else "",
            contradicted=source == "6.2, example",
        )
        for what, source, printed, value, ours, reading in rows
    ]
