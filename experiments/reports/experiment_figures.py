"""What the report shows: tracks, commands, success rates, and the race recorded for rerun."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.evaluation.episodes import Tried
from swamp_rl.experiments.evaluation.race import Race
from swamp_rl.experiments.reports import figures

from swamp_rl.counted import counted
from swamp_rl.demo.recording import write_recording
from swamp_rl.demo.scene import demo_scene
from swamp_rl.runs import Dataset, Run


def draw_figures(
    scene: Scene, dataset: Dataset, tried: Tried, race: Race, results: Mapping[str, Any], folder: Path
) -> None:
    """The PNGs of the report, into `folder`."""
    folder.mkdir()
    panels, title = (
        training_panels(dataset.runs),
        "Training runs" if results["data"]["trained_on"] else "Runs",
    )
    figures.tracks(folder / "training_tracks.png", scene.course, [panels], title)
    names = list(scene.experiment.pilots)
    rows = [[(f"{name}, {level}", tried.shown[name, level]) for level in scene.levels] for name in names]
    figures.tracks(folder / "tracks.png", scene.course, rows, "Tracks by pilot and level", names)
    figures.commands(folder / "commands.png", race, "Commands")
    rates = {name: pilot["levels"] for name, pilot in results["pilots"].items()}
    asked = scene.experiment.targets.success
    figures.success_rates(folder / "success.png", rates, asked, "Success, with Wilson's 95 % interval")


def training_panels(runs: Sequence[Run]) -> list[figures.Panel]:
    """The successful and the other runs, without a panel of none."""
    good = [run for run in runs if run.meta.outcome == "success"]
    others = [run for run in runs if run.meta.outcome != "success"]
    labels = (("successful run", good), ("unsuccessful run", others))
    return [(counted(len(panel), noun), panel) for noun, panel in labels if panel]


def write_race(scene: Scene, race: Race, path: Path) -> None:
    """The race as a rerun recording."""
    size = scene.boat.length, scene.boat.breadth
    runs = {who: [run] for who, run in race.items()}
    write_recording(path, demo_scene(scene.experiment.name, runs, scene.course, size, "gate"))
