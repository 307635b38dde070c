"""One thruster module: its two motors under the commands of thesis 6.2, without a socket."""

import math

from swamp_rl.link.addresses import Addresses, Endpoint
from swamp_rl.link.protocol import (
    AZIMUTH_MOTOR,
    DEBUG,
    ENABLE,
    HOME,
    MAX_SPEED,
    POWER,
    REFERENCE,
    TELEMETRY,
    TELEMETRY_TO,
    THRUST_MOTOR,
    Command,
)

GEAR = 118
"""Turns of the azimuth's motor for one of the nozzle, 59 in the gearbox times 2 (thesis 5.3.2). The 483,328
of 6.1 are 4096 steps of the motor times this."""
TIMEOUT = 1.0
"""Seconds without a command after which a pump stops; the thesis has no such time."""


class ThrusterModule:
    """The switches and references of one module.

    Chosen here, for the thesis does not say: a reference for a motor that is off counts for nothing; a motor
    that loses power or is disabled forgets its reference; so does the pump after `timeout` [s] without any
    command, as where its sender has died; an azimuth that is off stays where it is.
    """

    def __init__(self, vehicle: Addresses, timeout: float = TIMEOUT) -> None:
        self._vehicle, self._timeout = vehicle, timeout
        self.recipient: Endpoint = vehicle.recipient
        self.power, self.enabled = [False, False], [False, False]
        self.throttle = 0
        "Reference of the pump in thousandths of a percent."
        self.steps: int | None = None
        "Reference of the azimuth; None: it stays where it is."
        self.max_speed: int | None = None
        "Of the azimuth's motor [RPM]; None: no command limits it."
        self.debug = self.telemetry = True
        self._heard = -math.inf

    def runs(self, motor: int) -> bool:
        """Whether a motor has power and is enabled."""
        return self.power[motor] and self.enabled[motor]

    def check_sender(self, now: float) -> None:
        """Stop the pump where no command has come for the timeout; now [s]."""
        if now - self._heard > self._timeout:
            self.throttle = 0

    def obey(self, command: Command, now: float) -> None:
        """Carry out a command that comes at the time `now` [s]."""
        self._heard = now
        opcode, given = command.opcode, command.arguments
        if opcode in (POWER, ENABLE):
            (self.power if opcode == POWER else self.enabled)[given[0]] = bool(given[1])
            self._forget(given[0])
        elif opcode == REFERENCE:
            self._refer(given[0], given[1])
        elif opcode == HOME:
            self._refer(AZIMUTH_MOTOR, 0)
        elif opcode == MAX_SPEED:
            self.max_speed = given[0]
        elif opcode == DEBUG:
            self.debug = bool(given[0])
        elif opcode == TELEMETRY:
            self.telemetry = bool(given[0])
        elif opcode == TELEMETRY_TO:
            self.recipient = (self._vehicle.with_byte(given[0]), given[1])

    def _forget(self, motor: int) -> None:
        if self.runs(motor):
            return
        if motor == THRUST_MOTOR:
            self.throttle = 0
        else:
            self.steps = None

    def _refer(self, motor: int, value: int) -> None:
        if not self.runs(motor):
            return
        if motor == THRUST_MOTOR:
            self.throttle = value
        else:
            self.steps = value
