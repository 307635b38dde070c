"""The commands in a binary log where no mapping is given: outputs whose place on the boat is in the log."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from swamp_rl.boat import Boat, PropellerRudder, Thruster
from swamp_rl.logs.log import Log

NUMBERS = ("std_msgs/Float32", "std_msgs/Float64")
MOTORS, SERVOS, OUTPUTS = "actuator_motors", "actuator_servos", "actuator_outputs"
LEVERS = "manual_control_setpoint"
INSTANCES = ("", "_1", "_2", "_3")
MESSAGES = {
    "dataflash": ("RCOU", "PARM"),
    "ulog": (MOTORS, SERVOS, LEVERS, *(f"{OUTPUTS}{number}" for number in INSTANCES)),
    "rosbag": (),
}
"""Tables that hold commands, by the format."""
ARDUPILOT = {73.0: "left", 74.0: "right", 70.0: "throttle", 26.0: "steering"}
"""SERVOn_FUNCTION: ThrottleLeft, ThrottleRight, Throttle, GroundSteering."""
PX4 = {101: "right", 102: "left", 201: "steering"}
"""PWM_MAIN_FUNCn: motors 1 and 2, which a differential drive has on the right and the left, and servo 1."""
MOST_OUTPUTS = 14
PULSES = "1100", "1900", "1500"
"""µs of ArduPilot's outputs at full astern, full ahead and rest, where the log has no parameter."""
BELOW = 0.05
"""Of an output's range: a pulse so far below its low end commands nothing (0, or that of a disarmed boat)."""


@dataclass(frozen=True)
class Drive:
    """How a boat is steered by two shares [-1, 1]: `columns` by the role of an output, as expressions with
    SHARE in its place; `single`: one thruster, with `throttle` and `steering`."""

    columns: Mapping[str, tuple[str, str]]
    single: bool


def commands(kind: str, log: Log, boat: Boat) -> dict[str, str]:
    """Expressions of the boat's commands and of the pilot's levers; none where their place is not certain."""
    if kind == "rosbag":
        return _topics(log, boat)
    drive = _drive(boat)
    levers = _levers(log) if kind == "ulog" else {}
    if drive is None:
        return levers
    shares = _ardupilot_shares(log) if kind == "dataflash" else _px4_shares(log, drive.single)
    if not set(drive.columns) <= set(shares):
        return levers
    columns = {name: text.replace("SHARE", shares[role]) for role, (name, text) in drive.columns.items()}
    return levers | columns


def _drive(boat: Boat) -> Drive | None:
    """Of two fixed thrusters side by side, a propeller with rudder, or one azimuth thruster."""
    fixed = [one for one in boat.thrusters if one.kind == "fixed"]
    if len(boat.thrusters) == len(fixed) == 2 and fixed[0].y * fixed[1].y < 0.0:
        return Drive({("left" if one.y < 0.0 else "right"): _level(one) for one in fixed}, False)
    if len(boat.thrusters) != 1 or fixed:
        return None
    (only,) = boat.thrusters
    turn = only.command_columns[0]
    if isinstance(only, PropellerRudder):
        steering = f"SHARE * {only.rudder_max:.9g}"
    else:
        steering = f"{'-' if only.x < 0.0 else ''}(SHARE) * {only.azimuth_max:.9g}"
    return Drive({"throttle": _level(only), "steering": (str(turn), steering)}, True)


def _level(thruster: Thruster | PropellerRudder) -> tuple[str, str]:
    """Column and expression of a thruster's level, of a share."""
    ahead, astern = thruster.throttle_max, -thruster.throttle_min
    if astern == 0.0:
        text = f"max(SHARE, 0) * {ahead:.9g}"
    else:
        text = (
            "SHARE"
            if ahead == astern == 1.0
            else f"max(SHARE, 0) * {ahead:.9g} + min(SHARE, 0) * {astern:.9g}"
        )
    return str(thruster.command_columns[1]), text


def _number(log: Log, name: str, usual: str) -> float:
    """A parameter's value; the usual one where the log has none that is a finite number."""
    try:
        value = float(log.metadata.get(f"parameter {name}", usual))
    except ValueError:
        return float(usual)
    return value if math.isfinite(value) else float(usual)


def _ardupilot_shares(log: Log) -> dict[str, str]:
    """Expressions of shares by role, from the functions, limits and trims of the outputs."""
    found: dict[str, str] = {}
    outputs = log.tables.get("RCOU")
    for number in range(1, MOST_OUTPUTS + 1):
        role = ARDUPILOT.get(_number(log, f"SERVO{number}_FUNCTION", "0"))
        if role is None or outputs is None or f"C{number}" not in outputs.table.columns:
            continue
        low, high, trim = (
            _number(log, f"SERVO{number}_{name}", usual)
            for name, usual in zip(("MIN", "MAX", "TRIM"), PULSES, strict=True)
        )
        sign = "-" if _number(log, f"SERVO{number}_REVERSED", "0") else ""
        share = _share(f"RCOU.C{number}", low, trim, high)
        if share:
            found[role] = f"{sign}{share}"
    return found


def _share(column: str, low: float, trim: float, high: float) -> str:
    """A pulse as a share of full: 0 at the trim and BELOW the low end, -1 at the low end.

    From 0 where the trim is the low end.
    """
    if not low <= trim < high:
        return ""
    if low == trim:
        return f"clip(({column} - {low:g}) / {high - low:g}, 0, 1)"
    pulse, least = f"{column} - {trim:g}", low - BELOW * (high - low)
    share = f"max({pulse}, 0) / {high - trim:g} + min({pulse}, 0) / {trim - low:g}"
    return f"where({column} < {least:g}, 0, clip({share}, -1, 1))"


def _px4_shares(log: Log, single: bool) -> dict[str, str]:
    """Expressions of shares by role: of the normalised actuators, else of the pulses that have a function."""
    roles = {101: "throttle", 201: "steering"} if single else _sides(log)
    found = {}
    for function, role in roles.items():
        table, index = (MOTORS, function - 101) if function < 201 else (SERVOS, function - 201)
        name = f"control[{index}]"
        if table in log.tables and np.isfinite(log.tables[table].table.columns.get(name, np.nan)).any():
            field = f"{table}.{name}"
            found[role] = f"where({field} == {field}, {field}, 0)"  # NaN is a stopped motor
    return found if len(found) == len(roles) else _px4_pulses(log, roles)


def _sides(log: Log) -> dict[int, str]:
    """Roles of the first two motors: by their place to starboard [m], else those of a differential drive."""
    places = [_number(log, f"CA_ROTOR{i}_PY", "0") for i in (0, 1)]
    if places[0] * places[1] < 0.0:
        return {101 + i: "left" if y < 0.0 else "right" for i, y in enumerate(places)}
    return {function: role for function, role in PX4.items() if function < 201}


def _px4_pulses(log: Log, roles: Mapping[int, str]) -> dict[str, str]:
    """The same of pulses [µs], of the only outputs that pulse in the channels that have the functions."""
    for bank in ("MAIN", "AUX"):
        channels = {
            roles[function]: number
            for number in range(1, MOST_OUTPUTS + 1)
            if (function := int(_number(log, f"PWM_{bank}_FUNC{number}", "0"))) in roles
        }
        tables = [name for name in (f"{OUTPUTS}{i}" for i in INSTANCES) if _pulses(log, name, channels)]
        if len(channels) != len(roles) or len(tables) != 1:
            continue
        found = {}
        for role, number in channels.items():
            low, high = (
                _number(log, f"PWM_{bank}_{end}{number}", usual)
                for end, usual in (("MIN", "1000"), ("MAX", "2000"))
            )
            forward_only = role != "steering" and not int(_number(log, "CA_R_REV", "0"))
            trim = low if forward_only else 0.5 * (low + high)
            found[role] = _share(f"{tables[0]}.output[{number - 1}]", low, trim, high)
        if all(found.values()):
            return found
    return {}


def _pulses(log: Log, name: str, channels: Mapping[str, int]) -> bool:
    """Whether a table has pulses of a servo in all of these channels."""
    table = log.tables.get(name)
    columns = {} if table is None else table.table.columns
    values = [columns.get(f"output[{number - 1}]", np.zeros(1)) for number in channels.values()]
    return bool(values) and all(500.0 < np.nanmax(one) < 2500.0 for one in values if len(one))


def _levers(log: Log) -> dict[str, str]:
    """PX4's levers: thrust [0, 1] and turn to starboard [-1, 1]; in older logs z and r."""
    columns = log.tables[LEVERS].table.columns if LEVERS in log.tables else {}
    for thrust, turn in (("throttle", "yaw"), ("z", "r")):
        if {thrust, turn} <= set(columns) and len(columns[thrust]) > 1:
            return {
                "joy_thrust": f"clip({LEVERS}.{thrust}, 0, 1)",
                "joy_angle": f"clip({LEVERS}.{turn}, -1, 1)",
            }
    return {}


def _topics(log: Log, boat: Boat) -> dict[str, str]:
    """ROS: topics of single numbers that bear the thrusters' names."""
    found = {}
    for thruster in boat.thrusters:
        for column in filter(None, thruster.command_columns):
            kind, _, name = column.partition("_")
            words = [
                table.name
                for table in log.tables.values()
                if table.kind in NUMBERS and name in re.split(r"[_/]", table.name.lower())
            ]
            exact = [word for word in words if kind in word.lower()] or (words if kind != "azimuth" else [])
            if len(exact) == 1:
                found[column] = f"{exact[0]}.data"
    names = {column for t in boat.thrusters for column in t.command_columns if column is not None}
    return found if set(found) == names else {}
