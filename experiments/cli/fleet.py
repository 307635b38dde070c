"""`swamp-rl fleet`: many datasets, each diagnosed by itself, and their common causes."""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.options import IgnoreOption, Ray, Workers

from swamp_rl.counted import counted


def fleet(
    dataset: Annotated[
        list[Path], typer.Argument(help="Folders of measured runs, each diagnosed by itself.")
    ],
    out: Annotated[Path, typer.Option(help="The folder to write, or one to resume.")],
    boat: Annotated[
        str | None,
        typer.Option(
            "--boat", help="Boat file for all datasets, name or file; by default each dataset's own."
        ),
    ] = None,
    ignore: IgnoreOption = None,
    workers: Workers = None,
    ray: Ray = None,
) -> None:
    """Diagnose many boats; the same command resumes an interrupted one."""
    from swamp_rl.experiments.fleet import diagnose_fleet, members_of
    from swamp_rl.experiments.fleet.words import outcome_lines

    def tell(name: str, message: str) -> None:
        typer.echo(f"{name}: {message}")

    def tell_kept(kept: int, again: int) -> None:
        if kept or again:
            typer.echo(_kept(kept, again, len(dataset)))

    days = Counter(member.boat for member in members_of(dataset, boat))
    typer.echo(f"diagnosing {counted(len(dataset), 'dataset')} of {_boats(days)}")
    found = diagnose_fleet(dataset, out, boat, ignore or [], workers, ray, tell, tell_kept=tell_kept)
    for line in outcome_lines(found):
        typer.echo(f"  {line}")
    kept = sum(one.kept for one in found.findings)
    failed = sum(one.verdict is None for one in found.members)
    typer.echo(
        f"{out}: fleet.json, fleet.html; {kept} of {len(found.findings)} causes kept, "
        f"{failed} of {len(found.members)} datasets not diagnosed"
    )
    if failed == len(found.members):
        raise typer.Exit(1)


def _kept(kept: int, again: int, of: int) -> str:
    """How many diagnoses an earlier command left, and how many of those are made again."""
    sentence = f"  already diagnosed: {kept} of {of}"
    if again:
        sentence += f"; made again, as the dataset, the boat, --ignore or the version changed: {again}"
    return sentence


def _boats(days: Mapping[str, int]) -> str:
    """The number of boats, and where a boat has several datasets, how many each has."""
    count = counted(len(days), "boat")
    if max(days.values()) == 1:
        return count
    return f"{count} by folder: {', '.join(f'{boat} ({number})' for boat, number in days.items())}"
