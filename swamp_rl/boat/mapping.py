"""A loaded boat as the mapping that a boat file holds, standing alone."""

from typing import Any

from pydantic import BaseModel

from swamp_rl.boat.quantity import SPREAD, Provenance, Unit
from swamp_rl.boat.schema import Boat
from swamp_rl.effects.entries import entry_mapping


def boat_mapping(boat: Boat) -> dict[str, Any]:
    """The boat for a YAML file that extends nothing: every number with its provenance, and the effects.

    Numbers that no file gave, defaults of the schema, are left out.
    """
    made = _section(boat, (), boat.provenance)
    made.pop("effects", None)
    if boat.effects:
        made["effects"] = [entry_mapping(entry) for entry in boat.effects]
    return made


def _section(model: BaseModel, at: tuple[str, ...], known: dict[str, Provenance]) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for key, field in type(model).model_fields.items():
        value, path = getattr(model, key), (*at, key)
        if any(isinstance(part, Unit) for part in field.metadata):
            if (origin := known.get(".".join(path))) is not None:
                made[key] = quantity_mapping(value, origin)
        elif value is not None:
            made[key] = _content(value, path, known)
    return made


def quantity_mapping(value: Any, origin: Provenance) -> dict[str, Any]:
    """A number with its provenance."""
    quantity = {"value": _plain(value), "unit": origin.unit}
    quantity |= {"provenance": origin.provenance, "source": origin.source}
    return quantity if origin.sd is None else quantity | {SPREAD: _plain(origin.sd)}


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _content(value: Any, path: tuple[str, ...], known: dict[str, Provenance]) -> Any:
    if isinstance(value, BaseModel):
        return _section(value, path, known)
    if isinstance(value, tuple):
        return [
            _content(item, (*path, str(getattr(item, "name", index))), known)
            for index, item in enumerate(value)
        ]
    return value
