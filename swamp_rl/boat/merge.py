"""Boat files as nested mappings: laid over one another, and walked leaf by leaf."""

from collections.abc import Iterator, Mapping
from typing import Any

from swamp_rl.boat.quantity import KEYS

Key = tuple[str, ...]


def is_quantity(given: Any) -> bool:
    """Whether `given` is a number with its provenance, rather than a section."""
    return isinstance(given, Mapping) and any(key in given for key in KEYS)


def is_section(given: Any) -> bool:
    """Whether `given` holds further keys."""
    return isinstance(given, Mapping) and not is_quantity(given)


def is_named_list(given: Any) -> bool:
    """Whether `given` is a list of sections with names, such as the thrusters."""
    return (
        isinstance(given, list)
        and bool(given)
        and all(is_section(item) and isinstance(item.get("name"), str) for item in given)
    )


def merge(under: Any, over: Any) -> Any:
    """`over` laid on `under`: sections key by key, lists of named sections name by name, the rest replaced.

    A number is replaced whole: a new value under an old source would be a lie. Names that stand twice in
    one list are kept, for the schema to refuse.
    """
    if is_section(under) and is_section(over):
        shared = {key: merge(under[key], value) if key in under else value for key, value in over.items()}
        return {**under, **shared}
    if is_named_list(under) and is_named_list(over):
        base = {item["name"]: item for item in under}
        laid = [merge(base.get(item["name"], {}), item) for item in over]
        first = {item["name"]: item for item in reversed(laid)}
        again = [item for item in laid if first[item["name"]] is not item]
        new = [item for name, item in first.items() if name not in base]
        return [first.get(item["name"], item) for item in under] + new[::-1] + again
    return over


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
