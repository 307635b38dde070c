"""Arithmetic on the columns of a log: `(pwm_left - 1500) / 400`, parsed and evaluated here, never by Python.

    comparison: sum [("<" | "<=" | ">" | ">=" | "==" | "!=") sum]
    sum:        product {("+" | "-") product}
    product:    sign {("*" | "/") sign}
    sign:       "-" sign | "+" sign | power
    power:      atom ["**" sign]
    atom:       number | name | "`" any name "`" | "(" comparison ")"
                | function "(" comparison {"," comparison} ")"

A name is a column, as in `pwm_left`, `Länge`, `ATT.Yaw` or `output[0]`; between backquotes it may be any
text.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.clipped import clipped
from swamp_rl.counted import counted
from swamp_rl.errors import UserError

Array = NDArray[np.float64]

LONGEST = 500
"""Characters of an expression."""
DEEPEST = 40
"""Parentheses, functions, signs and powers in one another."""
QUOTING = "; a column whose name is not a word is put between backquotes, as in `Yaw (deg)`"
TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[^\W\d]\w*(?:\.\w+|\[[0-9]+\])*)|`(?P<quoted>[^`]+)`"
    r"|(?P<sign>\*\*|<=|>=|==|!=|[-+*/(),<>]))"
)
COMPARED: dict[str, Callable[[Array, Array], Array]] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
}
WORKED: dict[str, Callable[[Array, Array], Array]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "**": np.power,
}


def _heading_of(w: Array, x: Array, y: Array, z: Array) -> Array:
    """Rotation about the vertical axis of a unit quaternion [rad]; Diebel (2006), equation 290."""
    return np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def _where(condition: Array, one: Array, other: Array) -> Array:
    return np.asarray(np.where(condition != 0.0, one, other), float)


FUNCTIONS: dict[str, tuple[int, Callable[..., Array]]] = {
    "sin": (1, np.sin),
    "cos": (1, np.cos),
    "tan": (1, np.tan),
    "atan2": (2, np.arctan2),
    "sqrt": (1, np.sqrt),
    "abs": (1, np.abs),
    "sign": (1, np.sign),
    "radians": (1, np.radians),
    "degrees": (1, np.degrees),
    "min": (2, np.minimum),
    "max": (2, np.maximum),
    "clip": (3, lambda value, low, high: np.minimum(np.maximum(value, low), high)),
    "where": (3, _where),
    "yaw": (4, _heading_of),
}
"""Number of arguments and the function; three more need the times."""
TIMED = ("rate", "turn_rate", "integral")


@dataclass(frozen=True)
class Number:
    value: float


@dataclass(frozen=True)
class Name:
    name: str


@dataclass(frozen=True)
class Call:
    """An operator or a function with its arguments."""

    function: str
    arguments: tuple["Node", ...]


Node = Number | Name | Call


def parsed(text: str, timed: bool = True) -> Node:
    """The tree of an expression; UserError with the place where it is none.

    timed: whether the times of its table are known, which the functions of TIMED need.
    """
    if len(text) > LONGEST:
        raise UserError(f"expression {clipped(text)!r}: has {len(text)} characters, at most {LONGEST}")
    reader = _Reader(text, timed)
    node = reader.comparison(0)
    if reader.kind:
        raise reader.refusal("the end of the expression, or an operator")
    return node


def names_in(node: Node) -> Iterator[str]:
    """The columns that an expression reads, in its order."""
    if isinstance(node, Name):
        yield node.name
    elif isinstance(node, Call):
        for argument in node.arguments:
            yield from names_in(argument)


def evaluated(node: Node, columns: Mapping[str, Array], time: Array | None = None) -> Array:
    """The expression's values (T,), not finite where it has none. KeyError: no such column.

    time: (T,) s, for the functions of TIMED.
    """
    with np.errstate(all="ignore"):
        return np.asarray(_value(node, columns, time), float)


def _value(node: Node, columns: Mapping[str, Array], time: Array | None) -> Array:
    if isinstance(node, Number):
        return np.asarray(node.value)
    if isinstance(node, Name):
        return columns[node.name]
    values = [_value(argument, columns, time) for argument in node.arguments]
    if node.function in TIMED:
        return _timed(node.function, values[0], time)
    if node.function in COMPARED:
        return np.asarray(COMPARED[node.function](values[0], values[1]), float)
    if node.function in WORKED:
        return WORKED[node.function](values[0], values[1])
    if node.function == "negative":
        return -values[0]
    return FUNCTIONS[node.function][1](*values)


def _timed(function: str, values: Array, time: Array | None) -> Array:
    """Derivative or integral (T,) over the times in their order, of rows with one time by the last value; an
    integral is 0 at the first time, and linear across gaps."""
    assert time is not None
    timed = np.isfinite(time)
    times, row = np.unique(time[timed], return_inverse=True)
    last = np.empty(len(times))
    last[row] = np.broadcast_to(values, time.shape)[timed]
    found = np.full(len(time), np.nan)
    found[timed] = _over(function, last, times)[row]
    return found


def _over(function: str, values: Array, time: Array) -> Array:
    """Derivative or integral (T,) of values (T,) over increasing times (T,)."""
    if len(values) < 2:
        return np.zeros(len(time))
    known = np.isfinite(values)
    if function == "integral":
        even = np.interp(time, time[known], values[known]) if known.any() else values
        return np.concatenate([[0.0], np.cumsum(np.diff(time) * 0.5 * (even[1:] + even[:-1]))])
    if function == "turn_rate":
        values[known] = np.unwrap(values[known])
    return np.gradient(values, time)


class _Reader:
    """The tokens of an expression, one at a time."""

    def __init__(self, text: str, timed: bool) -> None:
        self.text, self.timed, self.at, self.next_at = text, timed, 0, 0
        self.kind, self.word = "", ""
        self.advance()

    def advance(self) -> None:
        self.at = self.next_at
        if not self.text[self.at :].strip():
            self.kind, self.word = "", ""
            return
        found = TOKEN.match(self.text, self.at)
        if found is None:
            raise self.refusal("a number, a column or an operator")
        self.kind = str(found.lastgroup)
        self.word = found[self.kind]
        self.next_at = found.end()

    def refusal(self, expected: str) -> UserError:
        rest = self.text[self.at :].strip()
        found = repr(clipped(rest, 20)) if rest else "its end"
        return UserError(f"expression {clipped(self.text)!r}: expected {expected}, found {found}{QUOTING}")

    def take(self, *words: str) -> str:
        """The word, where it is one of these signs, which is then behind us; else ''."""
        word = self.word if self.kind == "sign" and self.word in words else ""
        if word:
            self.advance()
        return word

    def comparison(self, depth: int) -> Node:
        node = self.sum(depth)
        sign = self.take(*COMPARED)
        return Call(sign, (node, self.sum(depth))) if sign else node

    def sum(self, depth: int) -> Node:
        node = self.product(depth)
        while sign := self.take("+", "-"):
            node = Call(sign, (node, self.product(depth)))
        return node

    def product(self, depth: int) -> Node:
        node = self.sign(depth)
        while sign := self.take("*", "/"):
            node = Call(sign, (node, self.sign(depth)))
        return node

    def sign(self, depth: int) -> Node:
        if depth > DEEPEST:
            raise UserError(f"expression {clipped(self.text)!r}: is nested deeper than {DEEPEST} levels")
        if sign := self.take("-", "+"):
            inner = self.sign(depth + 1)
            return Call("negative", (inner,)) if sign == "-" else inner
        node = self.atom(depth)
        return Call("**", (node, self.sign(depth + 1))) if self.take("**") else node

    def atom(self, depth: int) -> Node:
        kind, word = self.kind, self.word
        if self.take("("):
            node = self.comparison(depth + 1)
            self.close()
            return node
        if kind not in ("number", "name", "quoted"):
            raise self.refusal("a number, a column or '('")
        self.advance()
        if kind == "number":
            return Number(float(word))
        if kind == "name" and self.take("("):
            return self.call(word, depth)
        return Name(word)

    def call(self, word: str, depth: int) -> Node:
        if word not in FUNCTIONS and word not in TIMED:
            known = ", ".join([*FUNCTIONS, *TIMED])
            raise UserError(
                f"expression {clipped(self.text)!r}: no function {clipped(word)}; there are {known}{QUOTING}"
            )
        if word in TIMED and not self.timed:
            raise UserError(
                f"expression {clipped(self.text)!r}: {word}() needs the times of the table; it cannot be "
                "used in their own expression"
            )
        arguments = [self.comparison(depth + 1)]
        while self.take(","):
            arguments.append(self.comparison(depth + 1))
        self.close()
        count = 1 if word in TIMED else FUNCTIONS[word][0]
        if len(arguments) != count:
            raise UserError(
                f"expression {clipped(self.text)!r}: {word}() takes {counted(count, 'argument')}, "
                f"not {len(arguments)}"
            )
        return Call(word, tuple(arguments))

    def close(self) -> None:
        if not self.take(")"):
            raise self.refusal("')' or an operator")
