"""The published schema of boat files, by which editors complete and check them.

    python -m swamp_rl.boat.json_schema docs/boat.schema.json

It is of the file as it is written: any key may be null, and a file that extends another may leave out what
that one has.
"""

import json
import math
import sys
from pathlib import Path
from typing import Any

from swamp_rl.boat.resolve import REGRESSION, TEMPLATE
from swamp_rl.boat.schema import Boat
from swamp_rl.files import write_text

Schema = dict[str, Any]
HAVE_DEFAULTS = ("name", "wind", "current", "joypad")


def schema() -> Schema:
    """JSON Schema (2020-12) of a boat file."""
    whole = Boat.model_json_schema()
    parts: dict[str, Schema] = whole.pop("$defs")
    needed = [key for key in whole["required"] if key not in HAVE_DEFAULTS]
    thruster = {"anyOf": [{"$ref": "#/$defs/Thruster"}, {"$ref": "#/$defs/PropellerRudder"}]}
    keys: Schema = whole["properties"]
    keys["draught"]["anyOf"] += _word("loading", keys["draught"])
    c_d = parts["Hull"]["properties"]["c_d"]
    c_d["anyOf"] += _word(REGRESSION, c_d)
    keys["thrusters"] = {
        "description": keys["thrusters"]["description"],
        "anyOf": [
            {"type": "array", "items": thruster, "minItems": 1},
            {"type": "object", "additionalProperties": {"anyOf": [*thruster["anyOf"], {"type": "null"}]}},
        ],
    }
    keys[TEMPLATE] = {"description": "What all thrusters share.", **thruster}
    for part in (whole, *parts.values()):
        part.pop("required", None)
        part["properties"] = {key: _or_null(value) for key, value in part["properties"].items()}
    keys = {"extends": {"description": "A name in configs/boats, or a path.", "type": "string"}}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **whole,
        "title": "boat file of swamp-rl",
        "properties": keys | whole["properties"],
        "anyOf": [{"required": ["extends"]}, {"required": needed}],
        "$defs": parts,
    }


def _word(word: str, number: Schema) -> list[Schema]:
    """The word in place of a number, bare and with its provenance."""
    quantity = number["anyOf"][1]
    keys = quantity["properties"] | {"value": {"const": word}}
    return [{"const": word}, {**quantity, "properties": keys}]


def _or_null(key: Schema) -> Schema:
    """What a key may hold in a file, where null removes it; without a default that JSON does not have."""
    about: Schema = {name: key[name] for name in ("description", "default") if name in key}
    if isinstance(about.get("default"), float) and math.isinf(about["default"]):
        del about["default"]
    content = {name: value for name, value in key.items() if name not in ("description", "default", "title")}
    alternatives = content["anyOf"] if set(content) == {"anyOf"} else [content]
    return {**about, "anyOf": [*alternatives, {"type": "null"}]}


def schema_text() -> str:
    """The published file's text."""
    return json.dumps(schema(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    write_text(Path(sys.argv[1]), schema_text())
