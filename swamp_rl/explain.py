"""What pydantic refuses, a line for each fault: the file, the key and what is allowed there."""

import difflib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError

LIKE = 0.6
"""Words less alike than this are not taken for one another."""

MOST = 20
"""Faults that are told at most."""

TELLING = {"literal_error": 0, "extra_forbidden": 1}
"""Types of faults that bring others with them, by what is told first."""

KEY_ITSELF = "[key]"
"""What pydantic puts behind the place of a key that is wrong itself."""

IDENTIFIER = "^[A-Za-z][A-Za-z0-9_]*$"
"""Pattern of names in boat files."""

LENGTHS = ("too_short", "too_long")
"""Types of faults whose message has the number that there is."""

QUOTED = "; leave the quotation marks out"

Model = TypeVar("Model", bound=BaseModel)


def validated(path: Path | str, model: type[Model], data: Mapping[str, Any]) -> Model:
    """`data`, read from `path`, as a `model`; UserError by `explain` if it does not fit."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise explain(path, error, model) from error


def explain(path: Path | str, error: ValidationError, model: type[BaseModel] | None = None) -> UserError:
    """One line for each fault of a ValidationError: file, dotted key, what is allowed.

    With `model`, an unknown key is answered with the nearest known one.
    """
    told = [f"{path}: {key + ': ' if key else ''}{message}" for key, message in explanations(error, model)]
    others = len(_faults(error)) - len(told)
    return UserError("\n".join(told + ([f"{path}: and {others} more faults"] if others else [])))


def explanations(error: ValidationError, model: type[BaseModel] | None) -> list[tuple[str, str]]:
    """The dotted key and the explanation of up to MOST faults in a ValidationError, the most telling first.

    A misspelt key is two faults, one that is unknown and one that is missing; a wrong choice, such as a
    thruster's kind, makes keys unknown that are not.
    """
    return [_explanation(fault, model) for fault in _faults(error)[:MOST]]


def _faults(error: ValidationError) -> list[ErrorDetails]:
    """The most telling first; without lists that are too short only because an entry of theirs is faulty."""
    faults = error.errors(include_url=False)
    holders = {fault["loc"][:depth] for fault in faults for depth in range(len(fault["loc"]))}
    own = [fault for fault in faults if fault["type"] != "too_short" or fault["loc"] not in holders]
    return sorted(own, key=lambda fault: TELLING.get(fault["type"], len(TELLING)))


def _explanation(fault: ErrorDetails, model: type[BaseModel] | None) -> tuple[str, str]:
    key = clipped(".".join(clipped(part) for part in fault["loc"] if part != KEY_ITSELF), 200)
    if fault["type"] == "extra_forbidden":
        return key, f"unknown key{_suggestion(fault['loc'], model)}"
    if fault["type"] == "missing":
        return key, "is missing; add it"
    message = clipped(fault["msg"].removeprefix("Value error, ").replace("\n", " "), 500)
    if fault["type"] == "value_error":
        return key, message
    message, value = in_yaml_words(message), repr(fault["input"])
    is_told = len(value) > 60 or fault["type"] in LENGTHS
    told = message[:1].lower() + message[1:] + ("" if is_told else f", not {value}")
    return key, told + (QUOTED if _is_quoted_number(fault) else "")


def in_yaml_words(message: str) -> str:
    """A message of pydantic with YAML's words for its types in place of Python's."""
    message = re.sub("a valid dictionary( or instance of [A-Za-z]+)?", "a mapping of keys to values", message)
    message = message.replace("a valid tuple", "a list").replace("Tuple", "The list")
    message = message.replace("Dictionary", "The mapping").replace(" after validation", "")
    message = message.replace("a valid string", "text")
    message = message.replace(f"match pattern '{IDENTIFIER}'", "have letters, digits and _, a letter first")
    return message.replace("a valid boolean", "true or false").replace("a valid integer", "a whole number")


def _is_quoted_number(fault: ErrorDetails) -> bool:
    """Whether text stands where a number must, and is one."""
    text = fault["input"]
    if fault["type"] not in ("int_type", "float_type") or not isinstance(text, str):
        return False
    return re.fullmatch(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*", text) is not None


def _suggestion(loc: tuple[int | str, ...], model: type[BaseModel] | None) -> str:
    known = sorted(_known_keys(loc[:-1], model)) if model else []
    return nearest(str(loc[-1]), known) if known else "; remove it or correct its name"


def nearest(word: str, known: Iterable[str]) -> str:
    """The end of a complaint about an unknown word: the known one most like it, and all the known ones."""
    known, word = list(known), clipped(word)
    near = max(known, key=lambda other: likeness(word, other), default="")
    hint = f"; did you mean {near!r}?" if likeness(word, near) >= LIKE else ";"
    return f"{hint} known here: {', '.join(known)}"


def likeness(one: str, other: str) -> float:
    """How much of two words is the same, from 0 to 1.

    difflib's ratio sees letters that changed places, and the edit distance letters left out, where difflib's
    longest block lies astray: it finds half of `seses` in `senses`.
    """
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        above, row = row, [i]
        for j, known in enumerate(other, 1):
            row.append(min(row[-1] + 1, above[j] + 1, above[j - 1] + (letter != known)))
    edits = 1.0 - row[-1] / max(len(one), len(other), 1)
    return max(edits, difflib.SequenceMatcher(None, one, other).ratio())


def _known_keys(loc: tuple[int | str, ...], model: type[BaseModel]) -> set[str]:
    """Keys of the models that may stand at `loc`, found by following the fields' annotations."""
    models = {model}
    for part in loc:
        fields = [found.model_fields[part] for found in models if part in found.model_fields]
        inner = {found for field in fields for found in _models_in(field.annotation)}
        models = inner or models
    return {field.alias or name for found in models for name, field in found.model_fields.items()}


def _models_in(annotation: Any) -> set[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {annotation}
    return {model for part in get_args(annotation) for model in _models_in(part)}
