"""Messages print and can be read, whatever they quote."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.errors import LONGEST, UserError, errors_at


@given(st.text(max_size=30), st.integers(1, 400))
def test_each_line_of_an_error_prints_and_is_short(text: str, times: int) -> None:
    for line in str(UserError(text * times)).split("\n"):
        assert line == "" or (line.isprintable() and len(line) <= LONGEST)


def test_what_is_reported_a_file_names_it_on_each_line() -> None:
    with pytest.raises(UserError) as refused, errors_at("a.yaml: loads"):
        raise UserError("mass: no\ndraught: no")
    assert str(refused.value) == "a.yaml: loads: mass: no\na.yaml: loads: draught: no"


def test_a_short_printable_line_is_reported_as_it_is() -> None:
    assert str(UserError("a.yaml: step: must be positive")) == "a.yaml: step: must be positive"
