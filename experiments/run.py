"""The main job: from one YAML to pilots, what they are worth, and a report, in one folder of results."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from experiments.driven import write_driven
from experiments.learn import get_data, train_pilots
from experiments.pictures import choose_race, draw_figures, write_race
from experiments.progress import Stages, peak_memory, stages
from experiments.report import rate, report
from experiments.results import gather
from experiments.scene import Scene, read_scene, write_config
from experiments.schema import load_experiment
from experiments.trial import try_pilots
from experiments.versions import versions
from swamp_rl.evaluation import write_episodes
from swamp_rl.files import folder_beside

RESULTS = "results.json"
"""A folder that holds it is a whole result, which a later one may replace."""


def run_experiment(
    name_or_path: str | Path, overrides: Iterable[str] = (), out: Path | str | None = None
) -> Path:
    """Do all that an experiment's YAML asks for and return the folder of results, by default results/NAME.

    The folder is built beside and renamed when whole; only then an earlier result in its place is replaced,
    and anything else there is refused. UserError for whatever is wrong in the file, before any work is done.
    """
    from experiments.closed_loop import close_loop, true_scene

    scene = read_scene(load_experiment(name_or_path, overrides))
    work = do_experiment
    if scene.experiment.hidden is not None:
        true_scene(scene)  # whose effects are refused now, not after an hour
        work = close_loop
    folder = Path(out) if out is not None else Path("results") / scene.experiment.name
    with folder_beside(folder, replaces=RESULTS) as part, stages() as progress:
        results = work(scene, part, progress)
        write_json(part / RESULTS, results)
    print_results(results, folder)
    return folder


def do_experiment(scene: Scene, folder: Path, progress: Stages) -> dict[str, Any]:
    """Every stage in turn, each writing what it makes into `folder`; what goes into results.json."""
    write_config(scene, folder / "config")
    write_json(folder / "versions.json", versions())
    dataset = get_data(scene, folder, progress)
    pilots = train_pilots(scene, dataset, folder / "pilots", progress)
    tried = try_pilots(scene, pilots, progress)
    with progress.stage("compare and draw"):
        write_episodes(folder / "episodes.parquet", tried.tables)
        results = gather(scene, dataset, tried.tables)
        race = choose_race(scene, dataset, tried)
        results["race"] = {"level": race.level, "runs": {who: run.name for who, run in race.runs.items()}}
        draw_figures(scene, dataset, tried, race, results, folder / "figures")
        write_race(scene, race, folder / "demo.rrd")
        write_driven(scene, tried, folder / "driven")
    results["measured"] = {
        "seconds": {name: round(value, 2) for name, value in progress.seconds.items()},
        "total_seconds": round(sum(progress.seconds.values()), 1),
        "peak_memory_gb": round(peak_memory(), 2),
    }
    (folder / "report.md").write_text(report(results), encoding="utf-8")
    return results


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Strict JSON: what has no value is null, never NaN."""
    path.write_text(json.dumps(data, indent=2, allow_nan=False, default=_plain) + "\n", encoding="utf-8")


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} does not go into JSON")


def print_results(results: Mapping[str, Any], folder: Path) -> None:
    """The table that ends the job: success by pilot and level, the targets missed, where everything lies."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    levels = results["evaluation"]["levels"]
    episodes = results["evaluation"]["episodes"]
    table = Table(title=f"{results['name']}: success in {episodes} episodes, percent", box=SIMPLE_HEAD)
    table.add_column("pilot")
    for level in levels:
        table.add_column(level, justify="right", no_wrap=True)
    for name, pilot in results["pilots"].items():
        table.add_row(name, *(rate(pilot["levels"][level]) for level in levels))
    console = Console()
    console.print(table)
    missed = [target for target in results["targets"] if not target["reached"]]
    reached = len(results["targets"]) - len(missed)
    console.print(f"{reached} of {len(results['targets'])} targets reached")
    for target in missed:
        console.print(f"  not: {target['what']} of {target['pilot']}, {target['level']}")
    measured = results["measured"]
    console.print(
        f"{measured['total_seconds']:.0f} s, {measured['peak_memory_gb']:.1f} GB: see {folder}/report.md"
    )
