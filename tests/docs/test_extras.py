"""Optional packages: each is named by the command that installs it, in errors and on pages that need it."""

import re
import tomllib
from pathlib import Path

import pytest

from swamp_rl.extras import command, missing
from tests.support.pages import ROOT

PAGES = [*sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("docs/tutorials/*.md"))]
NEEDED = {
    "people": r"^\$ swamp-rl record ",
    "gps": r"--link|^\$ swamp-rl (vehicle|helm) |--map latitude=",
    "exchange": r"--mcap|--to (mcap|minari)",
    "logs": r"^\$ swamp-rl runs import \S+\.(BIN|ulg|bag)",
    "onnx": r"^\$ swamp-rl export |onnx:PILOT",
    "ray": r"--ray",
    "video": r"\.mp4",
    "mlflow": r"^ *mlflow:",
    "tensorboard": r"^\$ tensorboard |tensorboard --logdir",
}
"""What on a page needs an extra."""
SOURCES = [path for part in ("swamp_rl", "envs", "experiments") for path in (ROOT / part).rglob("*.py")]


def extras() -> set[str]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    return set(project["optional-dependencies"]) - {"test", "docs", "attack"}


def test_every_extra_is_on_the_page_of_commands_and_is_reported_where_it_is_missing() -> None:
    page = (ROOT / "docs" / "verbs.md").read_text()
    message = "".join(path.read_text() for path in SOURCES)
    for extra in extras():
        assert command(extra) in page
        assert re.search(rf"(missing|command)\([^)]*[\"']{extra}[\"']", message), extra


def test_whatever_cannot_be_imported_is_answered_with_the_command_that_installs_it() -> None:
    assert str(missing("an MP4 needs x", "video", "end it in .gif")) == (
        "an MP4 needs x; pip install 'swamp-rl[video]', or end it in .gif"
    )
    named = [path.name for path in SOURCES if "swamp-rl[" in path.read_text()]
    assert named == ["extras.py"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_names_the_extras_that_it_needs(page: Path) -> None:
    text = page.read_text()
    names = {extra for named in re.findall(r"swamp-rl\[([\w,]+)\]", text) for extra in named.split(",")}
    assert {extra for extra, use in NEEDED.items() if re.search(use, text, re.MULTILINE)} <= names
    assert names <= extras() | {"attack"}
