"""A mapping that the names of a table's columns suggest, for a person to check."""

import math
import re
import shlex
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.logs.defaults import default_columns
from swamp_rl.logs.expression import names_in, parsed
from swamp_rl.logs.log import Array, Log
from swamp_rl.logs.mapping import Mapping as LogMapping
from swamp_rl.runs.check import LARGEST_RUDDER, TURN, counts_turns
from swamp_rl.runs.columns import command_columns, command_limits
from swamp_rl.runs.geographic import MOST_LATITUDE, in_degrees
from swamp_rl.runs.import_foreign import in_expression
from swamp_rl.runs.stamps import from_numbers
from swamp_rl.runs.units import factor

WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|[0-9]+|%|°")
UNITS = {
    "deg": "deg degree degrees °",
    "deg/s": "dps degs",
    "kn": "kn knot knots kt kts",
    "km/h": "kmh kph",
    "percent": "percent pct %",
    "rpm": "rpm",
    "cm": "cm",
    "mm": "mm",
    "ms": "ms",
    "us": "us",
    "ns": "ns",
    "": "rad rads m s mps rps",
}
"""Words for units by what `--unit` calls them; none is needed of SI units."""
SAME = {
    "time": "timestamp stamp sec secs seconds epoch",
    "lat": "latitude",
    "lon": "longitude long lng",
    "north": "n northing",
    "east": "e easting",
    "heading": "hdg",
    "position": "pos",
    "velocity": "vel velocities speed",
    "gyro": "gyr omega",
    "port": "left",
    "starboard": "right stbd stb",
    "throttle": "motor thrust thruster",
    "azimuth": "steering azi azim",
}
"""Other words for a word."""
PERCENT = "percent"
SOURCES = "ahrs baro data ekf est estimated fix fused gnss gps imu ins meas measured nav original raw ros usv"
"""Words for where a quantity is from, which are left out."""
NAMES = {
    "time": "time, t, ts, tvec, utc, datetime, date time, utc time",
    "latitude": "lat, position lat",
    "longitude": "lon, position lon",
    "north": "north, position north",
    "east": "east, position east",
    "x": "x, position x",
    "y": "y, position y",
    "heading": "heading, yaw, psi, compass, compass heading, yaw angle, heading angle",
    "velocity_north": "velocity north, vn, v north",
    "velocity_east": "velocity east, ve, v east",
    "u": "u, surge, surge velocity",
    "v": "sway, sway velocity",
    "yaw_rate": "yaw rate, yawrate, rate z, gyro z, gz, wz, turn rate",
}
"""Words of names by the quantities of a mapping, without units and sources."""
BESIDE_SURGE = {"v": "v", "r": "yaw_rate"}
"""Names of columns that are the sway and the yaw rate beside a column `u`, and may be anything without; by
each the name in NAMES of what it is."""
POSITIONS = ("latitude", "longitude"), ("north", "east"), ("x", "y")
REQUIRED_POSITION = POSITIONS[1]  # of the run format
VELOCITY = "velocity_north", "velocity_east"
"""Quantities of which one alone is none; the first position that is there is taken."""
TIMES = NAMES["time"].split(", ")
LONGEST = 100
"""Characters of a name that is suggested."""
OF_TIME = "ms", "us", "ns"
"""Units that are those of a time; in the name of a velocity, `ms` is m/s."""
UNIT_OF, WORD_OF = (
    {other: word for word, others in table.items() for other in others.split()} for table in (UNITS, SAME)
)


@dataclass(frozen=True)
class Suggestion:
    """A column that may be a quantity, named as in an expression, and its unit, empty where none is named;
    formula: of the column `{}`, where a unit alone does not give the quantity."""

    column: str
    unit: str
    formula: str = "{}"

    def of_limit(self, most: float) -> "Suggestion":
        """This one as a percentage of a command's limit [rad or rps]."""
        return replace(self, unit="", formula=f"{{}}/100*{most:.9g}")


def proposal(log: Log, boat: Boat) -> list[str]:
    """Lines: the options that the names suggest, and what has none; no lines for a run of a dataset."""
    suggested = {} if log.home is not None else _suggested(log, boat)
    if not suggested:
        return []
    there = {"time" if name.endswith(".time") else name for name in suggested}
    wanted = ("time", *(_position(there) or REQUIRED_POSITION), "heading", *command_columns(boat))
    lacking = [name for name in wanted if name not in there]
    lines = [f"by their names, to be checked: {' '.join(_options(suggested))}"]
    return lines + [f"not found by name: {', '.join(lacking)}"] * bool(lacking)


def taken_by_default(kind: str, log: Log, boat: Boat) -> list[str]:
    """Lines: from which messages an import of a binary log takes what, and what it lacks."""
    try:
        columns = default_columns(kind, log, LogMapping(), boat)
    except UserError as error:
        return [str(error).removeprefix(f"{log.file}: ")]
    tables: dict[str, list[str]] = {}
    for name, text in columns.items():
        messages = dict.fromkeys(one.partition(".")[0] for one in names_in(parsed(text)))
        tables.setdefault(" and ".join(messages), []).append(name)
    wanted: dict[str, tuple[str, ...]] = {
        "position": ("latitude", "north", "x"),
        "heading": ("heading", "yaw", "qw"),
    }
    wanted |= {name: (name,) for name in command_columns(boat)}
    lacking = [what for what, names in wanted.items() if not columns.keys() & set(names)]
    found = "; ".join(f"{', '.join(names)} from {clipped(table)}" for table, names in tables.items())
    lines = [f"taken without --map: {found}"] * bool(found)
    return lines + [f"not found, needs --map: {', '.join(lacking)}"] * bool(lacking)


def _position(there: Collection[str]) -> tuple[str, ...]:
    """The first pair of coordinates that is there."""
    return next((pair for pair in POSITIONS if set(pair) <= set(there)), ())


def _suggested(log: Log, boat: Boat) -> dict[str, Suggestion]:
    """The columns of a log that by their names are quantities or commands of the boat."""
    several = len(log.tables) > 1
    values = {
        f"{table.name}.{column}" if several else column: numbers
        for table in log.tables.values()
        for column, numbers in table.table.columns.items()
        if len(column) <= LONGEST and column.isprintable() and "`" not in column
    }
    there = [
        (Suggestion(column, unit), words)
        for column, numbers in values.items()
        for words, unit in [_words_of(column.partition(".")[2] if several else column, numbers)]
    ]
    found: dict[str, Suggestion] = {}
    for name, known in NAMES.items():
        fitting = [one for one, words in there if words in map(_set_of, known.split(", "))]
        if fitting and name == "time" and several:
            found |= _times(fitting)
        elif fitting:
            found[name] = fitting[0]
    found = _with_places(found, values) | _beside_surge(found, there)
    kept = {*_position(found), *(VELOCITY if found.keys() >= set(VELOCITY) else ())}
    left_out = {name for pair in (*POSITIONS, VELOCITY) for name in pair} - kept
    return {name: one for name, one in found.items() if name not in left_out} | _commands(there, boat)


def _beside_surge(
    found: Mapping[str, Suggestion], there: Sequence[tuple[Suggestion, frozenset[str]]]
) -> dict[str, Suggestion]:
    """The columns of BESIDE_SURGE in the table of a surge that is `u`; a yaw rate whose name has no unit is
    in deg/s beside a heading in deg."""
    if "u" not in found:
        return {}
    table, _, _ = found["u"].column.rpartition(".")
    named = {words: one for one, words in reversed(there) if one.column.rpartition(".")[0] == table}
    if named.get(frozenset("u")) != found["u"]:
        return {}
    wanted = [(name, frozenset(name)) for name, other in BESIDE_SURGE.items() if other not in found]
    beside = {name: named[words] for name, words in wanted if words in named}
    if "r" in beside and "heading" in found and found["heading"].unit == "deg":
        (*_, last) = WORD.findall(beside["r"].column)
        beside["r"] = replace(beside["r"], unit="deg/s") if last.lower() == "r" else beside["r"]
    return beside


def _with_places(found: dict[str, Suggestion], values: Mapping[str, Array]) -> dict[str, Suggestion]:
    """The suggestions, a position in degrees as latitude and longitude; of values (T,) by column."""
    pair = _position(found)
    columns = [found[name] for name in pair]
    if not pair or pair == POSITIONS[0] or not in_degrees(*(values[one.column] for one in columns)):
        return found
    if np.nanmedian(np.abs(values[columns[0].column])) > MOST_LATITUDE:
        columns.reverse()
    return found | dict(zip(POSITIONS[0], columns, strict=True))


def _times(fitting: Sequence[Suggestion]) -> dict[str, Suggestion]:
    """The times of several tables: one name that is in all, or each table's own."""
    first: dict[str, Suggestion] = {}
    for one in fitting:
        table, _, column = one.column.partition(".")
        first.setdefault(f"{table}.time", Suggestion(column, one.unit))
    alike = set(first.values())
    return {"time": alike.pop()} if len(alike) == 1 else first


def _commands(there: Iterable[tuple[Suggestion, frozenset[str]]], boat: Boat) -> dict[str, Suggestion]:
    """Columns that have words of the name of one command alone, the first of which is its kind."""
    limits, found = command_limits(boat), dict[str, Suggestion]()
    for one, words in there:
        percent = one.unit == PERCENT
        fitting = [name for name in limits if _is_named(name, words, percent)]
        if len(fitting) != 1:
            continue
        (name,) = fitting
        if percent and not name.startswith("throttle_"):
            one = one.of_limit(limits[name])
        if not (percent and math.isinf(limits[name])):
            found.setdefault(name, one)
    return found


def _is_named(command: str, words: frozenset[str], percent: bool) -> bool:
    """Whether words of a column's name are of a command, and one of them is its kind; revolutions in percent
    are also named throttle."""
    kinds = {command.split("_")[0]}
    if percent and command.startswith("propeller_"):
        kinds.add("throttle")
    return bool(kinds & words) and words <= _set_of(command.replace("_", " ")) | kinds


def _words_of(column: str, values: Array) -> tuple[frozenset[str], str]:
    """The words of a column's name without its unit and source, and the unit, that of its values where the
    name has none."""
    words = [word.lower() for word in WORD.findall(column)]
    units = [UNIT_OF[word] for word in words[1:] if word in UNIT_OF]
    unit = "deg/s" if "deg" in units and words[-1] == "s" else next(filter(None, units), "")
    plain = words[:1] + [word for word in words[1:] if word not in UNIT_OF]
    kept = [word for word in plain if word not in SOURCES.split()] or plain
    named = _set_of(" ".join(kept))
    return named, unit or _unit_of_values(named, values)


def _unit_of_values(named: frozenset[str], values: Array) -> str:
    """The unit of a time or an angle whose name has none, by its values."""
    if named in map(_set_of, TIMES):
        return _unit_of_steps(values)
    known = np.abs(values[np.isfinite(values)])
    largest = float(known.max()) if len(known) else 0.0
    if "rudder" in named:
        return "deg" if LARGEST_RUDDER < largest <= math.degrees(LARGEST_RUDDER) else ""
    is_azimuth = "azimuth" in named and largest <= math.degrees(TURN)  # and no pulse width
    is_angle = is_azimuth or named in map(_set_of, NAMES["heading"].split(", "))
    return "deg" if is_angle and largest > TURN and not counts_turns(values, None, farthest=TURN) else ""


def _unit_of_steps(stamps: Array) -> str:
    """The first of seconds (empty) and `OF_TIME` in which times are as far apart as an import takes them."""
    for unit in ("", *OF_TIME):
        with suppress(UserError):
            from_numbers(stamps, "", factor("time", unit) if unit else None)
            return unit
    return ""


def _set_of(words: str) -> frozenset[str]:
    return frozenset(WORD_OF.get(word, word) for word in words.split())


def _options(suggested: dict[str, Suggestion]) -> Iterator[str]:
    for name, one in suggested.items():
        yield f"--map {shlex.quote(f'{name}={one.formula.format(in_expression(one.column))}')}"
        if one.unit and name not in POSITIONS[0] and (one.unit in OF_TIME) == name.endswith("time"):
            yield f"--unit {name}={one.unit}"
