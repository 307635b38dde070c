"""How the fields of a log become columns of a run: options of the command line, or a YAML file."""

import re
from collections.abc import Mapping as Mapped
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError, errors_at
from swamp_rl.files import read_yaml, validated
from swamp_rl.logs.expression import Node, names_in, parsed
from swamp_rl.names import is_yaml
from swamp_rl.units import UNITS

Frame = Literal["ned", "enu"]
WITH_AXES = ("x", "y", "yaw", "qw", "qx", "qy", "qz", "vx", "vy", "u", "v", "r")
"""Quantities that a frame gives the axes of."""
COLUMN = re.compile(r"[A-Za-z_]\w{0,99}|\w{1,100}\.time", re.ASCII)
"""A column of a run, or the times of one table."""
OPTION = re.compile(rf"\s*({COLUMN.pattern})\s*=(?!=)(.*)", re.ASCII | re.DOTALL)
MOST_COLUMNS = 200


class Given(BaseModel):
    """A column: `value` an expression or a number, given alone or with a `unit`, one of UNITS."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    value: str | float
    unit: str | None = None

    @model_validator(mode="before")
    @classmethod
    def _alone(cls, given: Any) -> Any:
        return {"value": given} if isinstance(given, str | int | float) else given

    @field_validator("unit")
    @classmethod
    def _is_known(cls, unit: str | None) -> str | None:
        if unit is not None and unit not in UNITS:
            raise ValueError(f"{clipped(unit)!r} is none; known units are {', '.join(UNITS)}")
        return unit


class MappingFile(BaseModel):
    """A mapping as a file: `columns` by our names, of the times of one table `TABLE.time`, the `frame` of x,
    y, yaw, vx, vy, u, v, r (by default that of the log's format), and `clock`: pairs of expressions `A ~ B`
    of one quantity in two tables, whose clocks are compared."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    columns: Annotated[dict[str, Given], Field(min_length=1, max_length=MOST_COLUMNS)]
    frame: Frame | None = None
    clock: Annotated[list[str], Field(max_length=20)] = []

    @field_validator("columns")
    @classmethod
    def _are_columns(cls, columns: dict[str, Given]) -> dict[str, Given]:
        for name in columns:
            if not COLUMN.fullmatch(name):
                raise ValueError(f"{name[:60]!r} is not a column name: letters, digits and underscores")
        return columns


@dataclass(frozen=True)
class Pair:
    """Expressions of one quantity in two tables, and what names the pair in a message."""

    where: str
    one: Node
    other: Node


@dataclass(frozen=True)
class Mapping:
    """`columns`: expressions by our names; `units`: what they are in, by our names; `frames`: by our names,
    those of columns that are in another one than `frame`; the rest as in `MappingFile`."""

    columns: Mapped[str, Node] = field(default_factory=dict)
    units: Mapped[str, str] = field(default_factory=dict)
    frame: Frame | None = None
    clock: Sequence[Pair] = ()
    frames: Mapped[str, Frame] = field(default_factory=dict)

    def time_of(self, table: str) -> str:
        """The name that the times of a table have: its own, `TABLE.time`, where the mapping gives them."""
        return own if (own := f"{table}.time") in self.columns else "time"

    @property
    def names(self) -> set[str]:
        """The columns of the log that its expressions read, as `TABLE.COLUMN` or `COLUMN`."""
        clocks = [node for pair in self.clock for node in (pair.one, pair.other)]
        return {name for node in (*self.columns.values(), *clocks) for name in names_in(node)}

    def frame_of(self, name: str) -> Frame:
        """The frame of a column, of the yaw that of the quaternion it comes from."""
        name = "qw" if name == "yaw" and "qw" in self.columns else name
        return self.frames.get(name) or self.frame or "ned"

    def over(self, other: "Mapping") -> "Mapping":
        """This mapping, and what `other` says of columns that this does not have; its frame is of those of
        this, too, where this gives none."""
        added = other.columns.keys() - self.columns.keys()
        return Mapping(
            {**other.columns, **self.columns},
            {**{name: unit for name, unit in other.units.items() if name in added}, **self.units},
            self.frame or other.frame,
            self.clock or other.clock,
            {**{name: other.frame_of(name) for name in added}, **self.frames},
        )


def mapping_of(options: Sequence[str], frame: Frame | None = None, clock: Sequence[str] = ()) -> Mapping:
    """The mapping that `--map` gives: OUR=EXPRESSION, or names of YAML files; what comes later holds.

    UserError where one is neither, a column is given twice on the command line, or none is in the `frame`.
    """
    columns: dict[str, Node] = {}
    units: dict[str, str] = {}
    given: set[str] = set()
    frame_of_file: Frame | None = None
    clocks = [_pair(f"--clock {clipped(pair)}", pair) for pair in clock]
    for option in options:
        if found := OPTION.fullmatch(option):
            name = found[1]
            if name in given:
                raise UserError(f"--map {name}: is given twice; leave one out")
            given.add(name)
            columns[name] = _column(f"--map {name}", name, found[2])
            units.pop(name, None)
            continue
        file = _file(option)
        frame_of_file = file.frame or frame_of_file
        clocks += [_pair(f"{option}: clock", pair) for pair in file.clock]
        for name, whole in file.columns.items():
            if name in given:
                continue
            columns[name] = _column(f"{option}: columns.{name}", name, str(whole.value))
            units.pop(name, None)
            units |= {name: whole.unit} if whole.unit else {}
    if frame is not None and not columns.keys() & set(WITH_AXES):
        raise UserError(
            f"--frame {frame}: is of columns that --map gives, and none is {', '.join(WITH_AXES)}; leave it "
            "out, or map these"
        )
    return Mapping(columns, units, frame or frame_of_file, tuple(clocks))


def is_time(name: str) -> bool:
    """Whether a name of a mapping is that of times, of all tables or of one."""
    return name.rpartition(".")[2] == "time"


def _column(where: str, name: str, text: str) -> Node:
    with errors_at(where):
        return parsed(text, timed=not is_time(name))


def _pair(where: str, text: str) -> Pair:
    one, sign, other = text.partition("~")
    if not sign:
        raise UserError(f"{where}: give one quantity of two tables, as in 'IMU.GyrZ ~ turn_rate(ATT.Yaw)'")
    with errors_at(where):
        return Pair(where, parsed(one.strip()), parsed(other.strip()))


def _file(option: str) -> MappingFile:
    path = Path(option)
    if not is_yaml(path):
        raise UserError(
            f"--map {clipped(option)}: give COLUMN=EXPRESSION, as in throttle_left='(pwm_left-1500)/400', "
            "or a .yaml file"
        )
    return validated(path, MappingFile, read_yaml(path))
