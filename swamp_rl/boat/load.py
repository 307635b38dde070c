"""Boat files: found, chained by `extends`, merged and validated, with every fault named by file and key."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from swamp_rl.boat.applicable import refuse_inapplicable
from swamp_rl.boat.battery import CURVE, MEASURED, SHAFT
from swamp_rl.boat.defaults import defaults_of
from swamp_rl.boat.magnitude import out_of_range
from swamp_rl.boat.merge import Key, is_quantity, leaves, merge
from swamp_rl.boat.plausible import implausible
from swamp_rl.boat.quantity import SPREAD, Provenance, units
from swamp_rl.boat.resistance import DRIFT, TABLE
from swamp_rl.boat.resolve import TEMPLATE, resolved
from swamp_rl.boat.schema import JET, PROPELLER, Boat
from swamp_rl.boat.screw import OPEN_WATER
from swamp_rl.config_kind import refuse_other_kind
from swamp_rl.effects import parse_effects
from swamp_rl.errors import UserError
from swamp_rl.explain import explanations
from swamp_rl.files import extended_config, find_config, read_yaml

TAGS = (JET, PROPELLER, TABLE, DRIFT, *OPEN_WATER, CURVE, MEASURED, SHAFT)
Chain = list[tuple[Path, dict[str, Any]]]
"""Boat files and what they hold; each overrides those before it."""
BROUGHT = [(section, "is missing; add it") for section in ("wind", "current", "joypad")]
"""Faults of sections that may be left out: there are no defaults where another fault leaves none."""
REPLACES = ", or write thrusters: {NAME: {KEY: VALUE}} (a list replaces all thrusters of the extended file)"


def load_boat(name_or_path: str | Path, replaced: Mapping[str, Any] | None = None) -> Boat:
    """Load the boat of a file, given by path or, for files in configs/boats, by name.

    A bare number counts as assumed. A file that `extends` another gives only the differences: its `effects`
    are appended to the other's, and a key that it sets to null is removed. `thrusters` as a list replace the
    other's; as a mapping by name they change, add or (null) remove single ones. Keys of `wind`, `current` and
    `joypad` that are left out have the defaults of `swamp_rl.boat.defaults`.

    `replaced`: keys in place of the file's, in the form of a file that extends it. UserError with one line
    for each fault: file, key and what is allowed.
    """
    return boat_of_chain(boat_chain(name_or_path), replaced)


def boat_of_chain(chain: Chain, replaced: Mapping[str, Any] | None = None) -> Boat:
    """The boat of files that are read already (`boat_chain`), as `load_boat`."""
    if replaced:
        chain = [*chain, (chain[-1][0], dict(replaced))]
    raw: dict[str, Any] = {}
    origins: dict[Key, tuple[Path, Any]] = {}
    for path, data in chain:
        own = {key: value for key, value in data.items() if key not in ("extends", "effects")}
        raw = merge(raw, {"name": path.stem} | own)
        left = {key for key, _ in leaves(raw)}
        origins = {key: origin for key, origin in origins.items() if key in left}
        origins |= {key: (path, leaf) for key, leaf in leaves(own)}
    asked = chain[-1][0]
    _refuse(out_of_range(raw), origins, asked)
    whole = resolved(raw, asked)
    added = defaults_of(whole)
    origins |= {key: (asked, leaf) for key, leaf in leaves(added)}
    listed = len(chain) > 1 and isinstance(chain[-1][1].get("thrusters"), list)
    boat = _validated(merge(whole, added), origins, asked, REPLACES if listed else "")
    effects = [
        entry
        for path, data in chain
        for entry in parse_effects(data.get("effects", []), str(path), boat.thruster_names)
    ]
    refuse_inapplicable(boat, (entry.effect for entry in effects), f"{asked}: effects")
    boat = boat.model_copy(update={"effects": tuple(effects)})
    boat.provenance.update(_provenance(boat, origins))
    return boat


def boat_chain(name_or_path: str | Path) -> Chain:
    """The files, each read once, to lay over one another, the one that extends nothing first."""
    path = find_config("boats", name_or_path)
    chain: Chain = []
    while True:
        chain.insert(0, (path, read_yaml(path)))
        refuse_other_kind(path, chain[0][1], "boat")
        extended = chain[0][1].get("extends")
        if "extends" not in chain[0][1]:
            return chain
        path = extended_config("boats", path, extended)
        if any(path.resolve() == seen.resolve() for seen, _ in chain):
            way = " -> ".join(str(file) for file, _ in reversed(chain))
            raise UserError(f"{way} -> {path}: extends forms a cycle; remove one of them")


def _validated(
    raw: dict[str, Any], origins: Mapping[Key, tuple[Path, Any]], asked: Path, missing_hint: str
) -> Boat:
    """The boat; UserError for its faults, with the hint where a thruster lacks a key."""
    try:
        boat = Boat.model_validate(raw)
    except ValidationError as error:
        faults = explanations(error, Boat, lambda loc: _place(loc, raw))
        hinted = (
            (key, message + missing_hint * (key.startswith("thrusters.") and "is missing" in message))
            for key, message in [fault for fault in faults if fault not in BROUGHT] or faults
        )
        _refuse(hinted, origins, asked)
        raise AssertionError("a ValidationError without a fault") from error
    _refuse(implausible(boat), origins, asked)
    return boat


def _refuse(faults: Iterable[tuple[str, str]], origins: Mapping[Key, tuple[Path, Any]], asked: Path) -> None:
    """UserError with a line for each fault, by dotted key; one that thrusters share names the first."""
    lines: dict[tuple[str, ...], list[str]] = {}
    for dotted, message in faults:
        key = tuple(dotted.split("."))
        origin = _origin(key, origins)
        file = str(origin[0] if origin else asked)
        thruster = key[1:2] if key[0] == "thrusters" else ()
        alike = (file, message, key[0], *key[2:]) if thruster else (file, message, *key)
        if alike in lines:
            lines[alike].append(f"{thruster[0]}")
        else:
            lines[alike] = [f"{file}: {dotted + ': ' if dotted else ''}{message}"]
    if lines:
        raise UserError("\n".join(_with_others(*fault) for fault in lines.values()))


def _with_others(line: str, *others: str) -> str:
    return f"{line} (and {', '.join(others)} alike)" if others else line


def _place(loc: tuple[int | str, ...], raw: Mapping[str, Any]) -> tuple[int | str, ...]:
    """The place of a fault without the tags of unions, thrusters by name in place of their number."""
    loc = tuple(part for part in loc if part not in TAGS)
    if len(loc) > 1 and loc[0] == "thrusters" and isinstance(loc[1], int):
        thruster = raw["thrusters"][loc[1]]
        name = thruster.get("name") if isinstance(thruster, Mapping) else None
        loc = ("thrusters", name if isinstance(name, str) else loc[1], *loc[2:])
    return loc


def _origin(key: Key, origins: Mapping[Key, tuple[Path, Any]]) -> tuple[Path, Any] | None:
    """File and content of the leaf at `key` or on the way to it; for a thruster, also of the common block."""
    for end in range(len(key), 0, -1):
        if key[:end] in origins:
            return origins[key[:end]]
    return _origin((TEMPLATE, *key[2:]), origins) if key[:1] == ("thrusters",) and len(key) > 2 else None


def _provenance(boat: Boat, origins: Mapping[Key, tuple[Path, Any]]) -> dict[str, Provenance]:
    """Provenance by dotted key; defaults of the schema, which no file gives, have none."""
    found = {}
    for key, unit in units(boat):
        origin = _origin(key, origins)
        if origin is None or origin[1] is None:
            continue
        path, leaf = origin
        if is_quantity(leaf):
            sd = leaf.get(SPREAD)
            fields = (leaf["provenance"], leaf["source"], tuple(sd) if isinstance(sd, list) else sd)
            found[".".join(key)] = Provenance(unit, *fields)
        else:
            found[".".join(key)] = Provenance(unit, "assumed", f"set in {path.name}")
    return found
