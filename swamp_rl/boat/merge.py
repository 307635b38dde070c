"""Boat files as nested mappings: laid over one another, and walked leaf by leaf."""

from collections.abc import Iterator, Mapping
from typing import Any

from swamp_rl.boat.quantity import KEYS

Key = tuple[str, ...]


def is_quantity(given: Any) -> bool:
    """Whether `given` is a number with its provenance, rather than a section."""
    return isinstance(given, Mapping) and any(key in given for key in KEYS)


def value_of(given: Any) -> Any:
    """What a leaf holds, with its provenance or bare."""
    return given.get("value") if is_quantity(given) else given


def is_section(given: Any) -> bool:
    """Whether `given` holds further keys."""
    return isinstance(given, Mapping) and not is_quantity(given)


def merge(under: Any, over: Any) -> Any:
    """`over` laid on `under`: sections key by key, the rest replaced.

    A section laid on a list of named sections, such as the thrusters, changes those that it names and adds
    others; a list replaces it. A key whose content is null stands for one to be removed (`without_nulls`). A
    number is replaced whole: a new value under an old source would be a lie.
    """
    if is_section(over):
        named = by_name(under)
        if named is not None:
            return [item for item in listed(merge(named, over)) if item is not None]
        if is_section(under):
            return {**under, **{key: merge(under.get(key), value) for key, value in over.items()}}
    return over


def by_name(given: Any) -> dict[str, Any] | None:
    """A list of sections that all have names, none twice, as a mapping by name; None for anything else."""
    if not isinstance(given, list) or not all(is_section(item) for item in given):
        return None
    named = {item.get("name"): item for item in given}
    whole = len(named) == len(given) > 0 and all(isinstance(name, str) for name in named)
    return named if whole else None


def listed(named: Mapping[str, Any]) -> list[Any]:
    """A mapping by name as a list of sections that hold their names."""
    return [{"name": name, **item} if is_section(item) else item for name, item in named.items()]


def without_nulls(given: Any) -> Any:
    """`given` without the keys whose content is null, at any depth of sections and lists of them."""
    if is_section(given):
        return {key: without_nulls(value) for key, value in given.items() if value is not None}
    if isinstance(given, list):
        return [without_nulls(item) for item in given]
    return given


def leaves(given: Any, at: Key = ()) -> Iterator[tuple[Key, Any]]:
    """Key path and content of everything that is no section; items of a list go by name, else by index."""
    if is_section(given):
        for key, value in given.items():
            yield from leaves(value, (*at, str(key)))
    elif isinstance(given, list) and any(is_section(item) for item in given):
        for index, item in enumerate(given):
            name = item.get("name", index) if is_section(item) else index
            yield from leaves(item, (*at, str(name)))
    else:
        yield at, given
