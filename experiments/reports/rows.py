"""Numbers as a CSV file."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path


def write_rows(path: Path, head: Sequence[str], rows: Iterable[Iterable[float]]) -> None:
    """Write rows of numbers to nine digits under their heads."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows([f"{value:.9g}" for value in row] for row in rows)
