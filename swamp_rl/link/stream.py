"""Samples of a boat under way, commands and motion, from its link or from an MCAP file."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.link.addresses import addresses
from swamp_rl.link.module_line import ModuleLine, read_module_line
from swamp_rl.link.sensor_line import CAMOGLI, read_sensor_line, words_of
from swamp_rl.link.socket_link import PATIENCE, packets, socket_link
from swamp_rl.link.stamps import Stamps
from swamp_rl.runs.columns import command_columns
from swamp_rl.runs.import_foreign import Wishes, runs_from
from swamp_rl.runs.local_frame import Place
from swamp_rl.runs.mcap_files import read_mcap
from swamp_rl.runs.thruster_telemetry import FIRST_MODULE, FULL, azimuth_angle
from swamp_rl.simulator.replay import fixed_thrusters

Array = NDArray[np.float64]

SENSES = ("north", "east", "heading", "surge", "sway", "yaw_rate")
SENSELESS = 10.0
"""Times the patience after which a link is given up whose packets give no sample."""
REMEMBERED = 64
"""Module lines kept of each module, for packets that come in another order than they were sent."""


@dataclass(frozen=True)
class Sample:
    """One row of a run under way.

    time: [s] since the first sample; commands: (2K,) azimuths [rad], then throttles [1], in force half-way
    from this sample's time to the next one's; senses: (6,) in the order of `SENSES`: m, rad, m/s, rad/s.
    """

    time: float
    commands: Array
    senses: Array


def samples(
    source: str | Path,
    boat: Boat,
    topic: str | None = None,
    origin: Place = CAMOGLI,
    patience: float = PATIENCE,
) -> Iterator[Sample]:
    """Yield the samples of `boat` from `source`: a file FILE.mcap, or the address of a vehicle's link.

    A link yields each sample once the next has come, for until then its commands may change; it goes on until
    the caller stops it. topic: of an MCAP file with several; origin: of north and east [degrees] on a link.
    UserError for a file that is no run of the boat, for an address that is none, and where nothing comes from
    a link for `patience` [s], or no sample for ten times as long.
    """
    if str(source).lower().endswith(".mcap"):
        yield from mcap_samples(Path(source), boat, topic)
    else:
        yield from link_samples(str(source), boat, origin, patience)


def mcap_samples(path: Path, boat: Boat, topic: str | None = None) -> Iterator[Sample]:
    """Yield the rows of a run in an MCAP file, as `runs export --to mcap` writes it."""
    found = read_mcap(path, topic)
    for column in command_columns(boat):
        if column not in found.table.columns:
            raise UserError(
                f"{path}: column {column}, by which boat {boat.name} is commanded, is missing; name the boat "
                "of this run by --boat"
            )
    run = runs_from(found, Wishes(), boat)[0]
    commands = run.commands(boat.thruster_names, fixed_thrusters(boat))
    senses = run.stacked(SENSES)
    for time, command, sense in zip(run.time - run.time[0], commands, senses, strict=True):
        yield Sample(float(time), command, sense)


def link_samples(
    text: str, boat: Boat, origin: Place = CAMOGLI, patience: float = PATIENCE
) -> Iterator[Sample]:
    """Yield the samples that a vehicle's telemetry gives; see `samples`."""
    assembler = Assembler(boat, origin)
    with socket_link(addresses(text, len(boat.thrusters)), modules=True) as link:
        last = monotonic()
        for packet in packets(link, patience):
            sample = assembler.feed(packet)
            if sample is not None:
                yield sample
                last = monotonic()
            elif monotonic() - last > SENSELESS * patience:
                raise UserError(
                    f"{text}: {SENSELESS * patience:g} s without whole telemetry of {boat.name}, "
                    f"{assembler.ignored} packets ignored; check --boat, and that the GPS has a fix"
                )


class Assembler:
    """Samples from telemetry packets in the order in which they come, some of them late, twice or damaged."""

    def __init__(self, boat: Boat, origin: Place = CAMOGLI) -> None:
        self._thrusters, self._origin = len(boat.thrusters), origin
        self._lines: list[list[ModuleLine]] = [[] for _ in boat.thrusters]
        self._waiting: tuple[int, int, Array] | None = None
        self._stamps = Stamps()
        self._start: int | None = None
        self.ignored = 0
        "Packets that were no telemetry of this boat, or older than what had come."

    def feed(self, packet: bytes) -> Sample | None:
        """Take a packet; the sample that it completes, if it does."""
        try:
            words = words_of(packet)
            if len(words) == len(ModuleLine._fields):
                self._keep(read_module_line(words))
                return None
            return self._next(*read_sensor_line(words, self._origin))
        except (ValueError, OverflowError):
            self.ignored += 1
            return None

    def _keep(self, line: ModuleLine) -> None:
        k = line.sender - FIRST_MODULE
        if not 0 <= k < self._thrusters:
            raise ValueError("another boat's module")
        self._lines[k] = sorted({*self._lines[k], line}, key=lambda kept: kept.utc)[-REMEMBERED:]

    def _next(self, stamp: int, motion: Array) -> Sample | None:
        jumps, followed = self._stamps.jumps, self._stamps.follow(stamp)
        if followed is None:
            raise ValueError("late, or twice")
        before, self._waiting = self._waiting, (stamp, followed, motion)
        if self._stamps.jumps > jumps:  # what came by the clock before it was set has no place in time now
            self._lines = [[] for _ in self._lines]
            return None
        if before is None:
            return None
        commands = self._in_force((before[0] + stamp) // 2)
        if commands is None:
            return None
        self._start = before[1] if self._start is None else self._start
        return Sample((before[1] - self._start) / 1e6, commands, before[2])

    def _in_force(self, at: int) -> Array | None:
        """(2K,) last values of the modules by that stamp; None while one has sent none."""
        last = [next((line for line in reversed(own) if line.utc <= at), None) for own in self._lines]
        if any(line is None for line in last):
            return None
        azimuths = [azimuth_angle(line.azimuth_reference) for line in last if line is not None]
        throttles = [line.thrust_reference / FULL for line in last if line is not None]
        return np.array(azimuths + throttles)
