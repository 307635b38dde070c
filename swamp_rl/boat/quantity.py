"""A number of a boat file: its value, unit, provenance and source."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from swamp_rl.explain import in_yaml
from swamp_rl.units import in_ours

Origin = Literal["measured", "fitted", "assumed"]
ORIGINS = get_args(Origin)
KEYS = ("value", "unit", "provenance", "source")
SPREAD = "sd"
"Optional key: standard deviation in the same unit, of the prior where assumed, of the estimate where fitted."


@dataclass(frozen=True)
class Provenance:
    """Where a number comes from. unit: SI; source: the page, the trial, or the file that set it bare.

    sd: standard deviation in that unit, one number or one for each of a list; None where the file has none.
    """

    unit: str
    provenance: Origin
    source: str
    sd: float | tuple[float, ...] | None = None


@dataclass(frozen=True)
class Unit:
    """Annotation of a field: the one unit its value may have.

    In YAML the field is `{value, unit, provenance, source}`, with `sd` if known, or the bare value; the model
    holds the value.
    """

    name: str

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.value_of, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        bare = handler(schema)
        spread = {"type": "number", "minimum": 0}
        keys = {
            "value": bare,
            "unit": {"const": self.name},
            "provenance": {"enum": list(ORIGINS)},
            "source": {"type": "string", "minLength": 1},
            SPREAD: {"anyOf": [spread, {"type": "array", "items": spread}]},
        }
        whole = {"type": "object", "properties": keys, "required": list(KEYS), "additionalProperties": False}
        return {"anyOf": [bare, whole]}

    def value_of(self, given: Any) -> Any:
        """The value inside a quantity; what is not a mapping is passed on as a bare value."""
        if not isinstance(given, Mapping):
            return given
        faults = [f"lacks {key}" for key in KEYS if key not in given]
        faults += [f"has an unknown key {key!r}" for key in given if key not in (*KEYS, SPREAD)]
        if not faults and given["unit"] != self.name:
            known = in_ours(str(given["unit"]), self.name)
            hint = f" ({known})" if known else ""
            faults = [f"has unit {in_yaml(given['unit'])}, allowed is {self.name!r}{hint}"]
        if not faults and given["provenance"] not in ORIGINS:
            faults = [f"has provenance {in_yaml(given['provenance'])}, allowed are {', '.join(ORIGINS)}"]
        if not faults and not (isinstance(given["source"], str) and given["source"].strip()):
            faults = ["has an empty source; say where the number comes from"]
        if not faults and SPREAD in given and not _is_spread(given[SPREAD], given["value"]):
            faults = ["has an sd that is not a number of at least 0, nor a list of one for each value"]
        if faults:
            needs = f"the number {faults[0]}; write {{value, unit: {self.name}, provenance, source}}"
            raise PydanticCustomError("quantity", "{needs}", {"needs": needs})
        return given["value"]


def _is_spread(sd: Any, value: Any) -> bool:
    many = sd if isinstance(sd, list) else [sd]
    numbers = all(isinstance(one, int | float) and not isinstance(one, bool) for one in many)
    fits = not isinstance(sd, list) or (isinstance(value, list) and len(value) == len(sd))
    return numbers and fits and all(0.0 <= one < math.inf for one in many)


def units(model: BaseModel) -> Iterator[tuple[tuple[str, ...], str]]:
    """Key path and unit of every quantity in a model; list items go by their `name`, else by their index.

    A limit that is not there, infinite or None, is no quantity.
    """
    for key, field in type(model).model_fields.items():
        value = getattr(model, key)
        unit = next((part.name for part in field.metadata if isinstance(part, Unit)), None)
        if unit is not None:
            if value is not None and not (isinstance(value, float) and math.isinf(value)):
                yield (key,), unit
        elif isinstance(value, BaseModel):
            yield from (((key, *path), unit) for path, unit in units(value))
        elif isinstance(value, tuple):
            for index, item in enumerate(value):
                if isinstance(item, BaseModel):
                    inner = str(getattr(item, "name", index))
                    yield from (((key, inner, *path), unit) for path, unit in units(item))


def value_at(part: Any, path: Sequence[str]) -> Any:
    """What a boat holds at a key path; items of a list go by their name, else by their number."""
    for key in path:
        if isinstance(part, tuple):
            names = [str(getattr(item, "name", number)) for number, item in enumerate(part)]
            part = part[names.index(key)]
        else:
            part = getattr(part, key)
    return part
