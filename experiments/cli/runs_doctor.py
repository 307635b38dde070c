"""`swamp-rl runs doctor`: plausibility checks of recorded runs before they are used."""

import shlex
from typing import Annotated

import typer
from swamp_rl.experiments.cli.runs import BoatOption, Folder, boat_for, runs_app

from swamp_rl.counted import counted


@runs_app.command()
def doctor(
    folder: Folder,
    boat: BoatOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the findings as JSON.")] = False,
) -> None:
    """Find swapped, inverted, stuck or filtered columns, wrong units, times, latency; exit code 1 if any."""
    import json

    from swamp_rl.doctor.examine import examine
    from swamp_rl.doctor.read import read_records

    records = read_records(folder, boat_for(folder, boat))
    found = examine(records.runs, records.boat, records.measured)
    faults = sum(finding.level == "fault" for finding in found)
    rows = sum(len(next(iter(run.columns.values()), [])) for run in records.runs)
    if as_json:
        result = {
            "folder": str(folder),
            "layout": records.layout,
            "boat": records.boat.name if records.boat else None,
            "runs": len(records.runs),
            "rows": rows,
            "format_faults": records.faults,
            "findings": [finding.as_json() for finding in found],
        }
        typer.echo(json.dumps(result, indent=2, allow_nan=False))
    else:
        for finding in found:
            typer.echo(str(finding))
        for line in records.faults[:20]:
            typer.echo(f"format: {line}")
        if len(records.faults) > 20:
            quoted = shlex.quote(str(folder))
            typer.echo(f"format: and {len(records.faults) - 20} more (swamp-rl runs check {quoted})")
        without = (
            ""
            if records.boat
            else "; no boat is known: commands were recognised by their names (--boat NAME)"
        )
        of = f"{counted(len(records.runs), 'run')}, {rows} rows"
        faulty = f"{counted(faults, 'fault')}, {counted(len(found) - faults, 'note')}"
        typer.echo(f"{folder} ({records.layout}): {of}, {faulty}{without}")
    if faults or records.faults:
        raise typer.Exit(1)
