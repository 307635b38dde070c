"""How Sphinx builds the site: `make docs`."""

import re
import sys
from pathlib import Path
from typing import Any

from pydantic import BaseModel

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import swamp_rl  # noqa: E402
from docs.generate import PARTS  # noqa: E402

project, author, version = "swamp_rl", "the swamp_rl contributors", swamp_rl.__version__
copyright = author
extensions = ["myst_parser", "sphinx.ext.autodoc"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["generate"]
nitpicky = True
nitpick_ignore_regex = [  # other projects' types, and those of fields that are not public
    ("py:.*", r"(?!swamp_rl\.).*"),
    ("py:class", r"swamp_rl\.effects\.(distributions|random_entry|correlated|fit)\..*"),
    ("py:class", r"swamp_rl\.boat_fit\.(pieces|wiring|fit|boat_file)\..*"),
    ("py:class", r"swamp_rl\.criticism\.result\.Predictors"),
    ("py:class", r"swamp_rl\.boat\.likeness\.Build"),
]
myst_enable_extensions = ["smartquotes"]
myst_heading_anchors = 4

default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
python_maximum_signature_line_length = 80
add_module_names = False
toc_object_entries = False

html_theme = "furo"
html_title = f"swamp_rl {version}"
html_copy_source = html_show_sourcelink = html_show_sphinx = False
html_static_path, html_css_files = ["static"], ["site.css"]
pygments_style, pygments_dark_style = "default", "monokai"

GENERATED = re.compile(r"^<!-- generated: (.+) -->$", re.MULTILINE)
FROM_ROOT = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "examples": "examples.md",
}
LINK = re.compile(r"\]\((?![a-z]+:|#)([^)\s]+)\)")
WORDS = re.compile(r"(`[^`]*`)")


def setup(app: Any) -> None:
    """Have Sphinx call the hooks below."""
    app.connect("source-read", write_generated)
    app.connect("autodoc-process-docstring", markdown_to_rst)
    app.connect("autodoc-process-signature", without_annotations)


def write_generated(app: Any, page: str, source: list[str]) -> None:
    """Replace the marks of a page by what they name."""
    source[0] = GENERATED.sub(lambda mark: part(mark[1]), source[0])


def part(name: str) -> str:
    """A generated part of the reference, or a page of the repository's root with its links mended."""
    if name in PARTS:
        return PARTS[name]()
    return LINK.sub(lambda link: f"]({from_docs(link[1])})", (ROOT / name).read_text(encoding="utf-8"))


def from_docs(target: str) -> str:
    """A link of a page in the root as one of a page in docs/."""
    return FROM_ROOT.get(target) or (target.removeprefix("docs/") if "docs/" in target else f"../{target}")


def markdown_to_rst(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Escape what a docstring means literally and reStructuredText would not."""
    for number, line in enumerate(lines):
        words = WORDS.split(line)
        words[::2] = [re.sub(r"([*|\\]|_\b)", r"\\\1", word) for word in words[::2]]
        lines[number] = "".join(words)


def without_annotations(app: Any, what: str, name: str, thing: Any, *rest: Any) -> tuple[str, None] | None:
    """No signature for a model of a file: the file's reference has its keys."""
    return ("", None) if isinstance(thing, type) and issubclass(thing, BaseModel) else None
