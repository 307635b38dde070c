"""Counts of an attack: what was tried, how often, and what of it cannot be explained; kept as they come."""

import json
import re
from collections.abc import Iterable
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


def table(counts: Iterable[Count], order: Iterable[str]) -> str:
    """Markdown, a row for each attack, in the order of the parts."""
    parts = list(order)
    rows = ["| attack | | tried | unexplained | |", "| :-- | :-- | --: | --: | :-- |"]
    for one in sorted(counts, key=lambda count: (parts.index(count.part), count.what)):
        rows.append(f"| {one.part} | {one.what} | {one.tried:,} | {len(one.unexplained)} | {one.note} |")
    return "\n".join(rows)


def write_table(folder: Path, order: Iterable[str]) -> None:
    """Write the counts that are kept in a folder into docs/security.md."""
    write_parts(PAGE, {PART: table(kept(folder), order)})
