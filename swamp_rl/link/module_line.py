"""The telemetry line of a thruster module, see `swamp_rl.runs.thruster_telemetry`: written and read."""

from collections.abc import Sequence
from typing import NamedTuple

from swamp_rl.link.protocol import INT32
from swamp_rl.link.sensor_line import END
from swamp_rl.runs.thruster_telemetry import FULL, is_module_line


class ModuleLine(NamedTuple):
    """The fields in the order of `MODULE_FIELDS`."""

    sender: int
    utc: int
    thrust_power: int
    thrust_enabled: int
    thrust_reference: int
    thrust_actual: int
    azimuth_power: int
    azimuth_enabled: int
    azimuth_reference: int
    azimuth_actual: int


def module_line(line: ModuleLine) -> str:
    """The packet's text."""
    return " ".join(map(str, line)) + END


def read_module_line(words: Sequence[str]) -> ModuleLine:
    """The line of those words; ValueError for any other, and for references out of range."""
    if not is_module_line(words) or any(len(word) > 20 for word in words):
        raise ValueError("not a module's line")
    line = ModuleLine(*map(int, words))
    whole = 0 <= line.thrust_reference <= FULL and INT32[0] <= line.azimuth_reference <= INT32[1]
    if not whole:
        raise ValueError("a reference that no module takes")
    return line
