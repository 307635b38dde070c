"""JSON that no writer of this package writes, read."""

import json
from pathlib import Path

import pytest
from pydantic import BaseModel

from swamp_rl.errors import UserError
from swamp_rl.json_text import model_in, parsed_json, read_json


class Found(BaseModel):
    value: float
    whole: bool = True


@pytest.mark.parametrize("text", ['{"a": 1, "a": 2}', '{"b": {"a": 1, "c": 0, "a": 1}}'])
def test_a_key_that_is_given_twice_is_refused_by_name(text: str, tmp_path: Path) -> None:
    (tmp_path / "one.json").write_text(text)
    with pytest.raises(UserError, match=r"one.json: is no JSON \(key 'a' is given twice\); write it again"):
        read_json(tmp_path / "one.json", "write it again")


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999", "-1e999", "9" * 400])
def test_a_number_that_is_not_finite_is_refused(number: str) -> None:
    with pytest.raises(ValueError, match=r"finite|digits"):
        parsed_json(f'{{"a": [{number}]}}')


def test_numbers_at_the_end_of_floating_point_are_read() -> None:
    numbers = [1e300, -1e300, 1e-320, 10**18, 0, -0.0]
    assert parsed_json(json.dumps(numbers)) == numbers


@pytest.mark.parametrize("value", ["true", '"1.5"', "null", "NaN", "[1.0]"])
def test_a_model_takes_nothing_else_for_a_number(value: str) -> None:
    with pytest.raises(ValueError):
        model_in(f'{{"value": {value}}}', Found)


@pytest.mark.parametrize("value", ["0", "1", '"true"'])
def test_a_model_takes_nothing_else_for_true_or_false(value: str) -> None:
    with pytest.raises(ValueError):
        model_in(f'{{"value": 1, "whole": {value}}}', Found)


def test_a_model_takes_a_whole_number_for_a_number() -> None:
    assert model_in('{"value": 2}', Found) == Found(value=2.0)
