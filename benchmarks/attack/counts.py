"""Counts of an attack: what was tried, how often, and what of it cannot be explained; kept as they come."""

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

from benchmarks.markers import DOCS, write_parts

PAGE, PART = DOCS / "security.md", "attacks"


@dataclass(frozen=True)
class Count:
    """One kind of attack by one part of this package, with one seed; `note`: what was measured besides."""

    part: str
    what: str
    tried: int
    unexplained: list[str] = field(default_factory=list)
    note: str = ""
    seed: int = 0

    def keep(self, folder: Path) -> None:
        """Write it into a folder, in place of an earlier count of the same attack with the same seed."""
        folder.mkdir(parents=True, exist_ok=True)
        name = re.sub("[^a-z0-9]+", "-", f"{self.part} {self.what} {self.seed}".lower())
        (folder / f"{name}.json").write_text(json.dumps(asdict(self), indent=1) + "\n")


def kept(folder: Path) -> list[Count]:
    """The counts in a folder, those of several seeds as one."""
    counts: dict[tuple[str, str], Count] = {}
    for path in sorted(folder.glob("*.json")):
        one = Count(**json.loads(path.read_text()))
        same = counts.get((one.part, one.what), Count(one.part, one.what, 0))
        counts[one.part, one.what] = Count(
            one.part, one.what, same.tried + one.tried, same.unexplained + one.unexplained, one.note
        )
    return list(counts.values())


HEAD = ["| attack | target | cases | failures | remarks |", "| :-- | :-- | --: | --: | :-- |"]


def table(counts: Iterable[Count], order: Iterable[str], before: str = "") -> str:
    """Markdown, a row for each attack, in the order of the parts; those of the table before that were not
    counted again stay."""
    parts = list(order)
    rows = dict(_rows(before))
    for one in counts:
        row = f"| {one.part} | {one.what} | {one.tried:,} | {len(one.unexplained)} | {one.note} |"
        rows[one.part, one.what] = row
    named = sorted(rows, key=lambda name: (parts.index(name[0]), name[1]))
    return "\n".join([*HEAD, *(rows[name] for name in named)])


def _rows(table: str) -> Iterator[tuple[tuple[str, str], str]]:
    """Rows of such a table by part and attack."""
    for row in table.splitlines():
        cells = [cell.strip() for cell in row.split("|")]
        if row not in HEAD and len(cells) == 7:
            yield (cells[1], cells[2]), row


def write_table(folder: Path, order: Iterable[str]) -> None:
    """Write the counts that are kept in a folder into docs/security.md, in place of those of the same
    attacks."""
    text = PAGE.read_text(encoding="utf-8")
    before = text.partition(f"<!-- {PART} -->")[2].partition(f"<!-- end {PART} -->")[0]
    write_parts(PAGE, {PART: table(kept(folder), order, before)})
