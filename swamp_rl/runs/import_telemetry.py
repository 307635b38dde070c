"""The telemetry that the SWAMP sends: one line of 40 numbers for each packet (thesis 6.2).

Units are the sensor's own: radians, degrees for the place and for the course over ground, m, m/s, g. Lines of
the thruster modules between them (`thruster_telemetry`) give the run its commands.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import turned
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.files import os_error
from swamp_rl.ordinary import contents
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.schema import RunMeta
from swamp_rl.runs.stamps import EPOCHS
from swamp_rl.runs.table import Table
from swamp_rl.runs.thruster_telemetry import MODULE_FIELDS, command_columns, is_module_line

Array = NDArray[np.float64]

FIELDS = (
    "sender",
    "yaw",
    "pitch",
    "roll",
    "latitude",
    "longitude",
    "height_above_ellipsoid",
    "height_above_sea",
    "horizontal_accuracy",
    "vertical_accuracy",
    "position_flags",
    *(f"{what}_{axis}" for what in ("acceleration", "gyro", "magnetic") for axis in "xyz"),
    *(f"orientation_{row}{column}" for row in "123" for column in "123"),
    "velocity_north",
    "velocity_east",
    "velocity_down",
    "speed",
    "ground_speed",
    "course_over_ground",
    "speed_accuracy",
    "velocity_flags",
    "course_accuracy",
    "utc",
    "utc_flags",
)
WHOLE = ("sender", "position_flags", "velocity_flags", "utc", "utc_flags")
SIGNED = ("azimuth_reference", "azimuth_actual")
LONGEST_WORD = 40
"""Characters of a number."""
VALID = 1
"""Bit of the flags, by the sensor's protocol: latitude and longitude, or the velocities, can be used."""


def read_telemetry(
    path: Path, sender: int | None = None, degrees: bool = False, boat: Boat | None = None
) -> Foreign:
    """A file of such lines as a table; UserError with line and field for the first that is wrong.

    Times are from the first line's stamp. sender: whose lines to take, where the file holds several hulls'.
    degrees: yaw, pitch and roll are in degrees there; the table has radians. boat: whose thrusters the lines
    of modules are of; None: these are left out.
    Every field but sender and stamp is kept, under the names of `FIELDS`.
    """
    numbers, words, modules = _lines(path)
    senders = sorted({int(line[0]) for line in words})
    if sender is None and len(senders) > 1:
        raise UserError(f"{path}: lines of senders {senders}; choose one of them: --sender {senders[0]}")
    chosen = [i for i, line in enumerate(words) if sender in (None, int(line[0]))]
    if not chosen:
        raise UserError(f"{path}: no line of sender {sender}; it has {senders}")
    lines = np.array([numbers[i] for i in chosen], np.int64)
    values = dict(zip(FIELDS, np.array([words[i] for i in chosen], float).T, strict=True))
    _refuse_invalid(path, lines, values)
    if degrees:
        values |= {name: np.radians(values[name]) for name in ("yaw", "pitch", "roll")}
    else:
        _refuse_degrees(path, values)
    stamps = [int(words[i][FIELDS.index("utc")]) for i in chosen]
    ticks = _ticks(path, lines[0], stamps[0])
    time = np.array([stamp - stamps[0] for stamp in stamps], float) / ticks
    columns = {"time": time, "heading": values["yaw"], **velocity(values)}
    if boat is not None:
        columns |= command_columns(_by_sender(modules, stamps[0] * 10**6 // ticks), time, boat)
    kept = {name: column for name, column in values.items() if name not in ("sender", "utc", "yaw")}
    metadata = {"utc_start": stamps[0] / ticks, "sender": int(words[chosen[0]][0]), "velocity_axes": "earth"}
    return Foreign(path.name, path.stem, Table(columns | kept, lines), RunMeta.model_validate(metadata))


def _by_sender(modules: list[list[int]], start: int) -> dict[int, Array]:
    """Module lines (L, 10) by sender in the order of their stamps, made times [s] from `start` [µs]."""
    stamp = MODULE_FIELDS.index("utc")
    found: dict[int, list[list[float]]] = {}
    for line in sorted(modules, key=lambda line: line[stamp]):
        found.setdefault(line[0], []).append([line[0], (line[stamp] - start) / 1e6, *line[stamp + 1 :]])
    return {sender: np.array(own, float) for sender, own in found.items()}


def _lines(path: Path) -> tuple[list[int], list[list[str]], list[list[int]]]:
    """Numbers from 1 and words of the lines of 40 finite numbers; the numbers of the modules' lines."""
    try:
        # Packets are C strings; a log of them may keep the byte that ends each.
        text = contents(path).replace(b"\0", b"").decode("ascii")
    except OSError as error:
        raise os_error(error, path) from error
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: byte {error.start} is not text; name a file of telemetry lines") from error
    numbers, words, modules = [], [], []
    for number, line in enumerate(text.splitlines(), 1):
        found = line.split()
        if not found:
            continue
        if is_module_line(found):
            for i, word in enumerate(found):
                _refuse_word(path, number, i, word, MODULE_FIELDS, MODULE_FIELDS)
            modules.append([int(word) for word in found])
            continue
        if len(found) != len(FIELDS):
            raise UserError(
                f"{path}: line {number} has {len(found)} fields, a telemetry line has {len(FIELDS)}; "
                "complete or remove it"
            )
        for i, word in enumerate(found):
            _refuse_word(path, number, i, word, FIELDS, WHOLE)
        numbers.append(number)
        words.append(found)
    if not words:
        raise UserError(f"{path}: holds no line; name a file of telemetry lines")
    return numbers, words, modules


def _refuse_word(
    path: Path, number: int, index: int, word: str, names: Sequence[str], wholes: Sequence[str]
) -> None:
    whole, signed = names[index] in wholes, names[index] in SIGNED
    try:
        good = (
            "_" not in word
            and len(word) <= LONGEST_WORD
            and (int(word) >= 0 or signed if whole else np.isfinite(float(word)))
        )
    except ValueError:
        good = False
    if not good:
        kind = "whole number" if whole else "number"
        raise UserError(
            f"{path}: line {number}, field {index + 1} ({names[index]}): {word[:40]!r} is no {kind}; "
            "correct it"
        )


def _refuse_invalid(path: Path, lines: NDArray[np.int64], values: dict[str, Array]) -> None:
    for what, flags in (("position", "position_flags"), ("velocity", "velocity_flags")):
        bad = np.flatnonzero(values[flags].astype(np.int64) & VALID == 0)
        if len(bad):
            raise UserError(
                f"{path}: line {lines[bad[0]]}, field {FIELDS.index(flags) + 1} ({flags}): the GPS marks "
                f"its {what} as not valid, in {len(bad)} line(s); cut these lines out"
            )


def _refuse_degrees(path: Path, values: dict[str, Array]) -> None:
    """The matrix holds cos(yaw) cos(pitch), whichever way it is written, and so tells the angles' unit."""
    angles = values["orientation_11"]
    radians = np.cos(values["yaw"]) * np.cos(values["pitch"])
    degrees = np.cos(np.radians(values["yaw"])) * np.cos(np.radians(values["pitch"]))
    if np.abs(degrees - angles).max() < 0.01 < np.abs(radians - angles).max():
        raise UserError(
            f"{path}: field 2 (yaw) is in degrees, as the orientation matrix shows; add --degrees heading"
        )


def _ticks(path: Path, line: int, stamp: int) -> int:
    for ticks, (low, high) in EPOCHS.items():
        if low <= stamp < high:
            return ticks
    raise UserError(
        f"{path}: line {line}, field {FIELDS.index('utc') + 1} (utc): {stamp} is not a time since "
        "1970 in s, ms, µs or ns; correct it"
    )


def velocity(values: dict[str, Array]) -> dict[str, Array]:
    """Over ground, in the boat's axes; the sensor's z axis points down, so its gyro counts clockwise."""
    surge, sway = turned(values["velocity_north"], values["velocity_east"], -values["yaw"])
    return {"surge": surge, "sway": sway, "yaw_rate": values["gyro_z"]}
