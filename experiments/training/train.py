"""From logged runs and from trying: the dataset of an experiment, and its pilots trained and saved."""

import json
import shutil
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from swamp_rl.experiments.artifacts.provenance import TENSORBOARD, checkpoints
from swamp_rl.experiments.artifacts.stages import Stages
from swamp_rl.experiments.config.learners import (
    Training,
    check_logged,
    check_runs,
    in_order,
    learner,
    settings_of_plan,
)
from swamp_rl.experiments.config.made import made_of
from swamp_rl.experiments.config.named_files import levels_flown, levels_learned
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.config.schema import PilotPlan
from swamp_rl.experiments.training.coverage import calm_warning, warning
from swamp_rl.experiments.training.effects_twice import effects_twice
from swamp_rl.experiments.training.reaction import reaction_warning
from swamp_rl.experiments.training.run_faults import run_faults
from swamp_rl.experiments.training.tracking import tracked

from swamp_rl.boat.digest import boat_digest
from swamp_rl.boat.likeness import build_of
from swamp_rl.errors import SettingsError, UserError, errors_at
from swamp_rl.files import write_text
from swamp_rl.own_code import fault_in_own_code
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.demonstrations import choose_runs
from swamp_rl.pilots.description import FittedOn, Made
from swamp_rl.pilots.made_for import check_made_for, made_for
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.record import record_scripted
from swamp_rl.pilots.scripted import Habits, ScriptedPilot
from swamp_rl.pilots.store import load_pilot, save_pilot
from swamp_rl.pilots.takeover import TakeoverPilot
from swamp_rl.runs import Dataset, Run, read_dataset
from swamp_rl.unfinished import folder_beside


def get_data(scene: Scene, folder: Path, progress: Stages) -> Dataset:
    """The dataset that the experiment names, or one recorded into `folder`/data, unless it is there already.

    UserError where it is unfit.
    """
    plan = scene.experiment.data
    if plan.folder is None and not (folder / "data").exists():
        with progress.stage("record runs", plan.record.good * len(plan.record.skills)) as tick:
            record(scene, folder / "data", tick)
    named = scene.experiment.boat, scene.experiment.course  # for a plain folder, which does not tell
    dataset = read_dataset(folder / "data" if plan.folder is None else plan.folder, *named)
    rate = 1.0 / scene.experiment.step
    if abs(dataset.meta.sample_rate / rate - 1.0) > 1e-6:
        raise UserError(
            f"{dataset.folder}: its runs have {dataset.meta.sample_rate:g} rows a second, the experiment "
            f"makes {rate:g}; set step to {1.0 / dataset.meta.sample_rate:g}"
        )
    _check_boat(scene, dataset)
    for line in _notes_on_data(scene, dataset):
        progress.say(line)
    return dataset


def notes(scene: Scene, dataset: Dataset) -> list[str]:
    """What limits the pilots that learn from `dataset`, one line each: effects that act twice, its boat and
    faults of its runs, then by pilot starts and disturbances of the evaluation that its runs lack."""
    by_pilot = (_notes_on(scene, name, dataset) for name in scene.experiment.pilots)
    return [*_notes_on_data(scene, dataset), *(line for lines in by_pilot for line in lines)]


def _notes_on_data(scene: Scene, dataset: Dataset) -> list[str]:
    ours, theirs = scene.boat, dataset.boat
    experiment = scene.experiment
    # A closed loop evaluates its true boat, and says so itself.
    levels = {} if experiment.hidden else levels_flown(experiment)
    twice = effects_twice(ours, levels_learned(experiment) | levels)
    found = run_faults(scene, dataset)
    if boat_digest(theirs) == boat_digest(ours):
        return [*twice, *found]
    other = "another version of boat" if theirs.name == ours.name else "boat"
    name = experiment.name
    return [
        *twice,
        f"{dataset.folder}: recorded with {other} {theirs.name}, experiment {name} has {ours.name}",
        *found,
    ]


def _notes_on(scene: Scene, name: str, dataset: Dataset) -> list[str]:
    plan = scene.experiment.pilots[name]
    # With a takeover another pilot drives at the start.
    if not learner(plan.kind).from_runs or plan.takeover > 0.0:
        return []
    runs = _runs_of(scene, name, dataset)
    found = (
        warning(scene, name, runs),
        calm_warning(scene, name, runs),
        reaction_warning(scene, name, plan, runs),
    )
    return [line for line in found if line is not None]


def _check_boat(scene: Scene, dataset: Dataset) -> None:
    """UserError where the runs are of a boat of other thrusters or size."""
    ours, theirs, name = scene.boat, dataset.boat, scene.experiment.name
    if not build_of(theirs).serves(build_of(ours)):
        raise UserError(
            f"{dataset.folder}: recorded with boat {theirs.name} ({build_of(theirs)}), but experiment {name} "
            f"has boat {ours.name} ({build_of(ours)}); set boat to that of the runs, or name runs of "
            f"{ours.name}"
        )


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
        skills=plan.skills,
        step=scene.experiment.step,
        tick=tick,
    )


def train_pilots(
    scene: Scene, dataset: Dataset, folder: Path, progress: Stages, only: list[str] | None = None
) -> dict[str, Pilot]:
    """Every pilot of the experiment (or `only` some) by name, each saved into `folder`/NAME with its curve.

    Those that are there already are taken as they are, and a training that was cut short goes on where its
    learner can. What comes back is read from `folder`, so that a first life and a later one have the same.
    UserError, before any training, for settings that do not fit the runs; SettingsError for those with which
    a training fails. That, or an error in the user's own code, leaves nothing of the pilot.
    """
    plans = scene.experiment.pilots
    order = in_order(plans, only)
    columns = set.intersection(*(set(run.columns) for run in dataset.runs)) if dataset.runs else set()
    for name in order:
        check_logged(f"pilots.{name}.options", plans[name], sorted(columns))
        if learner(plans[name].kind).from_runs:
            _runs_of(scene, name, dataset)
    pilots: dict[str, Pilot] = {}
    for name in order:
        if not (folder / name).exists():
            others = {other: _alone(pilot) for other, pilot in pilots.items()}
            try:
                _train_into(folder, name, scene, dataset, others, progress)
            except Exception as error:
                if isinstance(error, SettingsError) or fault_in_own_code(error):
                    _forget(folder, name)
                    shutil.rmtree(folder.parent / TENSORBOARD / name, ignore_errors=True)
                raise
        _forget(folder, name)
        pilots[name] = load_pilot(folder / name)
    return {name: pilots[name] for name in plans if name in order}


def _runs_of(scene: Scene, name: str, dataset: Dataset) -> list[Run]:
    """The runs that a pilot learns from; UserError where they are too few, or too short for its settings."""
    plan = scene.experiment.pilots[name]
    where = "data.record" if scene.experiment.data.folder is None else dataset.folder
    with errors_at(f"{where}: pilots.{name}"):
        runs = choose_runs(dataset.runs, plan.runs, plan.outcomes, plan.skill)
        check_runs(plan, runs)
    return runs


def _train_into(
    folder: Path,
    name: str,
    scene: Scene,
    dataset: Dataset,
    trained: Mapping[str, Pilot],
    progress: Stages,
) -> None:
    plan = scene.experiment.pilots[name]
    checkpoint, *_ = checkpoints(folder, name)
    curve: list[dict[str, float]] = []
    for line in _notes_on(scene, name, dataset):
        progress.say(line)
    events = folder.parent / TENSORBOARD / name
    with progress.stage(f"train {name}", 1.0) as tick, tracked(events, scene.experiment, name) as log:
        hear = partial(_add_point, curve, log)
        training = _training(scene, dataset, plan, tick, checkpoint, trained, hear)
        with errors_at(f"pilots.{name}"):
            pilot = learner(plan.kind).train(training)
    made = _made(training)
    if (other := check_made_for(f"pilots.{name}", made, scene.boat, scene.experiment.step)) is not None:
        progress.say(other)
    with folder_beside(folder / name) as part:
        save_pilot(with_takeover(scene, plan, pilot), part, _fitted_on(training), made)
        if curve:
            write_text(part / "curve.jsonl", "".join(f"{json.dumps(point)}\n" for point in curve))


def _forget(folder: Path, name: str) -> None:
    """Remove the checkpoints of a pilot's training."""
    for checkpoint in checkpoints(folder, name):
        checkpoint.unlink(missing_ok=True)


def _alone(pilot: Pilot) -> Pilot:
    """The learned pilot, without the one that drives before it."""
    return pilot.then if isinstance(pilot, TakeoverPilot) else pilot


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
    return learner(plan.kind).train(_training(scene, dataset, plan, tick, checkpoint, trained or {}, log))


def _training(
    scene: Scene,
    dataset: Dataset,
    plan: PilotPlan,
    tick: Tick,
    checkpoint: Path | None,
    trained: Mapping[str, Pilot],
    log: Log,
) -> Training:
    return Training(scene, plan, settings_of_plan(plan), dataset, tick, checkpoint, log, trained)


def _fitted_on(training: Training) -> FittedOn | None:
    learns = learner(training.plan.kind)
    if learns.fitted_on is not None:
        return learns.fitted_on(training)
    return training.fitted_on() if learns.from_runs else None


def _made(training: Training) -> Made | None:
    plan, scene = training.plan, training.scene
    made = made_of(plan.kind, plan.options)
    if made is not None or plan.kind == "stored":
        return made
    return made_for(scene.boat, scene.course.name, scene.experiment.step)


def _add_point(curve: list[dict[str, float]], log: Log, step: int, values: Mapping[str, float]) -> None:
    curve.append({"step": step, **values})
    log(step, values)


def with_takeover(scene: Scene, plan: PilotPlan, pilot: Pilot) -> Pilot:
    """The pilot with the scripted one driving before it, where the plan says so."""
    if plan.takeover == 0.0:
        return pilot
    first = ScriptedPilot(
        scene.experiment.evaluation.seed, Habits(boat_length=scene.boat.length), scene.experiment.step
    )
    return TakeoverPilot(first, pilot, plan.takeover, scene.experiment.step)
