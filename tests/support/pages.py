"""Code blocks of Markdown pages, run as a reader would run them: in order, in one folder.

A block is run by its language. `console`: lines after `$ ` are commands, the others what they print.
`python` and `yaml` that begin with a comment `# NAME.py` or `# NAME.yaml` are files to be written. Other
`python` is run in one namespace for the page, and a `text` block right after it is what it prints. Other
`yaml`, `json` and `toml` must parse. `...` in what is printed stands for anything.

A comment `<!-- not run: REASON -->` before a block leaves it out; its `swamp-rl` commands must still have
known verbs and options. A block without a language is left out.
"""

import contextlib
import doctest
import io
import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer
import yaml
from markdown_it import MarkdownIt
from swamp_rl.experiments.cli.app import app

from tests.support import forks
from tests.support.patience import PATIENCE

ROOT = Path(__file__).resolve().parents[2]
NOT_RUN = re.compile(r"<!-- not run: (.+) -->")
FILE = re.compile(r"# ([\w.-]+\.(?:py|yaml|toml))\n")
SAME = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
LANGUAGES = ("console", "python", "yaml", "json", "toml", "text", "bibtex")


@dataclass(frozen=True)
class Block:
    """A block of a page. line: where it begins; reason: why it is not run, empty where it is."""

    language: str
    text: str
    line: int
    reason: str
    follows_code: bool


def blocks(page: Path) -> list[Block]:
    """The code blocks of a page, those of Sphinx left out; an indented one has no language."""
    found: list[Block] = []
    before: Any = None
    for token in MarkdownIt().parse(page.read_text(encoding="utf-8")):
        if token.type in ("fence", "code_block") and not token.info.startswith("{"):
            mark = (
                NOT_RUN.fullmatch(before.content.strip()) if before and before.type == "html_block" else None
            )
            follows = before is not None and before.type == "fence"
            line = token.map[0] + 1
            found.append(Block(token.info.strip(), token.content, line, mark[1] if mark else "", follows))
        before = token
    return found


def run_page(page: Path, folder: Path) -> int:
    """Run the blocks of a page in `folder`, the working directory; how many were run."""
    names: dict[str, Any] = {"__name__": "__page__"}
    printed, count = "", 0
    for block in blocks(page):
        where = f"{page.name}, line {block.line}"
        if block.reason:
            check_options(block, where)
        elif file := FILE.match(block.text):
            (folder / file[1]).write_text(block.text, encoding="utf-8")
        elif block.language == "console":
            for command, expected in commands(block.text):
                assert_prints(expected, call(command, folder, where), f"{where}: {command}")
        elif block.language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(block.text, where, "exec"), names)
            printed = out.getvalue()
        elif block.language == "text" and block.follows_code:
            assert_prints(block.text, printed, where)
        elif block.language == "yaml":
            yaml.safe_load(block.text)
        elif block.language == "json":
            json.loads(block.text)
        elif block.language == "toml":
            tomllib.loads(block.text)
        count += bool(block.language) and not block.reason
    return count


def commands(text: str) -> Iterator[tuple[str, str]]:
    """The commands of a console block with what they print; a line that ends in a backslash goes on."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        lines = part.splitlines()
        length = next(i for i, line in enumerate(lines) if not line.endswith("\\")) + 1
        yield "\n".join(lines[:length]), "\n".join(lines[length:])


def environment() -> dict[str, str]:
    """This checkout and its commands first; one thread, since tests run side by side."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    own = {"PATH": path, "PYTHONPATH": str(ROOT), "COLUMNS": "120"}
    own |= {"OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    return {**os.environ, **own}


def call(command: str, folder: Path, where: str) -> str:
    """What a command prints in `folder`; AssertionError where it fails."""
    words = shlex.split(command.replace("\\\n", " "), comments=True)
    if words[0] == "swamp-rl":
        done = forks.run(forks.COMMAND, words, folder, environment())
    else:
        done = subprocess.run(
            command,
            shell=True,
            cwd=folder,
            env=environment(),
            capture_output=True,
            text=True,
            timeout=PATIENCE,
        )
    assert done.returncode == 0, f"{where}: {command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def assert_prints(expected: str, printed: str, where: str) -> None:
    """An empty expectation is met by anything."""
    same = doctest.OutputChecker().check_output(expected.strip() + "\n", printed.strip() + "\n", SAME)
    assert not expected.strip() or same, f"{where}\nexpected:\n{expected}\nprinted:\n{printed}"


def check_options(block: Block, where: str) -> None:
    """The `swamp-rl` commands of a block that is not run have known verbs and options."""
    for line in block.text.replace("\\\n", " ").splitlines():
        words = shlex.split(line.removeprefix("$ "), comments=True)
        if words[:1] == ["swamp-rl"]:
            check_command(words[1:], where)


def check_command(words: list[str], where: str) -> None:
    """AssertionError where a command line could not be parsed."""
    context = typer.Context(typer.main.get_command(app), info_name="swamp-rl")
    try:
        name, verb, rest = context.command.resolve_command(context, list(words))
        while hasattr(verb, "commands"):
            context = typer.Context(verb, info_name=name, parent=context)
            name, verb, rest = verb.resolve_command(context, rest)
        verb.make_context(name, rest, parent=context)
    except typer.TyperException as error:
        raise AssertionError(f"{where}: swamp-rl {' '.join(words)}: {error.format_message()}") from error
