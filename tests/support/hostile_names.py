"""Names as a stranger would choose them, and what must be left alone whatever they say."""

from pathlib import Path
from typing import Any

import yaml
from hypothesis import settings
from hypothesis import strategies as st

from swamp_rl.errors import UserError

SECRET = "extends: swamp\nname: secret\n"
PIECES = st.text("./\\~a-\n\0 é", max_size=12)
ENDS = st.sampled_from(["", ".yaml", ".yml", ".csv", ".parquet", ".course.yaml"])
WAYS = st.sampled_from(
    [
        "../victim/boat",
        "../../victim/boat",
        "{root}/victim/boat",
        "/etc/passwd",
        "..",
        ".",
        "victim/../../victim/boat",
        "\x1b[2J",
        "\u202eevil",
        "[/red]",
        "<script>",
        "=1+1|",
    ]
)
LONG = st.just("a" * 300)
HOSTILE = st.builds(str.__add__, PIECES | WAYS | LONG, ENDS)
NAMES = (
    "../victim/boat",
    "/etc/passwd",
    "..",
    "nul\0byte",
    "x" * 5000,
    "\x1b[2Jred\x1b[31m",
    "\x1b]0;title\x07",
    "\u202eevil",
    "\x9b31m",
    "line\nend",
    "\rover",
    "\u2028apart",
    "  ",
    "",
)
"""Of topics, fields and types in the files of recorders, which may be any text."""
EXAMPLES = settings(max_examples=25)


def victims(root: Path) -> None:
    """Files in `root`/victim that hostile names lead to."""
    (root / "victim").mkdir()
    for name in ("boat.yaml", "boat.csv", "boat.course.yaml", "boat"):
        (root / "victim" / name).write_text(SECRET)


def around(here: Path) -> dict[str, bytes]:
    """Every file in the folder of `here` but not in `here`, by path."""
    files = (path for path in here.parent.rglob("*") if path.is_file() and here not in path.parents)
    return {str(path): path.read_bytes() for path in files}


def written(path: Path, meta: dict[str, Any]) -> None:
    """Write as YAML what this package would refuse to write."""
    path.write_text(yaml.safe_dump(meta))


def message_of(act: Any, *given: Any, **named: Any) -> str:
    """The complaint of an act, in one line; empty if it had none. Anything but UserError fails the test."""
    try:
        act(*given, **named)
    except UserError as error:
        assert all(line.isprintable() for line in str(error).split("\n"))
        return str(error)
    return ""


def assert_harmless(message: str, lines: int | None = None) -> None:
    """What is printed has nothing that a terminal acts on, no line without end, at most so many lines."""
    shown = message.split("\n")
    assert all(line.isprintable() and len(line) < 2500 for line in shown), message[:500]
    assert lines is None or len(shown) - 1 <= lines, message[:500]
