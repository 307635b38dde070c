"""The published schema of experiment files, by which editors complete and check them.

    python -m swamp_rl.experiments.config.json_schema docs/experiment.schema.json

It is of the file as it is written: one that extends another may leave out what that one has, and a pilot's
keys and options are those of its kind.
"""

import json
import sys
from pathlib import Path
from typing import Any

from swamp_rl.experiments.config.learners import LEARNERS, Learner, learner
from swamp_rl.experiments.config.schema import Experiment

from swamp_rl.files import write_text
from swamp_rl.pilots.own import SHIPPED

OWN = r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$"
Schema = dict[str, Any]
REF = "#/$defs/{model}"


def schema() -> Schema:
    """JSON Schema (2020-12) of an experiment file."""
    whole = Experiment.model_json_schema(ref_template=REF)
    parts: dict[str, Schema] = whole.pop("$defs")
    plan = parts.pop("PilotPlan")
    needed = {"evaluation": _required(parts["Evaluation"]), "hidden": _required(parts["Hidden"])}
    needed["pilots"] = {"additionalProperties": {"required": ["kind"]}}
    alone = {"required": whole.pop("required"), "properties": needed}
    for part in parts.values():
        part.pop("required", None)
    parts |= {f"{kind} options": _options(kind, parts) for kind in LEARNERS}
    parts |= {f"{kind} pilot": _pilot(plan, kind, learner(kind)) for kind in LEARNERS}
    parts["own pilot"] = {**plan, "title": "own pilot"}
    parts["any pilot"] = _pilot_that_extends(plan)
    parts["pilot"] = _pilot_by_kind()
    pilots = whole["properties"]["pilots"]
    pilots["patternProperties"] = {
        name: {"anyOf": [_ref("pilot"), {"type": "null"}]} for name in pilots["patternProperties"]
    }
    pilots["additionalProperties"] = False
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "experiment file of swamp-rl",
        **{key: value for key, value in whole.items() if key != "title"},
        "anyOf": [{"required": ["extends"]}, alone],
        "$defs": parts,
    }


def schema_text() -> str:
    """The published file's text."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def _ref(name: str) -> Schema:
    return {"$ref": REF.format(model=name)}


def _required(part: Schema) -> Schema:
    return {"required": part.get("required", [])}


def _options(kind: str, parts: dict[str, Schema]) -> Schema:
    """The options of a kind; what it needs is left to the command, for a file that extends may not say it."""
    found = learner(kind).settings.model_json_schema(ref_template=REF)
    parts |= found.pop("$defs", {})
    found.pop("required", None)
    return found


def _pilot(plan: Schema, kind: str, learns: Learner) -> Schema:
    """The keys of a pilot of one kind."""
    without = {
        "runs": not learns.from_runs,
        "outcomes": not learns.from_runs,
        "skill": not learns.from_runs,
        "disturbances": not learns.by_trying,
        "takeover": kind == "scripted",
    }
    keys = dict(plan["properties"])
    keys |= {
        key: {"const": keys[key]["default"], "description": f"Not for {kind}."}
        for key in without
        if without[key]
    }
    keys |= {"kind": {"const": kind}, "options": _ref(f"{kind} options")}
    return {"type": "object", "properties": keys, "additionalProperties": False}


def _pilot_that_extends(plan: Schema) -> Schema:
    """The keys of a pilot whose kind another file tells."""
    keys = {key: value for key, value in plan["properties"].items() if key != "kind"}
    keys["options"] = {"anyOf": [_ref(f"{kind} options") for kind in LEARNERS]}
    return {"type": "object", "properties": keys, "additionalProperties": False}


def _pilot_by_kind() -> Schema:
    branches = [
        {
            "if": {"properties": {"kind": {"const": kind}}, "required": ["kind"]},
            "then": _ref(f"{kind} pilot"),
        }
        for kind in LEARNERS
    ]
    own = {
        "if": {"properties": {"kind": {"not": {"enum": list(LEARNERS)}}}, "required": ["kind"]},
        "then": _ref("own pilot"),
    }
    untold = {"if": {"not": {"required": ["kind"]}}, "then": _ref("any pilot")}
    own_kind = {
        "anyOf": [{"enum": sorted(SHIPPED)}, {"pattern": OWN}],
        "description": "A class of your own, module:Class; a model's file.",
    }
    return {
        "type": "object",
        "properties": {"kind": {"anyOf": [{"enum": list(LEARNERS)}, own_kind]}},
        "allOf": [*branches, own, untold],
    }


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    write_text(Path(sys.argv[1]), schema_text())
