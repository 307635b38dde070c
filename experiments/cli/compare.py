"""`swamp-rl compare`: results against each other, or all of a folder of results on one page."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from swamp_rl.experiments.cli.options import seed_option
from swamp_rl.experiments.cli.outputs import mark_of, refuse_to_replace

from swamp_rl.counted import counted
from swamp_rl.errors import UserError

if TYPE_CHECKING:
    from rich.table import Table

FOLDER, PAGE = Path("comparison"), Path("leaderboard.html")
DATA = "compare.json"
MOST_DIFFERENCES = 40
"Rows of paired differences on the screen; more are in the files alone."


def compare(
    results: Annotated[
        list[Path] | None,
        typer.Argument(help="Folders of results; each may hold several, of training seeds for example."),
    ] = None,
    leaderboard: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write one sortable page of all results in a folder."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder of compare.md and compare.json (comparison), or the page (leaderboard.html)."
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PILOT", help="Compare this pilot alone, of each result; repeatable. All by default."
        ),
    ] = None,
    seed: Annotated[int, seed_option("Seed of the bootstrap and the permutation test.")] = 0,
) -> None:
    """Compare pilots on the same episodes, with intervals and p-values (Holm), or rank them on a page."""
    from swamp_rl.files import write_text

    if (leaderboard is None) == (not results):
        raise UserError("compare: name folders of results, or one folder with --leaderboard, but not both")
    if leaderboard is not None:
        if only:
            raise UserError("--only: names pilots of a comparison; a leaderboard has them all")
        from swamp_rl.experiments.reports.leaderboard import gather, page

        place = out or PAGE
        refuse_to_replace(str(place), place, [leaderboard])
        found = gather(leaderboard, seed)
        write_text(place, page(found, mark_of(leaderboard)))
        for line in found.left_out:
            typer.echo(f"left out: {line}")
        typer.echo(f"{place}: {counted(len(found.rows), 'row')} of {counted(found.folders, 'result')}")
        return
    from swamp_rl.experiments.evaluation.comparison import compare as compared
    from swamp_rl.experiments.reports.comparison import report

    from swamp_rl.unfinished import folder_beside

    folder = out or FOLDER
    with folder_beside(folder, replaces=DATA) as part:
        comparison = compared(results or [], seed, only or [])
        write_text(part / DATA, json.dumps(comparison, indent=2, allow_nan=False) + "\n")
        write_text(part / "compare.md", report(comparison))
    print_comparison(comparison, folder)
    typer.echo(f"{folder}: compare.md, compare.json")


def print_comparison(found: dict[str, Any], folder: Path) -> None:
    """Success and the paired differences of it, as tables for the terminal, where they are not too many."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from swamp_rl.experiments.reports.comparison import heads, rows

    console = Console(markup=False)
    table = Table(title="success [%], 95 % intervals", box=SIMPLE_HEAD)
    for head in ("pilot", "seeds", "level", "success"):
        table.add_column(head, justify="right" if head in ("seeds", "success") else "left")
    for row in rows(found):
        for level, rate in zip(heads(found)[2:], row[2:], strict=True):
            table.add_row(*row[:2], level, rate)
    console.print(table)
    paired = [row for row in found["differences"] if row["quantity"] == "success"]
    if len(paired) > MOST_DIFFERENCES:
        console.print(
            f"{len(paired)} paired differences: see {folder}/compare.md, or name pilots with --only; p is "
            "corrected for fewer comparisons then",
            soft_wrap=True,
        )
    else:
        console.print(_differences(paired))
    for note in found["notes"]:
        console.print(note)


def _differences(paired: list[dict[str, Any]]) -> "Table":
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from swamp_rl.experiments.reports.comparison import DIFFERENCE_HEADS, p_value
    from swamp_rl.experiments.reports.experiment import difference

    table = Table(title="success, paired differences [%]", box=SIMPLE_HEAD)
    for head in ("difference", "level"):
        table.add_column(head)
    for head in DIFFERENCE_HEADS:
        table.add_column(head, justify="right")
    for row in paired:
        pair = f"{row['a']} − {row['b']}"
        table.add_row(pair, row["level"], difference(row["quantity"], row), p_value(row["p_corrected"]))
    return table
