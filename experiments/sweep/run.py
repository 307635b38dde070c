"""`swamp-rl sweep`: each trial done once and kept, whatever is killed meanwhile, and then a report."""

import json
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from itertools import starmap
from pathlib import Path
from typing import Any

from swamp_rl.experiments.artifacts.provenance import digests_of_inputs, with_data_hash
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.schema import Experiment
from swamp_rl.experiments.sweep.propose import (
    Values,
    batches_of,
    numbered,
    propose,
    refuse_without_optuna,
    trials_of,
)
from swamp_rl.experiments.sweep.schema import Objective, Sweep, load_sweep, override
from swamp_rl.experiments.sweep.store import FILE, Store, Trial, opened
from swamp_rl.experiments.sweep.trial import carry_out, cut_down, job_of, quiet

from swamp_rl import __version__
from swamp_rl.errors import UserError
from swamp_rl.files import refuse_name_of_file
from swamp_rl.unfinished import locked
from swamp_rl.workers import Ended, Pool, completed, open_pool

Tell = Callable[[Trial, int], None]
"""Hears each trial that ends, and how many there are in all."""


def run_sweep(
    name_or_path: str | Path,
    overrides: Iterable[str] = (),
    out: Path | str | None = None,
    workers: int | None = None,
    ray: str | None = None,
    tell: Tell = lambda trial, total: None,
) -> Path:
    """Carry a sweep out, or go on with it, and return its folder, by default results/sweeps/NAME.

    overrides: keys of the experiment, the same in every trial. workers: processes, by default one for each
    processor; ray: the address of a cluster to be used in their place. UserError for whatever is wrong in the
    files, before any work is done.
    """
    from swamp_rl.experiments.config.scene import read_scene
    from swamp_rl.experiments.sweep.report import write_report

    sweep = load_sweep(name_or_path)
    refuse_without_optuna(sweep)
    fixed = [*starmap(override, sweep.set.items()), *overrides]
    base = with_data_hash(checked(sweep, fixed), f"sweep {sweep.name}")
    folder = Path(out) if out is not None else Path("results") / "sweeps" / sweep.name
    refuse_name_of_file(folder)
    plan = {
        "sweep": _settings(sweep),
        "experiment": base.model_dump(mode="json"),
        "inputs": digests_of_inputs(read_scene(base)),
        "swamp_rl": __version__,
    }

    def job(values: Values) -> str:
        return job_of(_experiment(sweep, fixed, values), sweep.objective)

    with locked(folder.absolute()), ExitStack() as pools:
        if not (folder / FILE).exists():  # a cluster that does not answer then leaves no file
            pool = pools.enter_context(open_pool(carry_out, workers, ray))
        else:
            pool = None
        with opened(folder, plan) as store:
            _renumber(store, sweep, folder / FILE)
            if len(store.trials()) < trials_of(sweep):
                _say_notes(sweep, base, folder)
                pool = pool or pools.enter_context(open_pool(carry_out, workers, ray))
                carry_on(sweep, store, pool, job, tell)
            pools.close()
            write_report(folder, sweep, fixed, store.trials())
    return folder


def _settings(sweep: Sweep) -> dict[str, Any]:
    """What a trial's values and result depend on: not how many of them there are."""
    drawn = {
        key: {} if parameter.kind == "grid" else parameter.model_dump(mode="json", exclude_none=True)
        for key, parameter in sweep.parameters.items()
    }
    left_out = {"description", "retries", "parameters", "trials"}
    return sweep.model_dump(mode="json", exclude=left_out) | {"parameters": drawn}


def _say_notes(sweep: Sweep, base: Experiment, folder: Path) -> None:
    """Say once what the trials, which are quiet, would say of the folder of runs."""
    from swamp_rl.experiments.artifacts.stages import say
    from swamp_rl.experiments.config.scene import read_scene
    from swamp_rl.experiments.training.train import get_data, notes

    if base.data.folder is None:
        return
    scene = read_scene(cut_down(base, sweep.objective))
    with quiet() as progress:
        lines = notes(scene, get_data(scene, folder, progress))
    for line in lines:
        say(line)


def _renumber(store: Store, sweep: Sweep, path: Path) -> None:
    ended = list(store.trials().values())
    try:
        now = numbered(sweep, ended)
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    if now != ended:
        store.replace(now)


def carry_on(sweep: Sweep, store: Store, pool: Pool, job: Callable[[Values], str], tell: Tell) -> None:
    """Have every trial done that has not ended yet, batch after batch.

    One whose values the experiment refuses together has failed without an attempt.
    """
    total = trials_of(sweep)

    def keep(trial: Trial) -> None:
        store.add(trial)
        tell(trial, total)

    for numbers in batches_of(sweep):
        ended = store.trials()
        values = propose(sweep, numbers, ended)
        jobs = {}
        for number in (number for number in numbers if number not in ended):
            try:
                jobs[number] = job(values[number])
            except UserError as error:
                keep(Trial(number, dict(values[number]), None, None, str(error), 0, 0.0))
        for done in completed(jobs, jobs.__getitem__, pool, sweep.retries):
            keep(_ended(values[done.number], done))


def _ended(values: Values, ended: Ended) -> Trial:
    found = json.loads(ended.answer) if ended.answer is not None else {"value": None, "summary": None}
    failed = ended.error if ended.answer is None else None
    seconds = round(ended.seconds, 2)
    return Trial(
        ended.number, dict(values), found["value"], found["summary"], failed, ended.attempts, seconds
    )


def checked(sweep: Sweep, fixed: list[str]) -> Experiment:
    """The experiment before any parameter is set; UserError where a value, a pilot or a level cannot be."""
    from swamp_rl.experiments.config.scene import read_scene

    base = _experiment(sweep, fixed, {})
    _check_objective(f"sweep {sweep.name}", base, sweep.objective)
    for key in {given.partition("=")[0] for given in fixed} & set(sweep.parameters):
        raise UserError(f"{key}: is one of the sweep's parameters, and set as well; drop one of the two")
    for key, parameter in sweep.parameters.items():
        for value in parameter.examples:
            read_scene(_experiment(sweep, fixed, {key: value}))
    return base


def _check_objective(where: str, experiment: Experiment, objective: Objective) -> None:
    levels = [Path(level).stem for level in experiment.evaluation.levels]
    if experiment.hidden is not None:
        raise UserError(f"{where}: experiment: one with a hidden boat is not swept; name another")
    if objective.pilot not in experiment.pilots:
        known = ", ".join(experiment.pilots)
        raise UserError(
            f"{where}: objective.pilot: no pilot {objective.pilot!r} in the experiment; name one of {known}"
        )
    if objective.level not in levels:
        known = ", ".join(levels)
        raise UserError(
            f"{where}: objective.level: no level {objective.level!r} in the experiment; name one of {known}"
        )


def _experiment(sweep: Sweep, fixed: list[str], values: Values) -> Experiment:
    own = [override(key, value) for key, value in values.items()]
    given = {text: f"sweep {sweep.name}: parameters: {text}" for text in own}
    given |= {text: f"sweep {sweep.name}: set: {text}" for text in starmap(override, sweep.set.items())}
    return load_experiment(sweep.experiment, [*fixed, *own], given)
