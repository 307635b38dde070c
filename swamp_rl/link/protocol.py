"""Command datagrams of the thruster modules and of the sensors' program as bytes and back (thesis 6.2).

A command is a C string: decimal numbers between spaces, ended by a zero byte. The opcodes 10001 and 10002
mean one thing to a thruster module and another to the sensors' program: a datagram is read for one of them.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from swamp_rl.runs.thruster_telemetry import FULL

POWER, ENABLE, REFERENCE, MAX_SPEED, HOME = 1002, 1003, 1004, 1005, 1007
DEBUG, TELEMETRY, TELEMETRY_TO = 10000, 10001, 10002
"""Of a module: print or not, send telemetry or not, and the one recipient that gets it from now on."""
INSERT_RECIPIENT, REMOVE_RECIPIENT = 10001, 10002
"""Of the sensors' program, which has a set of recipients."""
THRUST_MOTOR, AZIMUTH_MOTOR = 0, 1
INT32 = (-(2**31), 2**31 - 1)
LONGEST = 64
"""Bytes of the longest command that is read; the longest that the protocol can need has 21."""

SWITCH, MOTOR, BYTE, PORT = (0, 1), (0, 1), (1, 254), (1, 65535)
Spans = tuple[tuple[int, int], ...]
MODULE: Mapping[int, Spans] = {
    POWER: (MOTOR, SWITCH),
    ENABLE: (MOTOR, SWITCH),
    REFERENCE: (MOTOR, INT32),
    MAX_SPEED: ((0, INT32[1]),),
    HOME: (),
    DEBUG: (SWITCH,),
    TELEMETRY: (SWITCH,),
    TELEMETRY_TO: (BYTE, PORT),
}
"""The least and greatest value of each argument of a thruster module's opcodes."""
SENSORS: Mapping[int, Spans] = {
    DEBUG: (SWITCH,),
    INSERT_RECIPIENT: (BYTE, PORT),
    REMOVE_RECIPIENT: (BYTE, PORT),
}
"""The same of the sensors' program."""
_NUMBER = re.compile(r"-?[0-9]{1,10}", re.ASCII)


class DatagramError(ValueError):
    """A datagram that is no command; its text is the reason, a word or two."""


@dataclass(frozen=True)
class Command:
    """An opcode with its arguments, whole numbers in the order of the datagram."""

    opcode: int
    arguments: tuple[int, ...] = ()


def encoded(command: Command) -> bytes:
    """The datagram of a command, its zero byte included."""
    return " ".join(map(str, (command.opcode, *command.arguments))).encode("ascii") + b"\0"


def decoded(datagram: bytes, program: Mapping[int, Spans]) -> Command:
    """The command in a datagram for a program, `MODULE` or `SENSORS`; DatagramError with the reason.

    What follows the first zero byte does not count, as in C. The zero byte may be missing: the thesis's own
    example sends its commands by Matlab's `fwrite(m1, '1002 0 1')`, which adds none.
    """
    if len(datagram) > LONGEST:
        raise DatagramError("oversized")
    text = datagram.partition(b"\0")[0]
    try:
        words = text.decode("ascii").split()
    except UnicodeDecodeError:
        raise DatagramError("not ASCII") from None
    if not words or not all(_NUMBER.fullmatch(word) for word in words):
        raise DatagramError("malformed")
    opcode, *arguments = map(int, words)
    if opcode not in program:
        raise DatagramError("unknown opcode")
    spans = program[opcode]
    if len(arguments) != len(spans):
        raise DatagramError("malformed")
    if opcode == REFERENCE and arguments[0] == THRUST_MOTOR:
        spans = (MOTOR, (0, FULL))
    if not all(low <= value <= high for value, (low, high) in zip(arguments, spans, strict=True)):
        raise DatagramError("out of range")
    return Command(opcode, tuple(arguments))


def throttle_reference(throttle: float) -> int:
    """Reference of the thrust motor for a throttle [1], held within [0, 1]."""
    return round(FULL * min(max(throttle, 0.0), 1.0))
