"""The stages of the main job, each of which a later life of the job finds done or does anew."""

import shutil
from pathlib import Path
from typing import Any

from swamp_rl.experiments.artifacts.provenance import WORK, seeds
from swamp_rl.experiments.artifacts.results import data_results, gather
from swamp_rl.experiments.artifacts.stages import Stages, measured
from swamp_rl.experiments.config.digests import pilot_hash, write_hashes
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.evaluation.episodes import Tried, try_pilots
from swamp_rl.experiments.evaluation.pilot_runs import write_driven, write_shown
from swamp_rl.experiments.evaluation.race import Race, fly_race
from swamp_rl.experiments.reports.experiment import report
from swamp_rl.experiments.reports.experiment_figures import draw_figures, write_race
from swamp_rl.experiments.training.tracking import track_success
from swamp_rl.experiments.training.train import get_data, notes, train_pilots

from swamp_rl.evaluation import write_episodes
from swamp_rl.pilots.made_for import other_boat
from swamp_rl.pilots.store import describe_pilot
from swamp_rl.runs import Dataset


def do_experiment(scene: Scene, folder: Path, progress: Stages) -> dict[str, Any]:
    """Every stage in turn, each writing what it makes into `folder`; what goes into results.json."""
    dataset = get_data(scene, folder, progress)
    data_results(dataset)  # what the report could not use is refused before the training
    pilots = train_pilots(scene, dataset, folder / "pilots", progress)
    tried = try_pilots(scene, pilots, progress, folder / WORK / "tried")
    with progress.stage("compare"):
        write_episodes(folder / "episodes.parquet", tried.tables)
        track_success(scene.experiment, tried.tables)
        results = gather(scene, dataset, tried.tables) | {"seeds": seeds(scene.experiment)}
        results["data"]["sha256"] = write_hashes(dataset.folder, folder)
        results["data"]["notes"] = notes(scene, dataset)
        for name in pilots:
            place = folder / "pilots" / name
            about = describe_pilot(place)
            made_for = other_boat(about.made, scene.boat)
            results["pilots"][name] |= {"sha256": pilot_hash(place), "made_for": made_for}
            if results["pilots"][name]["kind"] == "stored" and about.fitted_on is not None:
                runs = {"runs": len(about.fitted_on.runs), "source": about.fitted_on.source}
                results["pilots"][name]["fitted_on"] = runs
    with progress.stage("race"):
        race = fly_race(scene, dataset, pilots)
    _show(scene, folder, dataset, tried, race, results, progress)
    results["measured"] = measured(progress)
    (folder / "report.md").write_text(report(results), encoding="utf-8")
    return results


def _show(
    scene: Scene,
    folder: Path,
    dataset: Dataset,
    tried: Tried,
    race: Race,
    results: dict[str, Any],
    progress: Stages,
) -> None:
    """Figures, recordings and the runs of the pilots, as far as an earlier life wrote any, anew."""
    for name in ("figures", "driven", "shown"):
        shutil.rmtree(folder / name, ignore_errors=True)
    results["race"] = {"runs": {who: run.name for who, run in race.items()}}
    with progress.stage("draw figures"):
        draw_figures(scene, dataset, tried, race, results, folder / "figures")
    with progress.stage("write recordings"):
        write_race(scene, race, folder / "demo.rrd")
        write_driven(scene, tried, race, folder / "driven")
        if scene.experiment.data.folder is not None:
            write_shown(dataset, race, folder / "shown")
