"""Which values the trials of a sweep try: the whole grid, or draws by Optuna, however many workers."""

import dataclasses
import importlib.util
import itertools
import json
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from swamp_rl.experiments.sweep.schema import Parameter, Sweep
from swamp_rl.experiments.sweep.store import Trial

from swamp_rl.errors import UserError
from swamp_rl.extras import missing

Values = dict[str, Any]


def trials_of(sweep: Sweep) -> int:
    """How many trials there are in all."""
    return sweep.trials or len(_grid(sweep))


def refuse_without_optuna(sweep: Sweep) -> None:
    """UserError where values are to be drawn and Optuna is not installed; a grid needs none."""
    if sweep.trials is not None and importlib.util.find_spec("optuna") is None:
        raise missing(f"sweep {sweep.name}: draws need Optuna", "sweep", "list a grid")


def batches_of(sweep: Sweep) -> list[range]:
    """Numbers of the trials that are proposed together: all of a grid, `batch` of a search at a time."""
    total = trials_of(sweep)
    size = sweep.batch if sweep.trials else total
    return [range(first, min(first + size, total)) for first in range(0, total, size)]


def propose(sweep: Sweep, numbers: range, earlier: Mapping[int, Trial]) -> dict[int, Values]:
    """The values of each trial of one batch; those of a search depend on all earlier batches."""
    if sweep.trials is None:
        grid = _grid(sweep)
        return {number: grid[number] for number in numbers}
    return _drawn(sweep, numbers, [earlier[number] for number in range(numbers.start)])


def numbered(sweep: Sweep, ended: Iterable[Trial]) -> list[Trial]:
    """Ended trials by their numbers in `sweep`, whose grid or number of draws may have grown meanwhile.

    UserError for one that the sweep no longer has.
    """
    grid = {} if sweep.trials else {_key(values): number for number, values in enumerate(_grid(sweep))}
    found: dict[int, Trial] = {}
    for trial in ended:
        number = trial.number if sweep.trials else grid.get(_key(trial.values))
        if number is None or number >= (sweep.trials or len(grid)):
            raise UserError(
                f"holds trial {trial.counted} ({_key(trial.values)}), which the sweep no longer has; bring "
                "it back, or name another folder with --out"
            )
        found[number] = dataclasses.replace(trial, number=number)
    return [found[number] for number in sorted(found)]


def _key(values: Values) -> str:
    return json.dumps(values, sort_keys=True)


def _grid(sweep: Sweep) -> list[Values]:
    listed = (parameter.grid or [] for parameter in sweep.parameters.values())
    return [dict(zip(sweep.parameters, values, strict=True)) for values in itertools.product(*listed)]


def _drawn(sweep: Sweep, numbers: range, earlier: list[Trial]) -> dict[int, Values]:
    """A study is made anew from the earlier trials, so nothing but their results is carried over."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    seed = int(np.random.SeedSequence([sweep.seed, numbers.start]).generate_state(1)[0])
    sampler: Any = optuna.samplers.RandomSampler(seed=seed)
    if sweep.sampler == "tpe":
        sampler = optuna.samplers.TPESampler(seed=seed, constant_liar=True)
    study = optuna.create_study(sampler=sampler, direction="maximize")
    ranges = {key: _distribution(parameter) for key, parameter in sweep.parameters.items()}
    known = [trial for trial in earlier if trial.error is None]
    ranks = [sweep.objective.rank(trial.value, trial.summary) for trial in known]
    places = {rank: place for place, rank in enumerate(sorted(set(ranks)))}  # samplers use the order alone
    for trial, rank in zip(known, ranks, strict=True):
        drawn = {key: _index(sweep.parameters[key], value) for key, value in trial.values.items()}
        study.add_trial(optuna.trial.create_trial(params=drawn, distributions=ranges, value=places[rank]))
    asked = {number: study.ask(ranges).params for number in numbers}
    return {
        number: {key: _value(sweep.parameters[key], value) for key, value in drawn.items()}
        for number, drawn in asked.items()
    }


def _distribution(parameter: Parameter) -> Any:
    from optuna import distributions

    if parameter.choice is not None:
        # by their places: Optuna takes no lists among the choices
        return distributions.CategoricalDistribution(range(len(parameter.choice)))
    low, high = parameter.examples
    if parameter.integers is not None:
        return distributions.IntDistribution(low, high)
    return distributions.FloatDistribution(low, high, log=parameter.log_uniform is not None)


def _index(parameter: Parameter, value: Any) -> Any:
    return value if parameter.choice is None else parameter.choice.index(value)


def _value(parameter: Parameter, drawn: Any) -> Any:
    return drawn if parameter.choice is None else parameter.choice[drawn]
