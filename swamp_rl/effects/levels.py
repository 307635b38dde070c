"""Disturbance levels: effects, and offsets of the start, whose numbers are drawn for each episode."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.config_kind import refuse_other_kind
from swamp_rl.effects.apply import write_effect
from swamp_rl.effects.correlated import Correlated, parse_correlated
from swamp_rl.effects.declare import FULL_TURN
from swamp_rl.effects.distributions import Array, Distribution, columns, parse_distribution
from swamp_rl.effects.entries import entry_list, suggestion
from swamp_rl.effects.fit import Size, fitted_level
from swamp_rl.effects.random_entry import RandomEntry, parse_random_entry
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml

START = {"north": "m", "east": "m", "heading": "rad"}
KEYS = ("description", "start", "effects", "correlated")
OF_LEVEL = ", its effects a list below the key effects"


@dataclass(frozen=True)
class Level:
    """How an episode departs from the boat file, drawn from `draw_count` uniforms in [0, 1).

    offsets: of the start's north [m], east [m], heading [rad]. An episode is drawn from its own row of
    uniforms alone, so it is the same in any batch.
    """

    name: str
    offsets: tuple[Distribution, ...]
    entries: tuple[RandomEntry, ...]
    thruster_names: tuple[str, ...]
    correlated: Correlated | None = None

    @property
    def draw_count(self) -> int:
        """Uniforms that an episode needs."""
        return sum(self._widths)

    def start(self, uniforms: Array) -> Array:
        """(n, 3) offsets of the start north [m], east [m], heading [rad] from uniforms (n, draw_count)."""
        blocks = self._blocks(uniforms)
        return np.column_stack(
            [offset.values(block) for offset, block in zip(self.offsets, blocks, strict=False)]
        )

    def apply(self, record: NDArray[np.void], uniforms: Array) -> None:
        """Write the drawn effects into `record` (n,), in place, from uniforms (n, draw_count)."""
        blocks = self._blocks(uniforms)[len(self.offsets) :]
        for entry, block in zip(self.entries, blocks, strict=True):
            drawn = entry.draw(block)
            thrusters = drawn.thrusters(self.thruster_names)
            write_effect(record, entry.effect, drawn.values, thrusters, drawn.on, entry.curve)

    def drawn(self, uniforms: Array) -> list[dict[str, Any]]:
        """The effects of one episode with their numbers, from its uniforms (draw_count,).

        What a run is replayed from: the list reads as the `effects` of a boat file, without those that
        turned out not to be there.
        """
        blocks = self._blocks(uniforms[None, :])[len(self.offsets) :]
        drawn = [entry.draw(block).mapping(0) for entry, block in zip(self.entries, blocks, strict=True)]
        return [mapping for mapping in drawn if mapping is not None]

    def _blocks(self, uniforms: Array) -> list[Array]:
        joined = uniforms if self.correlated is None else self.correlated.joined(uniforms)
        return columns(joined, self._widths)

    @property
    def _widths(self) -> list[int]:
        return [offset.draws for offset in self.offsets] + [entry.draws for entry in self.entries]


def load_disturbances(
    source: str | Path | Sequence[Mapping[str, Any]] | None,
    thruster_names: Sequence[str],
    size: Size | None = None,
) -> Level:
    """A level by bare name or path; a list of effects, with numbers or distributions; None is no disturbance.

    size: of the boat, to which a file that names the boat it was made for is fitted (`effects.fit`).
    UserError names file, entry and key of the first fault.
    """
    if source is None:
        return _level("none", "no disturbances", {}, thruster_names)
    if isinstance(source, str | Path):
        path = find_config("disturbances", source)
        given = fitted_level(_read(path), str(path), size, thruster_names)
        return _level(path.stem, str(path), given, thruster_names)
    return _level("effects", "disturbances", {"effects": source}, thruster_names)


def read_level(
    source: str | Path, size: Size | None = None, thruster_names: Sequence[str] = ()
) -> tuple[dict[str, Any], Level]:
    """What a level's file, by bare name or path, holds for a boat of that size with those thrusters, and the
    level; by default as it stands, for a boat with the thrusters that it names. UserError as
    `load_disturbances`.
    """
    path = find_config("disturbances", source)
    given = _read(path)
    names = thruster_names or _thrusters_named(given.get("effects"))
    fitted = fitted_level(given, str(path), size, names)
    return fitted, _level(path.stem, str(path), fitted, names)


def _read(path: Path) -> dict[str, Any]:
    given = read_yaml(path, OF_LEVEL)
    refuse_other_kind(path, given, "disturbance")
    return given


def level_of(given: Mapping[str, Any], where: str) -> Level:
    """The level that a mapping holds, for a boat with the thrusters that it names. UserError as
    `load_disturbances`.
    """
    return _level("level", where, given, _thrusters_named(given.get("effects")))


def _thrusters_named(entries: Any) -> list[str]:
    selectors = [entry.get("thruster") for entry in _list(entries) if isinstance(entry, Mapping)]
    chosen = [_list(one.get("choice")) if isinstance(one, Mapping) else [one] for one in selectors]
    named = [name for choice in chosen for one in choice for name in (_list(one) or [one])]
    return list(dict.fromkeys(name for name in named if isinstance(name, str)))


def _list(given: Any) -> list[Any]:
    return given if isinstance(given, list) else []


def _level(name: str, where: str, given: Mapping[str, Any], thruster_names: Sequence[str]) -> Level:
    for key in given:
        if key not in KEYS:
            raise UserError(f"{where}: unknown key {key!r}; {suggestion(key, KEYS)}")
    entries = tuple(
        parse_random_entry(entry, f"{where}: effects[{index}]", thruster_names)
        for index, entry in enumerate(entry_list(given.get("effects", []), where))
    )
    offsets = _offsets(given.get("start", {}), where)
    ends = accumulate((entry.draws for entry in entries), initial=sum(one.draws for one in offsets))
    correlated = parse_correlated(given.get("correlated"), entries, list(ends), where)
    return Level(name, offsets, entries, tuple(thruster_names), correlated)


def _offsets(given: Any, where: str) -> tuple[Distribution, ...]:
    if not isinstance(given, Mapping):
        raise UserError(f"{where}: start must be a mapping such as {{heading: {{uniform: [-0.5, 0.5]}}}}")
    for key in given:
        if key not in START:
            raise UserError(f"{where}: unknown key start.{key}; {suggestion(key, START)}")
    offsets = {
        key: parse_distribution(given.get(key, 0.0), f"{where}: start.{key} [{unit}]")
        for key, unit in START.items()
    }
    if max(map(abs, offsets["heading"].reach)) > FULL_TURN:
        raise UserError(f"{where}: start.heading is beyond a full turn; give it in radians")
    return tuple(offsets.values())
