"""YAML that would need more time or memory than it is long is refused in one line before anything is made."""

import os
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, strategies
from swamp_rl.experiments.config.load import load_experiment

from swamp_rl.errors import UserError
from swamp_rl.files import read_yaml, yaml_text
from swamp_rl.yaml_text import DEEPEST, MOST_BYTES, dumped, parsed

LETTERS = "abcdefghij"
ALIASES = "".join(
    f"{name}: &{name} [{', '.join([f'*{before}' if before else 'x'] * 9)}]\n"
    for before, name in zip(["", *LETTERS], LETTERS, strict=False)
)
MERGES = "a: &a {x: 1, y: 2}\n" + "".join(
    f"{name}: &{name} {{<<: [{', '.join([f'*{before}'] * 9)}]}}\n" for before, name in pairwise(LETTERS)
)
BOMBS = {
    "aliases": (ALIASES, "with its aliases"),
    "merge keys": (MERGES, "with its aliases"),
    "many anchors": ("".join(f"k{i}: &a{i} 1\n" for i in range(20_000)), "anchors and aliases"),
    "an alias of itself": ("a: &a [*a]", "stands for itself"),
    "a merge of itself": ("a: &a {<<: *a}", "stands for itself"),
    "nested lists": ("a: " + "[" * 100_000, "nested more than 100 deep"),
    "nested dashes": ("- " * 100_000, "nested more than 100 deep"),
    "nested keys": ("".join(" " * i + "k:\n" for i in range(1, 300)), "nested more than 100 deep"),
    "many values": ("a: [" + "1," * 1_000_000 + "]", "more than 300000 values"),
    "a long file": ("a: '" + "x" * MOST_BYTES + "'", "is longer than 8 MiB"),
    "many directives": ("".join(f"%TAG !a{i}! b\n" for i in range(200_000)), "directives are not used"),
    "a tag": ("a: !!bool x", "the tag tag:yaml.org,2002:bool is not used"),
    "a time's tag": ("a: !!timestamp x", "is not used"),
    "digits": ("a: " + "9" * 6_000, "a number of more than 100 characters"),
    "hexadecimal digits": ("a: 0x" + "f" * 1_000_000, "a number of more than 100 characters"),
    "sexagesimal digits": ("a: 1" + ":1" * 50_000, "a number of more than 100 characters"),
    "an escape sequence": ('a: "\\e[2J"', "holds the character U+001B"),
    "text turned round": ("a: x\u202etxt.exe", "holds the character U+202E"),
    "a decimal": ("a: 0." + "1" * 1_000, "a number of more than 100 characters"),
}


def refusal(path: Path, text: str) -> str:
    """The one line with which a file of this text is refused, within two seconds of processor time."""
    path.write_text(text)
    begun = time.process_time()
    with pytest.raises(UserError) as caught:
        read_yaml(path)
    assert time.process_time() - begun < 2.0
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    text, message = BOMBS[name]
    assert message in refusal(tmp_path / "file.yaml", text)


@pytest.mark.parametrize("name", [name for name, (text, _) in BOMBS.items() if len(text) < 100_000])
def test_a_bomb_behind_set_is_refused_in_one_line(name: str) -> None:
    text, message = BOMBS[name]
    value = f"{{{text}}}" if text.startswith("a: ") else text
    with pytest.raises(UserError, match=r"override .*malformed YAML") as caught:
        load_experiment("smoke", [f"description={value}"])
    assert message in str(caught.value) or "malformed" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_of_twenty_thousand_unknown_keys_twenty_are_reported_and_the_rest_counted(tmp_path: Path) -> None:
    text = yaml.safe_dump({"name": "x"} | {f"key_{i}": i for i in range(20_000)})
    (tmp_path / "file.yaml").write_text(text)
    begun = time.process_time()
    with pytest.raises(UserError, match=r"unknown key[\s\S]*and 19\d\d\d more faults") as caught:
        load_experiment(tmp_path / "file.yaml")
    assert time.process_time() - begun < 2.0
    assert len(str(caught.value).splitlines()) == 21


@pytest.mark.parametrize(
    "name", ["k" * 100_000, "a\nb", "\x1b[31m", "\u202e"], ids=["long", "line", "ansi", "bidi"]
)
def test_a_name_too_long_or_unprintable_does_not_spoil_the_line(name: str, tmp_path: Path) -> None:
    entries = {"name": "x", "evaluation": {name: 1}, name[:900]: 2}
    (tmp_path / "file.yaml").write_text(yaml.safe_dump(entries))
    with pytest.raises(UserError) as caught:
        load_experiment(tmp_path / "file.yaml")
    for entries in str(caught.value).split("\n"):
        assert entries.startswith(f"{tmp_path}/file.yaml: ")
        assert entries.isprintable()
        assert len(entries) < 1000


LONG = {"bare": "x" * 5_000, "file": "y" * 5_000 + ".yaml", "path": "a/" * 3_000 + "b.yaml", "null": "a\0b"}


@pytest.mark.parametrize("name", LONG.values(), ids=LONG)
def test_a_file_name_too_long_is_no_file(name: str) -> None:
    with pytest.raises(UserError, match=r"no such file|no experiment file named"):
        load_experiment(name)


def test_a_file_that_is_none_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yaml")
    with pytest.raises(UserError, match="is not a regular file"):
        read_yaml(tmp_path / "pipe.yaml")
    with pytest.raises(UserError, match="is not a regular file"):
        read_yaml("/dev/zero")


def test_a_dotted_key_has_a_greatest_depth() -> None:
    with pytest.raises(UserError, match="must be key=value"):
        load_experiment("smoke", [".".join("k" * 10_000) + "=1"])


def test_aliases_and_merge_keys_within_the_limits_stay_what_yaml_says() -> None:
    text = "base: &b {x: 1, y: 2}\nmore: {<<: *b, y: 3}\nagain: [*b, *b]\n"
    base = {"x": 1, "y": 2}
    assert parsed(text) == {"base": base, "more": {"x": 1, "y": 3}, "again": [base, base]}
    assert parsed("[" * DEEPEST + "]" * DEEPEST)


def test_a_date_stays_text() -> None:
    assert parsed("when: 2026-11-22\n") == {"when": "2026-11-22"}
    assert parsed(yaml_text({"when": "2026-11-22"})) == {"when": "2026-11-22"}


WORDS = strategies.sampled_from(
    [
        "a",
        "b: ",
        "- ",
        "[",
        "]",
        "{",
        "}",
        ",",
        "&a ",
        "*a",
        "<<: ",
        "? ",
        "!!int ",
        "|\n",
        "\n",
        "  ",
        "1",
        "'",
    ]
)


@given(strategies.lists(WORDS, max_size=60).map("".join))
def test_within_the_limits_yaml_is_what_the_safe_loader_says(text: str) -> None:
    def outcome(load: Any) -> Any:
        try:
            return load(text)
        except (yaml.YAMLError, ValueError, KeyError, TypeError, IndexError):
            return yaml.YAMLError

    found = outcome(parsed)
    if found is not yaml.YAMLError:
        assert found == outcome(yaml.safe_load)


AMBIGUOUS = ["1:30", "-1:30.5", "12:30:00", "0:30", "017", "-08", "0o17", "0b11", "+0_1"]


@pytest.mark.parametrize("number", AMBIGUOUS)
def test_a_number_that_versions_of_yaml_read_differently_is_refused(tmp_path: Path, number: str) -> None:
    message = refusal(tmp_path / "a.yaml", f"a: 1\nb: {number}\n")
    assert "line 2" in message and number in message and "text in quotes" in message


@pytest.mark.parametrize("text", [*AMBIGUOUS, "yes", "2020-01-01", "1_000", "1e3", "0x1F", "~"])
def test_text_that_looks_like_another_value_is_written_so_that_it_stays_text(text: str) -> None:
    assert parsed(dumped({"a": text, text: [text]})) == {"a": text, text: [text]}


def test_other_spellings_are_read_as_documented() -> None:
    spelled = "a: [0, 0.5, 10, 1_000, 0x1F, 1e-3, yes, no, on, off, true, 2020-01-01, 12:60, 1.2.3]"
    words = [True, False, True, False, True, "2020-01-01", "12:60", "1.2.3"]
    assert parsed(spelled) == {"a": [0, 0.5, 10, 1000, 31, 0.001, *words]}
