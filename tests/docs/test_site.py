"""The site: built without a warning, without the network, and written from the declarations."""

import re
import tomllib
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest
import typer
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from playwright.sync_api import Browser
from swamp_rl.experiments.cli.app import app

import swamp_rl
from docs.generate import PARTS
from docs.generate.markdown import table
from swamp_rl.boat import Boat
from swamp_rl.effects import LIBRARY
from tests.support import forks
from tests.support.pages import ROOT, environment

pytestmark = forks.GROUP

LOADING = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src", "video": "src"}
FOREIGN = re.compile(r"(?:https?:)?//")
IN_STYLES = re.compile(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//")
MARK = re.compile(r"^<!-- generated: (.+) -->$", re.MULTILINE)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built site; a warning fails it."""
    folder = tmp_path_factory.mktemp("site")
    build, out = folder / "build.py", folder / "site"
    build.write_text("import sys\nfrom sphinx.cmd.build import main\nsys.exit(main(sys.argv[1:]))\n")
    words = ["-E", "-W", "--keep-going", "-q", str(ROOT / "docs"), str(out)]
    done = forks.run(forks.SCRIPT, [str(build), *words], folder, environment())
    assert done.returncode == 0, done.stderr
    return out


class Loads(HTMLParser):
    """Addresses that a browser loads by itself."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep what the tag loads; a link to a page is none."""
        address = dict(attrs).get(LOADING.get(tag, ""))
        if address:
            self.found.append(address)


def test_a_page_that_loads_from_elsewhere_is_seen() -> None:
    page = '<a href="https://a.org"></a><link href="https://b.org/x.css"><script src="//c.org/y.js"></script>'
    assert [a for a in Loads(page).found if FOREIGN.match(a)] == ["https://b.org/x.css", "//c.org/y.js"]
    assert IN_STYLES.search("@import 'https://fonts.org/a.css'") and IN_STYLES.search(
        "src: url(//f.org/a.woff)"
    )


def generated() -> Iterator[str]:
    """The names that pages ask for."""
    for page in (ROOT / "docs").rglob("*.md"):
        yield from MARK.findall(page.read_text(encoding="utf-8"))


def test_every_generated_part_has_its_place() -> None:
    assert set(PARTS) <= set(generated())


def test_the_catalogue_has_every_parameter_with_its_unit() -> None:
    sections = re.split(r"^### ", PARTS["effects"](), flags=re.MULTILINE)[1:]
    by_name = {section.split("\n", 1)[0]: section for section in sections}
    assert set(by_name) == set(LIBRARY)
    for name, effect in LIBRARY.items():
        assert effect.source in by_name[name]
        for parameter in effect.parameters:
            assert f"| `{parameter.name}` | {parameter.unit} |" in by_name[name]


def options(command: object, above: str = "swamp-rl") -> Iterator[tuple[str, str]]:
    """Every verb with each of its long options."""
    for name, inner in getattr(command, "commands", {}).items():
        yield from options(inner, f"{above} {name}")
    if not hasattr(command, "commands"):
        for option in command.params:  # type: ignore[attr-defined]
            yield from ((above, long) for long in option.opts if long.startswith("--"))


def test_the_command_line_has_every_verb_and_option() -> None:
    sections = re.split(r"^### ", PARTS["command line"](), flags=re.MULTILINE)[1:]
    by_verb = {section.split("\n", 1)[0]: section for section in sections}
    known = list(options(typer.main.get_command(app)))
    assert ("swamp-rl trial plan", "--out") in known
    missing = [(verb, option) for verb, option in known if f"`{option}" not in by_verb[verb]]
    assert missing == []


def test_the_boat_file_has_every_key_with_its_unit() -> None:
    text = PARTS["boat file"]()
    for key in Boat.model_fields:
        assert f"| `{key}` |" in text
    boat = swamp_rl.load_boat("swamp")
    for dotted, number in boat.provenance.items():
        assert re.search(rf"\| `{dotted.split('.')[-1]}` \| {re.escape(number.unit)} \|", text), dotted


def test_the_licence_of_every_direct_dependency_is_reported() -> None:
    found = [line.split(" | ") for line in PARTS["licences"]().splitlines()[2:]]
    entries = {cells[0].strip("| `"): cells[-1].strip(" |") for cells in found}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    named = [project["dependencies"], *project["optional-dependencies"].values()]
    needed = [Requirement(line) for lines in named for line in lines]
    assert set(entries) == {canonicalize_name(one.name) for one in needed} - {"swamp-rl"}
    unknown = {name for name, licence in entries.items() if licence in ("", "None", "UNKNOWN")}
    absent = {name for name, licence in entries.items() if licence.startswith("not installed")}
    assert not unknown and absent <= {"atheris"}
    assert "LGPL" in entries["pymavlink"] and entries["pydantic"] == "MIT"


def test_a_table_drops_empty_columns_and_escapes_bars() -> None:
    assert table(["a", "b", "c"], [["1|2", "", "3"]]) == "| a | c |\n| :-- | :-- |\n| 1\\|2 | 3 |\n"


@pytest.mark.slow
def test_the_site_loads_nothing_from_elsewhere(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert {"index.html", "effects.html", "drive_and_learn.html"} <= {page.name for page in pages}
    loads = {address for page in pages for address in Loads(page.read_text(encoding="utf-8")).found}
    assert len(loads) > 5
    assert [address for address in loads if FOREIGN.match(address)] == []
    styles = [sheet for sheet in site.rglob("*.css") if IN_STYLES.search(sheet.read_text(encoding="utf-8"))]
    assert styles == []


@pytest.mark.slow
def test_every_public_function_and_effect_can_be_linked_to(site: Path) -> None:
    python = (site / "reference" / "python.html").read_text(encoding="utf-8")
    for name, place in swamp_rl.PUBLIC.items():
        assert ":" not in place or f'id="swamp_rl.{name}"' in python
    effects = (site / "reference" / "effects.html").read_text(encoding="utf-8")
    assert all(f'id="{name.replace("_", "-")}"' in effects for name in LIBRARY)


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", ["index", "reference/python", "reference/effects", "tutorials/diagnose_a_log"]
)
@pytest.mark.timed
def test_a_page_fits_a_phone_and_asks_for_nothing(site: Path, browser: Browser, page: str) -> None:
    tab = browser.new_page(viewport={"width": 390, "height": 844})
    asked: list[str] = []
    tab.on("request", lambda request: asked.append(request.url))
    tab.goto((site / f"{page}.html").as_uri())
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    assert tab.evaluate("Math.max(0, ...[...document.images].map(one => one.height))") <= 844
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
    tab.close()
