"""From logged runs and from trying: the dataset of an experiment, and its pilots trained and saved."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

from experiments.curves import CURVE, write_curve
from experiments.learners import Log, Training, in_order, learner
from experiments.progress import Stages, Tick
from experiments.scene import Scene
from experiments.schema import PilotPlan
from swamp_rl.errors import UserError
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.record import record_scripted
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
    """Every pilot of the experiment by name, in the experiment's order, each saved into `folder`/NAME."""
    plans = scene.experiment.pilots
    alone: dict[str, Pilot] = {}
    pilots: dict[str, Pilot] = {}
    for name in in_order(plans):
        curve: list[dict[str, float]] = []
        with progress.stage(f"train {name}", 1.0) as tick:
            log = partial(_add_point, curve)
            alone[name] = train(scene, dataset, plans[name], tick, trained=alone, log=log)
        pilots[name] = with_takeover(scene, plans[name], alone[name])
        save_pilot(pilots[name], folder / name)
        if curve:
            write_curve(folder / name / CURVE, curve)
    return {name: pilots[name] for name in plans}


def train(
    scene: Scene,
    dataset: Dataset,
    plan: PilotPlan,
    tick: Tick,
    checkpoint: Path | None = None,
    trained: Mapping[str, Pilot] | None = None,
    log: Log = lambda step, values: None,
) -> Pilot:
    """One pilot, by itself; `tick` hears the share done, where the kind tells.

    trained: the pilots that it starts from, by name. checkpoint, log: see `Training`.
    """
    learns = learner(plan.kind)
    settings = learns.settings.model_validate(plan.options)
    return learns.train(Training(scene, plan, settings, dataset, tick, checkpoint, log, trained or {}))


def _add_point(curve: list[dict[str, float]], step: int, values: Mapping[str, float]) -> None:
    curve.append({"step": step, **values})


def with_takeover(scene: Scene, plan: PilotPlan, pilot: Pilot) -> Pilot:
    """The pilot with the scripted one driving before it, where the plan says so."""
    if plan.takeover == 0.0:
        return pilot
    first = ScriptedPilot(scene.experiment.evaluation.seed, step=scene.experiment.step)
    return TakeoverPilot(first, pilot, plan.takeover, scene.experiment.step)
