"""Which runs the report shows: tracks, commands, success rates, and the race recorded for rerun."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from experiments import figures
from experiments.scene import Scene
from experiments.trial import Tried
from swamp_rl.demo.recording import write_demo
from swamp_rl.runs import Dataset, Run


def draw_figures(
    scene: Scene, dataset: Dataset, tried: Tried, results: Mapping[str, Any], folder: Path
) -> None:
    """The PNGs of the report, into `folder`."""
    folder.mkdir()
    good = dataset.successful
    failed = [run for run in dataset.runs if run not in good]
    panels = [(f"{len(good)} successful runs", good), (f"{len(failed)} failed runs", failed)]
    figures.tracks(folder / "training_tracks.png", scene.course, [panels], "The runs to learn from")
    rows = [
        [(f"{name}, {level}", tried.shown[name, level]) for level in scene.levels]
        for name in scene.experiment.pilots
    ]
    figures.tracks(folder / "tracks.png", scene.course, rows, "The pilots, without and with disturbances")
    figures.commands(folder / "commands.png", race(scene, dataset, tried), "The levers")
    rates = {name: pilot["levels"] for name, pilot in results["pilots"].items()}
    asked = scene.experiment.targets.success
    figures.success_rates(folder / "success.png", rates, asked, "Success, with Wilson's 95 % interval")


def write_race(scene: Scene, dataset: Dataset, tried: Tried, path: Path) -> None:
    """The race as a rerun recording."""
    write_demo(path, scene.course, race(scene, dataset, tried), scene.boat.length, scene.boat.breadth)


def race(scene: Scene, dataset: Dataset, tried: Tried) -> dict[str, Run]:
    """By name: a run of the data, of middling duration, and those of the learned pilots in one episode.

    The episode is the first at the first level in which the most of them succeed.
    """
    good = sorted(dataset.successful, key=lambda run: run.duration)
    level = next(iter(scene.levels))
    learned = [name for name, plan in scene.experiment.pilots.items() if plan.kind != "scripted"]
    shown = list(zip(*(tried.shown[name, level] for name in learned), strict=True))
    best = max(shown, key=lambda runs: sum(run.meta.outcome == "success" for run in runs), default=())
    return {dataset.meta.source: good[len(good) // 2]} | dict(zip(learned, best, strict=False))
