"""Which runs the report shows: tracks, commands, success rates, and the race recorded for rerun."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.evaluation.episodes import Tried
from swamp_rl.experiments.reports import figures

from swamp_rl.demo.recording import write_recording
from swamp_rl.demo.scene import demo_scene
from swamp_rl.runs import Dataset, Run


@dataclass(frozen=True)
class Race:
    """Who is shown side by side: the data's pilot first, then the learned ones at `level`, by name."""

    level: str
    runs: dict[str, Run]


def draw_figures(
    scene: Scene, dataset: Dataset, tried: Tried, race: Race, results: Mapping[str, Any], folder: Path
) -> None:
    """The PNGs of the report, into `folder`."""
    folder.mkdir()
    good = dataset.successful
    failed = [run for run in dataset.runs if run not in good]
    panels = [(f"{len(good)} successful runs", good), (f"{len(failed)} failed runs", failed)]
    figures.tracks(folder / "training_tracks.png", scene.course, [panels], "Training runs")
    names = list(scene.experiment.pilots)
    rows = [[(f"{name}, {level}", tried.shown[name, level]) for level in scene.levels] for name in names]
    figures.tracks(folder / "tracks.png", scene.course, rows, "Tracks by pilot and level", names)
    figures.commands(folder / "commands.png", race.runs, "Commands")
    rates = {name: pilot["levels"] for name, pilot in results["pilots"].items()}
    asked = scene.experiment.targets.success
    figures.success_rates(folder / "success.png", rates, asked, "Success, with Wilson's 95 % interval")


def choose_race(scene: Scene, dataset: Dataset, tried: Tried) -> Race:
    """A run of the data, of middling duration, and the learned pilots in one episode at the data's level.

    Where that is unknown or not evaluated, it is the first. The episode is the first in which most arrive.
    """
    data = scene.experiment.data
    recorded_at = Path(data.record.disturbances or "").stem if data.folder is None else ""
    level = recorded_at if recorded_at in scene.levels else next(iter(scene.levels))
    learned = [name for name, plan in scene.experiment.pilots.items() if plan.kind != "scripted"]
    shown = list(zip(*(tried.shown[name, level] for name in learned), strict=True))
    best = max(shown, key=lambda runs: sum(run.meta.outcome == "success" for run in runs), default=())
    good = sorted(dataset.successful, key=lambda run: run.duration)
    runs = {dataset.meta.source: good[len(good) // 2]} | dict(zip(learned, best, strict=False))
    return Race(level, runs)


def write_race(scene: Scene, race: Race, path: Path) -> None:
    """The race as a rerun recording."""
    size = scene.boat.length, scene.boat.breadth
    runs = {who: [run] for who, run in race.runs.items()}
    write_recording(path, demo_scene(scene.experiment.name, runs, scene.course, size, "gate"))
