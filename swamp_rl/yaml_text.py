"""YAML as this project reads and writes it, within limits that are checked before anything is made of it."""

import re
from collections.abc import Mapping
from copy import deepcopy
from functools import lru_cache
from typing import Any

import yaml

from swamp_rl.clipped import ACTS, clipped

DEEPEST = 100
"""Levels of nesting."""
MOST_BYTES = 8 * 2**20
MOST_NODES = 300_000
"""Scalars, lists and mappings, each alias counted as all that it stands for."""
MOST_ANCHORS = 1_000
LONGEST_NUMBER = 100
"""Characters of a number."""
REMEMBERED, LONGEST_REMEMBERED = 64, 50_000
"""Texts that are not read a second time, and their characters: shipped files are read again and again."""

_EXPONENT = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?\d+$")
_AMBIGUOUS = re.compile(r"[-+]?(0[0-9_]+|0b[01_]+|0o[0-7_]+|[0-9][0-9_]*(:[0-5]?[0-9])+(\.[0-9_]*)?)$")
"""Numbers to the base 8, 2 or 60: YAML 1.1 and 1.2 read 017, 0o17 and 1:30 differently."""
_ACTS = re.compile(f"[{ACTS}\ud800-\udfff]")
"""With half letters."""
_DIRECTIVE = re.compile("^%", re.MULTILINE)
_NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")
_TIMESTAMP = "tag:yaml.org,2002:timestamp"

_REMEDIES = {
    "cannot start any token": "indent with spaces, not tabs; put text that begins with @, % or ` in quotes",
    "mapping values are not allowed": "indent keys alike; a space follows a colon, also on the line before",
    "could not find expected ':'": "a colon and a space follow a key, also on the line before",
    "did not find expected key": "indent the keys of one block alike",
    "did not find expected ',' or": "close the bracket that was opened before",
    "unexpected end of stream": "close the quotation mark that was opened before",
    "maximum nesting depth": f"nested more than {DEEPEST} deep",  # the parser's own limit is 1000
}
"""What to do, by words of the parser's problem."""


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """The safe loader, refusing duplicate keys, reading 1e-3 as the number it is (YAML 1.2) and dates as
    text."""


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """The safe dumper, putting text that the loader would read as a number in quotes, and a list of numbers
    on one line.
    """

    def represent_sequence(self, tag: str, sequence: Any, flow_style: bool | None = None) -> yaml.Node:
        """A list; flow_style: as in the base class, chosen by what it holds where None."""
        numbers = all(type(item) in (int, float) for item in sequence)
        return super().represent_sequence(tag, sequence, numbers if flow_style is None else flow_style)


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    seen = set()
    for key, value in node.value:
        if key.tag == "tag:yaml.org,2002:merge" or not isinstance(key, yaml.ScalarNode):
            continue
        if node.flow_style and key.tag in _NUMBERS and _is_left_out(value):  # {gain: 0,5}
            problem = f"{key.value} is no key; a comma ends a value: write decimals with a point, as 0.5"
            raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
        if key.value in seen:
            problem = f"key {clipped(key.value)!r} is given twice"
            raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
        seen.add(key.value)
    loader.flatten_mapping(node)
    return loader.construct_mapping(node, deep=True)


def _is_left_out(value: yaml.Node) -> bool:
    return isinstance(value, yaml.ScalarNode) and value.start_mark.index == value.end_mark.index


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)
_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag != _TIMESTAMP]
    for first, resolvers in _Loader.yaml_implicit_resolvers.items()
}
for _kind in (_Loader, _Dumper):
    _kind.add_implicit_resolver("tag:yaml.org,2002:float", _EXPONENT, list("-+.0123456789"))
_Dumper.add_implicit_resolver("tag:yaml.org,2002:int", _AMBIGUOUS, list("-+0123456789"))
_RESOLVER = _Loader("")


def parsed(text: str) -> Any:
    """What a YAML text holds; yaml.YAMLError or ValueError where it is malformed or beyond the limits.

    Its parts are counted before any of them is made, since aliases and merge keys stand for more than they
    say (a 'billion laughs'). Tags (`!!bool`) are refused.
    """
    return _read(text) if len(text) > LONGEST_REMEMBERED else deepcopy(_remembered(text))


@lru_cache(REMEMBERED)
def _remembered(text: str) -> Any:
    return _read(text)


def _read(text: str) -> Any:
    if _DIRECTIVE.search(text):
        # The compiled parser compares each with all before it.
        raise ValueError("a line begins with %; directives are not used here")
    _refuse_beyond_limits(text)
    return yaml.load(text, Loader=_Loader)


def remedy(problem: str) -> str:
    """The end of a line that tells a problem of the parser: what is usually wrong there, or nothing."""
    return next((f"; {advice}" for words, advice in _REMEDIES.items() if words in problem), "")


def dumped(data: Mapping[str, Any]) -> str:
    """A mapping as YAML; floats keep every bit. yaml.YAMLError or ValueError for what `parsed` refuses."""
    text = yaml.dump(dict(data), Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100)
    _refuse_beyond_limits(text)
    return text


def _refuse_beyond_limits(text: str) -> None:
    """Nodes are counted where they begin; a collection's anchor then stands for those within it."""
    if len(text) > MOST_BYTES:
        raise ValueError(f"is longer than {MOST_BYTES // 2**20} MiB")
    sizes: dict[str, int] = {}
    opened: list[tuple[str | None, int]] = []
    count = anchors = 0
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.AliasEvent):
            if any(anchor == event.anchor for anchor, _ in opened):
                raise _problem(event, f"*{clipped(event.anchor)} stands for itself")
            count += sizes.get(event.anchor, 1)
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = opened.pop()
            if anchor is not None:
                sizes[anchor] = count - before
        elif isinstance(event, yaml.NodeEvent):
            if event.tag is not None:
                raise _problem(event, f"the tag {clipped(event.tag)} is not used here; leave it out")
            count += 1
            if isinstance(event, yaml.CollectionStartEvent):
                opened.append((event.anchor, count - 1))
            else:
                _refuse_acting(event)
                _refuse_odd_number(event)
        if len(opened) > DEEPEST:
            # The compiled loader calls itself at each level, and would end the process far deeper down.
            raise _problem(event, f"nested more than {DEEPEST} deep")
        anchors += isinstance(event, yaml.NodeEvent) and event.anchor is not None
        if anchors > MOST_ANCHORS:
            raise _problem(event, f"more than {MOST_ANCHORS} anchors and aliases")
        if count > MOST_NODES:
            raise _problem(event, f"holds, with its aliases, more than {MOST_NODES} values")


def _refuse_acting(event: yaml.ScalarEvent) -> None:
    found = _ACTS.search(event.value)
    if found is not None:
        raise _problem(event, f"holds the character U+{ord(found[0]):04X}, which does not print")


def _refuse_odd_number(event: yaml.ScalarEvent) -> None:
    if not event.implicit[0]:  # in quotes
        return
    # Reading a number takes the square of its length.
    if len(event.value) > LONGEST_NUMBER:
        if _RESOLVER.resolve(yaml.ScalarNode, event.value, (True, False)) in _NUMBERS:
            raise _problem(event, f"a number of more than {LONGEST_NUMBER} characters")
    elif _AMBIGUOUS.match(event.value):
        message = (
            "is read differently by versions of YAML; write a decimal number, with a point, or text in quotes"
        )
        raise _problem(event, f"{event.value} {message}")


def _problem(event: yaml.Event, problem: str) -> yaml.YAMLError:
    return yaml.MarkedYAMLError(None, None, problem, event.start_mark)
