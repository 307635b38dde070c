"""JSON of files that may be damaged or hostile."""

import json
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.ordinary import MOST_JSON, contents

MOST_DIGITS = 300
"""Of a whole number, which is then a float as well."""


def parsed_json(text: str | bytes) -> Any:
    """What a JSON text holds; ValueError where it is none, nested too deep to be read, not UTF-8, or where a
    whole number has more digits than a float can stand for."""
    try:
        return json.loads(text, parse_int=_whole)
    except RecursionError as error:
        raise ValueError("is nested too deep") from error


def _whole(digits: str) -> int:
    if len(digits) > MOST_DIGITS:
        raise ValueError(f"a number has {len(digits)} digits, at most {MOST_DIGITS}")
    return int(digits)


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
