"""A plan of trials: what its YAML may hold, strictly, and the single trials that it stands for."""

import math
from collections.abc import Mapping
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from swamp_rl.boat.part import FILLED, FROM_LIST, NAME, Part
from swamp_rl.constants import LEAST_THROTTLE
from swamp_rl.files import find_config, read_yaml, validated
from swamp_rl.manoeuvres.approach import Area
from swamp_rl.manoeuvres.controller import Kind, Pattern, Trial

Degrees = Annotated[float, Field(ge=-90.0, le=90.0)]
Share = Annotated[float, Field(ge=LEAST_THROTTLE, le=1.0)]
Positive = Annotated[float, Field(gt=0.0)]


Several = Annotated[tuple[Positive, ...], FROM_LIST, FILLED]

STEERED = {"angle_deg", "pattern"}
KEYS: dict[Kind, set[str]] = {  # what an entry may hold beside the throttle, by manoeuvre
    "turning-circle": STEERED | {"turns", "duration_s"},
    "zig-zag": STEERED | {"heading_deg", "executes"},
    "spiral": STEERED,
    "reverse-spiral": STEERED,
    "pull-out": STEERED | {"duration_s"},
    "stopping": {"astern_throttle"},
    "straight": {"astern", "duration_s", "pattern"},
}
COMMON = {"manoeuvre", "throttle", "rpm", "start_speed"}


class Entry(Part):
    """One manoeuvre at every pair of the given angles and throttles (or rpm, by the plan's full_rpm).

    angle_deg: positive first to starboard; heading_deg: where a zig-zag reverses, one for each angle, the
    angle itself by default; start_speed [m/s]: what the approach must reach, else the results say so.
    """

    manoeuvre: Kind
    throttle: Annotated[tuple[Share, ...], FROM_LIST, FILLED] | None = None
    rpm: Several | None = None
    angle_deg: Annotated[tuple[Degrees, ...], FROM_LIST, FILLED] | None = None
    heading_deg: Several | None = None
    pattern: Pattern = "opposed"
    turns: Annotated[int, Field(ge=1, le=20)] = 6
    executes: Annotated[int, Field(ge=2, le=40)] = 6
    duration_s: Annotated[float, Field(gt=0.0, le=600.0)] = 30.0
    astern: bool = False
    astern_throttle: Share = 1.0
    start_speed: Positive | None = None

    @model_validator(mode="after")
    def _asks_for_what_the_manoeuvre_has(self) -> Self:
        alien = sorted(self.model_fields_set - COMMON - KEYS[self.manoeuvre])
        if alien:
            raise ValueError(f"{alien[0]}: {self.manoeuvre} has no such key; drop it")
        if (self.throttle is None) == (self.rpm is None):
            raise ValueError("throttle: give either it or rpm")
        if "angle_deg" in KEYS[self.manoeuvre]:
            if self.angle_deg is None:
                raise ValueError("angle_deg is missing; add it")
            if 0.0 in self.angle_deg:
                raise ValueError("angle_deg: 0 steers nowhere; leave it out")
        if self.heading_deg is not None and len(self.heading_deg) != len(self.angle_deg or ()):
            raise ValueError("heading_deg: give one for each of angle_deg")
        return self


class AreaPart(Part):
    """Where the trials take place: the centre [m] and the direction [degrees] in which they begin."""

    north: float = 0.0
    east: float = 0.0
    direction_deg: float = 0.0


class Plan(Part):
    """A plan file, whole. full_rpm: what the rpm of the entries are a share of."""

    name: Annotated[str, NAME]
    description: str = ""
    boat: str
    area: AreaPart = AreaPart()
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    full_rpm: Positive | None = None
    trials: Annotated[tuple[Entry, ...], FROM_LIST, FILLED]

    @model_validator(mode="after")
    def _rpm_are_shares(self) -> Self:
        for number, entry in enumerate(self.trials):
            if entry.rpm is None:
                continue
            if self.full_rpm is None:
                raise ValueError(f"trials.{number}.rpm needs full_rpm at the top of the plan; add it")
            if max(entry.rpm) > self.full_rpm:
                raise ValueError(f"trials.{number}.rpm: {max(entry.rpm):g} is beyond full_rpm")
        return self

    @property
    def place(self) -> Area:
        """The area in SI units."""
        return Area(self.area.north, self.area.east, math.radians(self.area.direction_deg))

    @property
    def singly(self) -> list[Trial]:
        """Every single trial of the plan, in the file's order."""
        return [trial for entry in self.trials for trial in _singly(entry, self.full_rpm)]


def _singly(entry: Entry, full_rpm: float | None) -> list[Trial]:
    throttles = entry.throttle or tuple(rpm / (full_rpm or 1.0) for rpm in entry.rpm or ())
    angles = entry.angle_deg or (0.0,)
    headings = entry.heading_deg or tuple(abs(angle) for angle in angles)
    return [
        Trial(
            kind=entry.manoeuvre,
            throttle=throttle,
            angle=math.radians(angle),
            heading=math.radians(heading) if entry.manoeuvre == "zig-zag" else 0.0,
            pattern=entry.pattern,
            turns=entry.turns,
            executes=entry.executes,
            duration=entry.duration_s,
            astern=entry.astern,
            astern_throttle=entry.astern_throttle,
            start_speed=entry.start_speed,
        )
        for (angle, heading), throttle in product(zip(angles, headings, strict=True), throttles)
    ]


def load_plan(name_or_path: str | Path) -> Plan:
    """The plan of a file in configs/trials by its bare name, or of any file by its path.

    UserError with file and key if it is missing, malformed or asks for what no trial has.
    """
    path = find_config("trials", name_or_path)
    data: Mapping[str, Any] = read_yaml(path)
    return validated(path, Plan, data)
