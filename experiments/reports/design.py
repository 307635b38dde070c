"""A design on the disk: its file, tables, figure and boat file, all or nothing, and lines to print."""

import csv
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swamp_rl.boat import load_boat
from swamp_rl.boat.part import Part
from swamp_rl.files import find_config, read_yaml, yaml_text
from swamp_rl.unfinished import folder_beside

RESULT, DESIGN, BOAT = "design.json", "design.yaml", "boat.yaml"


@dataclass(frozen=True)
class Quantity:
    """A number of a design by its key, in SI units, and what it is; shown: how a person reads it."""

    key: str
    value: float
    unit: str
    meaning: str
    shown: str = ""

    @property
    def line(self) -> str:
        """For the terminal."""
        return f"{self.meaning:<48} {self.shown or f'{self.value:.4g} {self.unit}'.replace(' 1', '')}"


@dataclass(frozen=True)
class Table:
    """A CSV: its file's name, its columns with their units, its rows."""

    name: str
    columns: Mapping[str, str]
    rows: Sequence[Sequence[Any]]


def write_design(
    out: Path,
    asked: str,
    content: Mapping[str, Any],
    tables: Iterable[Table],
    picture: tuple[str, Callable[[Path], None]],
    boat_file: Mapping[str, Any] | None = None,
) -> None:
    """Write a design into the folder `out`; UserError, and nothing written, where `out` holds something else.

    asked: the design file's name or path, a copy of which is kept; content: of the JSON; picture: file name
    and who draws it; boat_file: what a boat file takes of the design.
    """
    tables = list(tables)
    with folder_beside(out, replaces=RESULT) as part:
        design = yaml_text(read_yaml(find_config("designs", asked)))
        (part / DESIGN).write_text(design, encoding="utf-8")
        units = {table.name: dict(table.columns) for table in tables}
        text = json.dumps({**content, "units": units}, indent=1, allow_nan=False, ensure_ascii=False)
        (part / RESULT).write_text(text + "\n", encoding="utf-8")
        for table in tables:
            with (part / table.name).open("w", encoding="utf-8", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(table.columns)
                writer.writerows(table.rows)
        name, draw = picture
        draw(part / name)
        if boat_file is not None:
            (part / BOAT).write_text(yaml_text(boat_file), encoding="utf-8")


def boat_file(extended: str, changes: Mapping[str, Any]) -> dict[str, Any]:
    """A boat file that extends a boat, by name or path, with changes; UserError where they do not fit."""
    load_boat(extended, changes)
    path = find_config("boats", extended)
    named = Path(extended).suffix == "" and len(Path(extended).parts) == 1
    return {"extends": extended if named else str(path.absolute()), **changes}


def designed(value: float, unit: str, source: str) -> dict[str, Any]:
    """A number of a boat file that a design gives."""
    return {"value": value, "unit": unit, "provenance": "assumed", "source": source}


def as_json(quantities: Iterable[Quantity]) -> dict[str, Any]:
    """Value and unit of each by its key."""
    return {one.key: {"value": one.value, "unit": one.unit} for one in quantities}


def spec(design: Part) -> dict[str, Any]:
    """A design file's numbers, bare, in SI units."""
    return design.model_dump(mode="json")
