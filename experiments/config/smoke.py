"""Any experiment made so small that it says nothing, but goes through every stage: does it still work?"""

from collections.abc import Mapping
from typing import Any

from swamp_rl.experiments.config.schema import Experiment, PilotPlan

RUNS, EPISODES = 3, 3
MOST = {
    "batch_size": 64,
    "boats": 16,
    "decisions": 1024,
    "episodes": 2,
    "epochs": 1,
    "folds": 2,
    "horizon": 16,
    "leg": 2,
    "random": 64,
    "rounds": 1,
    "runs": 2,
    "trials": 4,
    "units": 50,
    "updates": 1,
}
"""What an option of a pilot's training may be at most, by its name, whatever the kind of pilot."""


def shrunk(experiment: Experiment) -> Experiment:
    """The experiment with few runs, decisions, epochs and episodes, under a name of its own.

    Every pilot and every level stays, so that what cannot be trained or evaluated is found.
    """
    record = experiment.data.record
    few = record.model_copy(update={"good": min(record.good, RUNS), "failed": 0})
    hidden, claims, evaluation = experiment.hidden, experiment.claims, experiment.evaluation
    if claims is not None:
        claims = claims.model_copy(update={"draws": 2, "runs": (2, RUNS), "few": 2})
    if hidden is not None:
        logs = hidden.logs.model_copy(update={"runs": min(hidden.logs.runs, RUNS)})
        hidden = hidden.model_copy(update={"logs": logs})
    return experiment.model_copy(
        update={
            "name": experiment.name if experiment.name.endswith("smoke") else f"{experiment.name}-smoke",
            "data": experiment.data.model_copy(update={"record": few}),
            "pilots": {name: _small(plan) for name, plan in experiment.pilots.items()},
            "evaluation": evaluation.model_copy(
                update={"episodes": min(evaluation.episodes, EPISODES), "shown": 1}
            ),
            "hidden": hidden,
            "claims": claims,
            "smoke": False,  # done: what is asked of its results later is not made small again
        }
    )


def _small(plan: PilotPlan) -> PilotPlan:
    runs = None if plan.runs is None else min(plan.runs, RUNS)
    return plan.model_copy(update={"runs": runs, "options": _capped(plan.options)})


def _capped(options: Mapping[str, Any]) -> dict[str, Any]:
    return {key: _at_most(MOST.get(key), value) for key, value in options.items()}


def _at_most(most: int | None, value: Any) -> Any:
    if isinstance(value, Mapping):
        return _capped(value)
    return min(value, most) if most is not None and isinstance(value, int) else value
