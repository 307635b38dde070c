"""The boat, the course and the levels of disturbance that an experiment names."""

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
    named: list[tuple[str, str | None]]
    named = [("evaluation.levels", level) for level in experiment.evaluation.levels]
    named += [("data.record.disturbances", experiment.data.record.disturbances)]
    named += [(f"pilots.{name}.disturbances", plan.disturbances) for name, plan in experiment.pilots.items()]
    named += [("hidden.logs.disturbances", experiment.hidden.logs.disturbances)] if experiment.hidden else []
    levels: dict[str, str] = {}
    for key, level in named:
        if level is not None:
            levels.setdefault(level, key)
    return levels
