"""JSON of files that may be damaged or hostile."""

import json
import math
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.ordinary import MOST_JSON, contents

MOST_DIGITS = 300
"""Of a whole number, which is then a float as well."""

Model = TypeVar("Model", bound=BaseModel)


def parsed_json(text: str | bytes) -> Any:
    """What a JSON text holds; ValueError where it is none, nested too deep to be read, not UTF-8, where a key
    is given twice, or where a number is NaN, infinite or has more digits than a float can stand for."""
    try:
        return json.loads(
            text, parse_int=_whole, parse_float=_finite, parse_constant=_finite, object_pairs_hook=_object
        )
    except RecursionError as error:
        raise ValueError("is nested too deep") from error


def _whole(digits: str) -> int:
    if len(digits) > MOST_DIGITS:
        raise ValueError(f"a number has {len(digits)} digits, at most {MOST_DIGITS}")
    return int(digits)


def _finite(digits: str) -> float:
    number = float(digits)
    if not math.isfinite(number):
        raise ValueError(f"{clipped(digits)} is not a finite number")
    return number


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"key {clipped(twice)!r} is given twice")
    return found


def model_in(text: str | bytes, model: type[Model]) -> Model:
    """A JSON text as a `model`, without conversion of one type to another; ValueError as of `parsed_json`,
    and pydantic's where it does not fit."""
    parsed_json(text)
    return model.model_validate_json(text, strict=True)


def read_json(path: Path | str, remedy: str) -> dict[str, Any]:
    """The object in a JSON file; UserError, which ends in `remedy`, where it cannot be read or is another."""
    try:
        found = parsed_json(contents(path, MOST_JSON))
    except OSError as error:
        raise UserError(f"{path}: {error.strerror or 'cannot be read'}; {remedy}") from error
    except ValueError as error:
        raise UserError(f"{path}: is no JSON ({clipped(error)}); {remedy}") from error
    if not isinstance(found, dict):
        raise UserError(f"{path}: holds no JSON object; {remedy}")
    return found


def schema_text(model: type[BaseModel], title: str) -> str:
    """JSON Schema (draft 2020-12) of what a model writes, as a published file holds it."""
    schema = model.model_json_schema(mode="serialization")
    named = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title}
    return json.dumps(named | {k: v for k, v in schema.items() if k != "title"}, indent=2) + "\n"
