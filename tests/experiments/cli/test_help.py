"""The help pages: groups of verbs, an example for each that parses, and no heavy import."""

import shlex
import subprocess
import sys
import time
from collections.abc import Iterator
from resource import RUSAGE_CHILDREN, getrusage

import pytest
import typer
from swamp_rl.experiments.cli.app import app
from swamp_rl.experiments.cli.help import EXAMPLES, PANELS, verb_name

from tests.support.command_line import Call

CLI = [sys.executable, "-m", "swamp_rl"]
HEAVY = {"torch", "numba", "scipy", "matplotlib", "pandas", "pyarrow", "rerun", "stable_baselines3", "ray"}


def verbs(group: typer.Typer = app, above: str = "") -> Iterator[str]:
    """The names of all verbs, those of groups with the group's name."""
    for command in group.registered_commands:
        yield f"{above}{verb_name(command)}"
    for inner in group.registered_groups:
        yield from verbs(inner.typer_instance, f"{above}{inner.name} ")


def test_every_verb_stands_in_a_panel_and_has_an_example(call: Call) -> None:
    assert set(verbs()) == set(EXAMPLES)
    assert {verb.split()[0] for verb in verbs()} == set(PANELS)
    page = call("--help")[1]
    assert all(f"─ {panel} ─" in page for panel in set(PANELS.values()))


@pytest.mark.parametrize("verb", list(verbs()))
def test_the_example_of_a_verb_is_a_valid_command_line(verb: str, call: Call) -> None:
    code, page, _ = call(*verb.split(), "--help")
    words = shlex.split(EXAMPLES[verb])
    assert code == 0 and "Example: swamp-rl" in page
    assert words[: len(verb.split())] == verb.split()
    command = typer.main.get_command(app)
    context = None
    for name in verb.split():
        context = command.make_context(name, [], parent=context, resilient_parsing=True)
        command = command.get_command(context, name)  # type: ignore[attr-defined]
    parsed = command.make_context(verb, words[len(verb.split()) :], parent=context)
    assert not parsed.args


@pytest.mark.timed
def test_help_takes_less_than_a_second_and_imports_nothing_heavy() -> None:
    before, began = getrusage(RUSAGE_CHILDREN), time.perf_counter()
    listed = subprocess.run(
        [sys.executable, "-X", "importtime", *CLI[1:], "--help"], capture_output=True, text=True, check=True
    )
    wall, after = time.perf_counter() - began, getrusage(RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    assert min(wall, used) < 1.0
    modules = {line.rsplit("|", 1)[-1].strip().split(".")[0] for line in listed.stderr.splitlines()}
    assert "swamp_rl" in modules and not modules & HEAVY
