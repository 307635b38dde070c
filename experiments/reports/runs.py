"""A dataset as a table for the terminal and as a chart of its tracks."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.table import Table
from swamp_rl.experiments.reports.figures import DRIVEN, FAILED, draw_course

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.figure_style import save, styled
from swamp_rl.files import write_beside
from swamp_rl.runs import Dataset, Run

UNTOLD = "#777777"


def run_table(dataset: Dataset) -> Table:
    """One row for each run; outcome, seed and the count of successes where any run has them."""
    meta, runs = dataset.meta, dataset.runs
    columns = {
        "run": [run.name for run in runs],
        "duration [s]": [f"{run.duration:.1f}" for run in runs],
        "distance [m]": [f"{run.path_length:.1f}" for run in runs],
        "outcome": [run.meta.outcome or "" for run in runs],
        "seed": ["" if run.meta.seed is None else str(run.meta.seed) for run in runs],
    }
    shown = {head: cells for head, cells in columns.items() if any(cells)}
    table = Table(
        title=f"{dataset.folder}: {meta.vehicle}, {meta.mass:g} kg, {meta.sample_rate:g} Hz, {meta.source}"
    )
    if "outcome" in shown:
        table.caption = f"{len(dataset.successful)} of {counted(len(runs), 'run')} marked successful"
    for head in shown:
        table.add_column(head, justify="left" if head in ("run", "outcome") else "right")
    for row in zip(*shown.values(), strict=True):
        table.add_row(*row)
    return table


def draw_tracks(dataset: Dataset, path: Path, source: str) -> None:
    """PNG of every track, north up, coloured by outcome, with the course where the dataset names one.

    source: kept in the picture as the text of that name.
    """
    with styled(), write_beside(path) as part:
        figure = Figure(figsize=(5.2, 6.0), layout="constrained")
        axes = figure.subplots()
        for colour, dash, label, runs in _by_outcome(dataset):
            for run in runs:
                north, east = run.columns["north"], run.columns["east"]
                axes.plot(east, north, dash, color=colour, lw=0.9, alpha=0.6, label=label)
                label = "_"  # one entry in the legend is enough
        _draw_surroundings(axes, dataset)
        axes.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
        axes.set_title(
            f"{dataset.folder.resolve().name}: {counted(len(dataset.runs), 'run')}, {dataset.meta.source}"
        )
        figure.legend(loc="outside lower center", ncols=4)
        save(figure, part, metadata={"Source": source})


def _by_outcome(dataset: Dataset) -> list[tuple[str, str, str, list[Run]]]:
    untold = [run for run in dataset.runs if run.meta.outcome is None]
    failed = [run for run in dataset.runs if run.meta.outcome not in (None, "success")]
    groups = [
        (UNTOLD, "-", "outcome not recorded", untold),
        (FAILED, "--", "failed", failed),
        (DRIVEN, "-", "successful", dataset.successful),
    ]
    return [(colour, dash, f"{label} ({len(runs)})", runs) for colour, dash, label, runs in groups if runs]


def _draw_surroundings(axes: Axes, dataset: Dataset) -> None:
    """The course, in a view that still holds tracks that left it; without one, where the runs began."""
    try:
        course = dataset.course
    except UserError:
        course = None
    if course is None:
        starts = [(run.columns["east"][0], run.columns["north"][0]) for run in dataset.runs]
        axes.plot(*zip(*starts, strict=True), "k+", ms=6)
        return
    reached = axes.get_xlim(), axes.get_ylim()
    draw_course(axes, course)
    axes.set_xlim(*_hull(reached[0], axes.get_xlim()))
    axes.set_ylim(*_hull(reached[1], axes.get_ylim()))


def _hull(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    return min(one[0], other[0]), max(one[1], other[1])
