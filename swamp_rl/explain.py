"""What pydantic refuses, a line for each fault: the file, the key and what is allowed there."""

import difflib
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from swamp_rl.clipped import clipped
from swamp_rl.config_kind import MARKS, refuse_other_kind
from swamp_rl.counted import counted
from swamp_rl.errors import UserError

LIKE = 0.6
"""Words less alike than this are not taken for one another."""

PART = 3
"""Letters, at least, of a part that makes words alike."""

MOST = 20
"""Most faults in a message."""

TELLING = {"literal_error": 0, "extra_forbidden": 1}
"""Types of faults that bring others with them, in the order of the message."""

KEY_ITSELF = "[key]"
"""What pydantic puts behind the place of a key that is wrong itself."""

NUMBER, WHOLE, MAPPING, LIST = "a number", "a whole number", "a mapping of keys to values", "a list"
KINDS = {
    "string_type": "text",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "int_type": WHOLE,
    "int_parsing": WHOLE,
    "int_from_float": WHOLE,
    "int_parsing_size": "a whole number of fewer digits",
    "float_type": NUMBER,
    "float_parsing": NUMBER,
    "finite_number": "a finite number",
    "dict_type": MAPPING,
    "mapping_type": MAPPING,
    "model_type": MAPPING,
    "model_attributes_type": MAPPING,
    "list_type": LIST,
    "tuple_type": LIST,
    "none_required": "null",
    "literal_error": "{expected}",
    "greater_than": "greater than {gt}",
    "greater_than_equal": "at least {ge}",
    "less_than": "less than {lt}",
    "less_than_equal": "at most {le}",
}
"""What must stand at the key, by pydantic's type of the fault; braces hold entries of its context."""

LENGTHS = {
    "string_too_short": "must have {min_length} or more characters",
    "string_too_long": "must have {max_length} or fewer characters",
    "too_short": "must have {min_length} or more entries, not {actual_length}",
    "too_long": "must have {max_length} or fewer entries, not {actual_length}",
}
"""Likewise, of faults whose value is not in the message."""

PATTERNS = {
    "^[A-Za-z][A-Za-z0-9_]*$": "must have letters, digits and _, a letter first",
}
"""What a text must be, by the pattern that it does not match."""

QUOTED = "; leave the quotation marks out"
LONGEST_VALUE = 60

Location = tuple[int | str, ...]

Model = TypeVar("Model", bound=BaseModel)


def validated(
    path: Path | str, model: type[Model], data: Mapping[str, Any], below: tuple[str, ...] = ()
) -> Model:
    """`data`, read from `path`, as a `model`; UserError by `explain` if it does not fit.

    below: the keys of the file under which `data` stands, by default none.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        for kind, marks in {} if below else MARKS.items():
            if marks <= model.model_fields.keys():
                refuse_other_kind(path, data, kind)
        raise explain(path, error, model, lambda loc: _in_data(loc, data), below) from error


def _in_data(loc: Location, data: Any) -> Location:
    """A place without the parts on the way to it that `data` does not have: the kinds of a union."""
    place = []
    for part in loc[:-1]:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            continue
        place.append(part)
    return (*place, *loc[-1:])


def explain(
    path: Path | str,
    error: ValidationError,
    model: type[BaseModel] | None = None,
    located: Callable[[Location], Location] = lambda place: place,
    below: tuple[str, ...] = (),
) -> UserError:
    """One line for each fault of a ValidationError: file, dotted key, what is allowed.

    With `model`, an unknown key is answered with the nearest known one. located: as of `explanations`; below:
    as of `validated`.
    """
    lines = [
        ": ".join(filter(None, (str(path), ".".join(filter(None, (*below, key))), message)))
        for key, message in explanations(error, model, located)
    ]
    others = len(_faults(error)) - len(lines)
    return UserError("\n".join(lines + ([f"{path}: and {counted(others, 'more fault')}"] if others else [])))


def explanations(
    error: ValidationError,
    model: type[BaseModel] | None,
    located: Callable[[Location], Location] = lambda place: place,
) -> list[tuple[str, str]]:
    """The dotted key and the explanation of up to MOST faults in a ValidationError, the most telling first.

    A misspelt key is two faults, one that is unknown and one that is missing; a wrong choice, such as a
    thruster's kind, makes keys unknown that are not. located: the place of a fault as the file's reader knows
    it, from pydantic's.
    """
    return [_explanation(fault, located(fault["loc"]), model) for fault in _faults(error)[:MOST]]


def _faults(error: ValidationError) -> list[ErrorDetails]:
    """The most telling first; without lists that are too short only because an entry of theirs is faulty."""
    faults = error.errors(include_url=False)
    holders = {fault["loc"][:depth] for fault in faults for depth in range(len(fault["loc"]))}
    own = [fault for fault in faults if fault["type"] != "too_short" or fault["loc"] not in holders]
    return sorted(own, key=lambda fault: TELLING.get(fault["type"], len(TELLING)))


def _explanation(fault: ErrorDetails, loc: Location, model: type[BaseModel] | None) -> tuple[str, str]:
    key = clipped(".".join(clipped(part) for part in loc if part != KEY_ITSELF), 200)
    return key, _message(fault, loc, model)


def _message(fault: ErrorDetails, loc: Location, model: type[BaseModel] | None) -> str:
    kind = fault["type"]
    context = {
        key: f"{held:g}" if isinstance(held, float) else held for key, held in fault.get("ctx", {}).items()
    }
    if kind == "extra_forbidden":
        return f"unknown key{_suggestion(loc, model)}"
    if kind == "missing":
        return "is missing; add it"
    if kind == "json_invalid":
        return f"is not JSON ({context['error']})"
    if kind == "union_tag_not_found":
        return f"{context['discriminator']} is missing; add it"
    if kind == "union_tag_invalid":
        return f"{context['discriminator']} must be one of {context['expected_tags']}"
    if kind in LENGTHS:
        return LENGTHS[kind].format(**context)
    if kind in KINDS:
        message = f"must be {KINDS[kind].format(**context)}"
    elif kind == "string_pattern_mismatch":
        message = PATTERNS.get(context["pattern"], f"must match the pattern {context['pattern']}")
    else:  # a complaint of our own
        return clipped(fault["msg"].removeprefix("Value error, ").replace("\n", " "), 500)
    value = in_yaml(fault["input"])
    message += "" if len(value) > LONGEST_VALUE else f", not {value}"
    return clipped(message, 500) + (QUOTED if _is_quoted_number(fault) else "")


def in_yaml(value: Any) -> str:
    """A value as a YAML file has it, on one line."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key}: {in_yaml(held)}' for key, held in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(in_yaml, value))}]"
    words = {None: "null", True: "true", False: "false"}
    return words[value] if value is None or isinstance(value, bool) else repr(value)


def _is_quoted_number(fault: ErrorDetails) -> bool:
    """Whether text stands where a number must, and is one."""
    text = fault["input"]
    if KINDS.get(fault["type"]) not in (WHOLE, NUMBER) or not isinstance(text, str):
        return False
    return re.fullmatch(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*", text) is not None


def _suggestion(loc: Location, model: type[BaseModel] | None) -> str:
    known = sorted(_known_keys(loc[:-1], model)) if model else []
    return nearest(str(loc[-1]), known) if known else "; remove it or correct its name"


def nearest(word: str, known: Iterable[str]) -> str:
    """The end of a complaint about an unknown word: the known one most like it, and all the known ones."""
    known = list(known)
    near = likest(clipped(word), known)
    hint = f"; did you mean {near!r}?" if near else ";"
    return f"{hint} known here: {', '.join(known)}"


def likest(word: str, known: Iterable[str]) -> str | None:
    """The known word most like a word, or None where none is like it."""
    return next(iter(alike(word, known, 1)), None)


def alike(word: str, known: Iterable[str], most: int = 3) -> list[str]:
    """At most so many known words that are like a word, the likest first."""
    ranked = sorted(known, key=lambda other: likeness(word, other), reverse=True)
    return [other for other in ranked[:most] if likeness(word, other) >= LIKE]


def likeness(one: str, other: str) -> float:
    """How much of two words is the same, from 0 to 1.

    By the edits from one to the other (optimal string alignment: letters that are left out, changed, or
    exchanged with the next), or by the parts of PART letters or more that both have in the same order, as
    `heading` in `heading_deg`. Shorter parts are in many words, such as `p` and `th` of `depth` in `pitch`.
    """
    edits = 1.0 - _edits(one, other) / max(len(one), len(other), 1)
    blocks = difflib.SequenceMatcher(None, one, other).get_matching_blocks()
    shared = sum(block.size for block in blocks if block.size >= PART)
    return max(edits, 2.0 * shared / max(len(one) + len(other), 1))


def _edits(one: str, other: str) -> int:
    before, above, row = list[int](), list[int](), list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        before, above, row = above, row, [i]
        for j, known in enumerate(other, 1):
            least = min(row[-1] + 1, above[j] + 1, above[j - 1] + (letter != known))
            if i > 1 and j > 1 and (letter, one[i - 2]) == (other[j - 2], known):
                least = min(least, before[j - 2] + 1)
            row.append(least)
    return row[-1]


def _known_keys(loc: Location, model: type[BaseModel]) -> set[str]:
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
