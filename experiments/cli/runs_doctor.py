"""`swamp-rl runs doctor`: plausibility checks of recorded runs before they are used."""

import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from swamp_rl.experiments.cli.runs import BoatOption, boat_for, runs_app

from swamp_rl.counted import counted

if TYPE_CHECKING:
    from swamp_rl.doctor.finding import Finding
    from swamp_rl.doctor.read import Records

Folders = Annotated[list[Path], typer.Argument(help="Folders of runs.")]


@dataclass(frozen=True)
class Examined:
    """A folder of runs and what is odd about them."""

    folder: Path
    records: "Records"
    findings: "list[Finding]"

    @property
    def faults(self) -> int:
        """How many findings are faults."""
        return sum(finding.level == "fault" for finding in self.findings)

    @property
    def rows(self) -> int:
        """Of all runs."""
        return sum(len(next(iter(run.columns.values()), [])) for run in self.records.runs)


@runs_app.command()
def doctor(
    folder: Folders,
    boat: BoatOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the findings as JSON.")] = False,
) -> None:
    """Find swapped, inverted, stuck or filtered columns, wrong units, times, latency; exit code 1 if any."""
    import json

    every = [_examined(one, boat) for one in folder]
    if as_json:
        results = [_as_json(one) for one in every]
        typer.echo(json.dumps(results if len(results) > 1 else results[0], indent=2, allow_nan=False))
    else:
        typer.echo("\n\n".join("\n".join(_lines(one)) for one in every))
    if any(one.faults or one.records.faults for one in every):
        raise typer.Exit(1)


def _examined(folder: Path, boat: str | None) -> Examined:
    """By itself: runs of another dataset would hide a fault that those of this one have."""
    from swamp_rl.doctor.examine import examine
    from swamp_rl.doctor.read import read_records

    records = read_records(folder, boat_for(folder, boat))
    return Examined(folder, records, examine(records.runs, records.boat, records.measured))


def _as_json(one: Examined) -> dict[str, Any]:
    """Plain types."""
    return {
        "folder": str(one.folder),
        "layout": one.records.layout,
        "boat": one.records.boat.name if one.records.boat else None,
        "runs": len(one.records.runs),
        "rows": one.rows,
        "format_faults": one.records.faults,
        "findings": [finding.as_json() for finding in one.findings],
    }


def _lines(one: Examined) -> Iterator[str]:
    """A line for each finding, and one for all runs."""
    records = one.records
    yield from map(str, one.findings)
    for line in records.faults[:20]:
        yield f"format: {line}"
    if len(records.faults) > 20:
        quoted = shlex.quote(str(one.folder))
        yield f"format: and {len(records.faults) - 20} more (swamp-rl runs check {quoted})"
    without = (
        "" if records.boat else "; no boat is known: commands were recognised by their names (--boat NAME)"
    )
    of = f"{counted(len(records.runs), 'run')}, {one.rows} rows"
    faulty = f"{counted(one.faults, 'fault')}, {counted(len(one.findings) - one.faults, 'note')}"
    yield f"{one.folder} ({records.layout}): {of}, {faulty}{without}"
