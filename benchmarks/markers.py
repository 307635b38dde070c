"""Measured parts of a document, each between two marks; all else in it is written by people."""

from collections.abc import Mapping
from pathlib import Path

from swamp_rl.errors import UserError
from swamp_rl.files import write_text

DOCS = Path(__file__).resolve().parents[1] / "docs"


def write_parts(page: Path, parts: Mapping[str, str]) -> None:
    """Replace what stands between the marks of each name, `<!-- name -->` and `<!-- end name -->`.

    UserError, and nothing written, where a mark is missing.
    """
    text = page.read_text(encoding="utf-8")
    for name, body in parts.items():
        start, end = f"<!-- {name} -->", f"<!-- end {name} -->"
        before, found, rest = text.partition(start)
        _, closed, after = rest.partition(end)
        if not (found and closed):
            raise UserError(f"{page}: the marks {start} and {end} are missing; put them where it belongs")
        text = f"{before}{start}\n{body}\n{end}{after}"
    write_text(page, text)
