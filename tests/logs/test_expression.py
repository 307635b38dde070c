"""Expressions: they mean what arithmetic means, and nothing else is taken."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.errors import UserError
from swamp_rl.logs.expression import DEEPEST, LONGEST, evaluated, names_in, parsed

COLUMNS = {"a": np.array([1.0, 2.0, 3.0]), "b": np.array([0.5, -2.0, 4.0]), "GPS.Lat[0]": np.ones(3)}


def trees() -> st.SearchStrategy[str]:
    """Expressions that Python reads as they are meant: with parentheses wherever signs meet."""
    leaves = st.sampled_from(["a", "b"]) | st.floats(0.1, 9.0).map(lambda x: f"{x:.3f}")
    return st.recursive(
        leaves,
        lambda inner: (
            st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})")
            | inner.map(lambda x: f"(-{x})")
            | inner.map(lambda x: f"sin({x})")
            | st.tuples(inner, inner).map(lambda t: f"atan2({t[0]},{t[1]})")
        ),
        max_leaves=8,
    )


@given(text=trees())
def test_an_expression_has_the_value_that_numpy_gives_it(text: str) -> None:
    names = {**COLUMNS, "sin": np.sin, "atan2": np.arctan2}
    with np.errstate(all="ignore"):
        expected = np.broadcast_to(eval(text, {"__builtins__": {}}, names), (3,))
    found = np.broadcast_to(evaluated(parsed(text), COLUMNS), (3,))
    assert found == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 + 3 * 4", 14.0),
        ("2 * 3 ** 2", 18.0),
        ("-2 ** 2", -4.0),
        ("2 ** 3 ** 2", 512.0),
        ("2 ** -1", 0.5),
        ("10 - 4 - 3", 3.0),
        ("8 / 4 / 2", 1.0),
        ("1e3 + .5", 1000.5),
        ("clip(9, -1, 1)", 1.0),
        ("where(2 > 1, 5, 6)", 5.0),
        ("where(2 != 2, 5, 6)", 6.0),
        ("degrees(atan2(1, 1))", 45.0),
        ("sqrt(abs(-16))", 4.0),
        ("`GPS.Lat[0]` + GPS.Lat[0]", 2.0),
    ],
)
def test_operators_bind_as_in_mathematics(text: str, value: float) -> None:
    assert np.broadcast_to(evaluated(parsed(text), COLUMNS), (3,))[0] == pytest.approx(value)


@pytest.mark.parametrize("name", ["Länge", "курс", "速度", "GPS.Höhe"])
def test_a_column_may_have_a_name_of_any_alphabet(name: str) -> None:
    node = parsed(f"2 * {name}")
    assert list(names_in(node)) == [name]
    assert evaluated(node, {name: np.array([1.0, 2.0])}).tolist() == [2.0, 4.0]


def test_the_heading_of_a_quaternion_and_rates_of_change() -> None:
    angle = np.array([0.1, 1.0, -2.0])
    there = {"w": np.cos(angle / 2), "z": np.sin(angle / 2), "x": np.zeros(3), "y": np.zeros(3)}
    assert evaluated(parsed("yaw(w, x, y, z)"), there) == pytest.approx(angle)
    time = np.arange(40) * 0.1
    turning = {"psi": np.mod(3.0 + 0.7 * time, 2 * math.pi), "x": 2.0 * time}
    assert evaluated(parsed("turn_rate(psi)"), turning, time) == pytest.approx(np.full(40, 0.7))
    assert evaluated(parsed("rate(x)"), turning, time) == pytest.approx(np.full(40, 2.0))
    assert evaluated(parsed("integral(x)"), turning, time) == pytest.approx(time**2)
    assert evaluated(parsed("integral(3)"), turning, time) == pytest.approx(3.0 * time)
    lost = {"x": np.where((time > 1.0) & (time < 2.0), np.nan, 2.0 * time)}
    assert evaluated(parsed("integral(x)"), lost, time) == pytest.approx(time**2)


@pytest.mark.parametrize("text", ["rate(x)", "turn_rate(x)", "integral(x)"])
def test_rates_and_integrals_are_those_of_rows_in_the_order_of_their_times(text: str) -> None:
    time = np.arange(40) * 0.1
    order = np.concatenate(
        [np.arange(20, 40), np.arange(20), [5]]
    )  # of two files, the later first; one row twice
    x = np.sin(time)
    found = evaluated(parsed(text), {"x": np.append(x[order], 9.0)}, np.append(time[order], np.nan))
    assert found[:-1] == pytest.approx(evaluated(parsed(text), {"x": x}, time)[order])
    assert np.isnan(found[-1])


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a +",
        "(a",
        "a b",
        "a; b",
        "__import__('os')",
        "eval(a)",
        "a.__class__()",
        "lambda: 1",
        "[a]",
        "a if b else a",
        "a @ b",
        "sin()",
        "sin(a, b)",
        "clip(a)",
        "a < b < a",
        "'a'",
        "€",
        "(" * (DEEPEST + 2) + "a" + ")" * (DEEPEST + 2),
        "-" * (DEEPEST + 5) + "a",
        "a+" * LONGEST + "a",
    ],
)
def test_what_is_no_expression_is_refused_in_one_line(text: str) -> None:
    with pytest.raises(UserError, match="expression") as error:
        parsed(text)
    assert "\n" not in str(error.value)


@given(text=st.text(alphabet="ab01.+-*/()<>=!,`[]_ e9sincwhr\x00é", max_size=60))
def test_any_text_is_an_expression_or_refused(text: str) -> None:
    try:
        node = parsed(text)
    except UserError as error:
        assert "\n" not in str(error)
        return
    there = dict.fromkeys(names_in(node), np.ones(4))
    assert np.broadcast_to(evaluated(node, there, np.arange(4.0)), (4,)).dtype == np.float64
