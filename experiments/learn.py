"""From logged runs and from trying: the dataset of an experiment, and its pilots trained and saved."""

from pathlib import Path
from typing import Any

from envs.hindsight import with_gates
from experiments.progress import Stages, Tick
from experiments.scene import Scene
from experiments.schema import PilotPlan, settings_kind
from swamp_rl.errors import UserError
from swamp_rl.pilots.cloning import fit_cloning
from swamp_rl.pilots.demonstrations import choose_runs
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from swamp_rl.pilots.record import record_scripted
from swamp_rl.pilots.reservoir import fit_reservoir
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.store import save_pilot
from swamp_rl.pilots.takeover import TakeoverPilot
from swamp_rl.runs import Dataset, read_dataset


def get_data(scene: Scene, folder: Path, progress: Stages) -> Dataset:
    """The dataset that the experiment names, or one recorded now into `folder`/data; UserError if unfit."""
    plan = scene.experiment.data
    if plan.folder is None:
        with progress.stage("record runs", plan.record.good) as tick:
            record(scene, folder / "data", tick)
    dataset = read_dataset(folder / "data" if plan.folder is None else plan.folder)
    rate = 1.0 / scene.experiment.step
    if abs(dataset.meta.sample_rate / rate - 1.0) > 1e-6:
        raise UserError(
            f"{dataset.folder}: its runs have {dataset.meta.sample_rate:g} rows a second, the experiment "
            f"makes {rate:g}; set step to {1.0 / dataset.meta.sample_rate:g}"
        )
    return dataset


def record(scene: Scene, folder: Path, tick: Tick) -> None:
    """The scripted pilot's runs, as a new dataset."""
    plan = scene.experiment.data.record
    record_scripted(
        scene.boats_at(plan.disturbances),
        folder,
        boat=scene.experiment.boat,
        course=scene.experiment.course,
        count=plan.good,
        failed=plan.failed,
        seed=plan.seed,
        step=scene.experiment.step,
        tick=tick,
    )


def train_pilots(scene: Scene, dataset: Dataset, folder: Path, progress: Stages) -> dict[str, Pilot]:
    """Every pilot of the experiment by name, each saved into `folder`/NAME."""
    pilots = {}
    for name, plan in scene.experiment.pilots.items():
        with progress.stage(f"train {name}", 1.0) as tick:
            pilot = train(scene, dataset, plan, tick)
        if plan.takeover > 0.0:
            first = ScriptedPilot(scene.experiment.evaluation.seed, step=scene.experiment.step)
            pilot = TakeoverPilot(first, pilot, plan.takeover, scene.experiment.step)
        save_pilot(pilot, folder / name)
        pilots[name] = pilot
    return pilots


def train(scene: Scene, dataset: Dataset, plan: PilotPlan, tick: Tick) -> Pilot:
    """One pilot, by itself; `tick` hears the share done, where the kind tells."""
    settings: Any = settings_kind(plan.kind).model_validate(plan.options)
    if plan.kind == "scripted":
        return ScriptedPilot(settings.seed, step=scene.experiment.step)
    if plan.kind == "ppo":
        return _by_trying(scene, plan, settings, tick)
    runs = [with_gates(run, scene.course) for run in choose_runs(dataset.runs, plan.runs)]
    if plan.kind == "reservoir":
        return fit_reservoir(runs, settings)
    return fit_cloning(runs, settings, tick)


def _by_trying(scene: Scene, plan: PilotPlan, settings: PPOSettings, tick: Tick) -> Pilot:
    from envs.sb3 import GatesVecEnv

    boats = scene.boats_at(plan.disturbances, at_once=True)(settings.boats, settings.senses)
    return train_ppo(GatesVecEnv(boats, settings.hold), settings, tick)
