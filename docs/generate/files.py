"""Keys of the YAML files, from the pydantic models that read them."""

import math
from collections.abc import Iterator
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaMode
from pydantic_core import PydanticUndefined, core_schema
from swamp_rl.experiments.config.learners import LEARNERS, learner
from swamp_rl.experiments.config.schema import Experiment
from swamp_rl.experiments.sweep.schema import Sweep

from docs.generate.markdown import table
from swamp_rl.boat import Boat
from swamp_rl.boat.quantity import Unit
from swamp_rl.course import Course
from swamp_rl.design import HullDesign, MatchDesign, PumpJetDesign
from swamp_rl.energy.mission import Mission
from swamp_rl.guidance.path_file import PathFile
from swamp_rl.identification.square_twin import Vehicle
from swamp_rl.manoeuvres.plan import Plan

HEAD = ["key", "unit", "kind", "default", "allowed", "meaning"]
BOUNDS = {
    "minimum": "≥ {}",
    "exclusiveMinimum": "> {}",
    "maximum": "≤ {}",
    "exclusiveMaximum": "< {}",
    "minItems": "at least {} of them",
    "minLength": "not empty",
}
KINDS = {
    "number": "number",
    "integer": "whole number",
    "string": "text",
    "boolean": "true or false",
    "object": "mapping",
    "null": "null",
}


def boat_file() -> str:
    """Every key of a boat file."""
    return reference(Boat)


def course_file() -> str:
    """Every key of a course file."""
    return reference(Course)


def design_file() -> str:
    """Every key of the design files, by kind."""
    kinds = {"pump-jet": PumpJetDesign, "hull": HullDesign, "match": MatchDesign}
    return "\n".join(
        reference(model).replace("## The file", f"## design: {kind}").replace("## `", "### `")
        for kind, model in kinds.items()
    )


def experiment_file() -> str:
    """Every key of an experiment file, and the options of each kind of pilot."""
    parts = [reference(Experiment), "## Options of pilots, by kind\n"]
    for kind in LEARNERS:
        settings = learner(kind).settings
        parts += [f"### {kind}\n", _keys(settings) if settings.model_fields else "It has no options.\n"]
    return "\n".join(parts)


def mission_file() -> str:
    """Every key of a mission file."""
    return reference(Mission)


def vehicle_file() -> str:
    """Every key of a vehicle file."""
    return reference(Vehicle)


def path_file() -> str:
    """Every key of a path file."""
    return reference(PathFile)


def plan_file() -> str:
    """Every key of a plan of sea trials."""
    return reference(Plan)


def sweep_file() -> str:
    """Every key of a sweep file."""
    return reference(Sweep)


def reference(model: type[BaseModel]) -> str:
    """A section for each model of a file: its docstring and a table of its keys."""
    return "\n".join(f"## {title}\n\n{_keys(part)}" for title, part in _sections(model, "").items())


class _Forgiving(GenerateJsonSchema):
    """What no JSON schema can say, such as an effect's entry, is a mapping."""

    def handle_invalid_for_json_schema(self, schema: core_schema.CoreSchema, error_info: str) -> dict:
        return {"type": "object"}


def _sections(model: type[BaseModel], key: str) -> dict[str, type[BaseModel]]:
    """The models in a file by where they stand, each once."""
    found: dict[str, type[BaseModel]] = {f"`{key}`" if key else "The file": model}
    for name, field in model.model_fields.items():
        inner = list(dict.fromkeys(_models_in(field.annotation)))
        for part in inner:
            at = ".".join(filter(None, (key, name))) + ("[]" if _kind_of(field) == "list" else "")
            for title, other in _sections(part, at).items():
                if other not in found.values():
                    kind = _fixed_kind(part) if len(inner) > 1 else ""
                    found[f"{title}{kind}" if other is part else title] = other
    return found


def _fixed_kind(model: type[BaseModel]) -> str:
    """Tells one of several models that may stand at a place by its `kind`, else by its name."""
    field = model.model_fields.get("kind")
    text = " or ".join(map(str, get_args(field.annotation))) if field else model.__name__
    return f", {text}"


def _kind_of(field: FieldInfo) -> str:
    text = str(field.annotation)
    return "list" if "tuple[" in text or "list[" in text else "dict" if "dict[" in text else ""


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


def _keys(model: type[BaseModel]) -> str:
    mode: JsonSchemaMode = "validation"
    schema = model.model_json_schema(schema_generator=_Forgiving, mode=mode)
    described = schema.get("properties") or schema["$defs"][model.__name__]["properties"]
    rows = [
        _row(name, field, described[field.alias or name], schema.get("$defs", {}))
        for name, field in model.model_fields.items()
    ]
    return f"{_docstring(model)}\n{table(HEAD, rows)}"


def _docstring(model: type[BaseModel]) -> str:
    return "\n".join(line.strip() for line in (model.__doc__ or "").strip().splitlines()) + "\n"


def _row(name: str, field: FieldInfo, schema: dict[str, Any], parts: dict[str, Any]) -> list[str]:
    unit = next((part.name for part in field.metadata if isinstance(part, Unit)), "")
    bounds = ", ".join(text.format(_number(schema[key])) for key, text in BOUNDS.items() if key in schema)
    return [
        f"`{field.alias or name}`",
        unit,
        _kind(schema, parts),
        _default(field),
        bounds,
        " ".join((field.description or "").split()),
    ]


def _number(bound: float) -> str:
    return f"{bound:.6g}".replace("-", "−")


def _kind(schema: dict[str, Any], parts: dict[str, Any]) -> str:
    """In words, what a value may be."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        part = parts.get(name, {})
        return "mapping" if part.get("type") == "object" else _kind(part, parts)
    if "const" in schema:
        return f"`{schema['const']}`"
    if "enum" in schema:
        return " or ".join(f"`{value}`" for value in schema["enum"])
    for many in ("anyOf", "oneOf"):
        if many in schema:
            return " or ".join(dict.fromkeys(_kind(one, parts) for one in schema[many]))
    if schema.get("type") == "array":
        if "prefixItems" in schema:
            return f"[{', '.join(_kind(item, parts) for item in schema['prefixItems'])}]"
        return f"list of {_kind(schema.get('items', {}), parts)}s"
    return KINDS.get(schema.get("type", ""), "value")


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if value is PydanticUndefined or isinstance(value, BaseModel):
        return "its own defaults"
    if value in (None, (), {}, [], "", math.inf, -math.inf):
        return "none"
    return f"`{list(value) if isinstance(value, tuple) else value}`"
