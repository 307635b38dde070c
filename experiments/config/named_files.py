"""The boat, the course and the levels of disturbance that an experiment names."""

from collections.abc import Iterable
from pathlib import Path

from swamp_rl.experiments.config.schema import Experiment

from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.files import find_config


def refuse_missing(where: Path | str, experiment: Experiment) -> None:
    """UserError with `where` the experiment stands and the key that names what is not there."""
    named = [("boat", "boats", experiment.boat), ("course", "courses", experiment.course)]
    named += [(key, "disturbances", level) for level, key in levels_of(experiment).items()]
    for key, kind, name in named:
        try:
            find_config(kind, name)
        except UserError as error:
            raise UserError(f"{where}: {key}: {error}") from error
    evaluated = [Path(level).stem for level in experiment.evaluation.levels]
    for pilot, rates in experiment.targets.success.items():
        for level in rates:
            if level not in evaluated:
                key = f"targets.success.{pilot}"
                raise UserError(
                    f"{where}: {key}: level {level!r} is not in evaluation.levels{nearest(level, evaluated)}"
                )


def levels_of(experiment: Experiment) -> dict[str, str]:
    """Every level that an experiment names, each once, with the first key that names it."""
    named = [*_flown_at(experiment), ("data.record.disturbances", experiment.data.record.disturbances)]
    return _by_level([*named, *_trained_at(experiment)])


def levels_flown(experiment: Experiment) -> dict[str, str]:
    """The levels of the boat that is evaluated and logged, each once, with the first key that names it."""
    return _by_level(_flown_at(experiment))


def levels_learned(experiment: Experiment) -> dict[str, str]:
    """The levels of the boat in which runs are recorded and pilots trained, as `levels_flown`."""
    data = experiment.data
    recorded = [("data.record.disturbances", data.record.disturbances)] if data.folder is None else []
    return _by_level([*recorded, *_trained_at(experiment)])


def _flown_at(experiment: Experiment) -> list[tuple[str, str | None]]:
    hidden = experiment.hidden
    logged = [("hidden.logs.disturbances", hidden.logs.disturbances)] if hidden else []
    return [*(("evaluation.levels", level) for level in experiment.evaluation.levels), *logged]


def _trained_at(experiment: Experiment) -> list[tuple[str, str | None]]:
    return [(f"pilots.{name}.disturbances", plan.disturbances) for name, plan in experiment.pilots.items()]


def _by_level(named: Iterable[tuple[str, str | None]]) -> dict[str, str]:
    levels: dict[str, str] = {}
    for key, level in named:
        if level is not None:
            levels.setdefault(level, key)
    return levels
