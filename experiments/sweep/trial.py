"""One trial of a sweep, from text to text, so that it may run in any process of any machine."""

import json
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from swamp_rl.experiments.config.schema import Experiment, Targets
from swamp_rl.experiments.sweep.schema import Objective

from swamp_rl.one_thread import one_thread

if TYPE_CHECKING:
    from swamp_rl.experiments.artifacts.stages import Stages


def job_of(experiment: Experiment, objective: Objective) -> str:
    """What a trial needs to know, as JSON: the objective, and the experiment `cut_down` to it."""
    cut = cut_down(experiment, objective)
    return json.dumps({"experiment": cut.model_dump(mode="json"), "objective": objective.model_dump()})


def cut_down(experiment: Experiment, objective: Objective) -> Experiment:
    """The experiment with the objective's level and pilot alone, and those that this one starts from."""
    from swamp_rl.experiments.config.learners import in_order

    needed = in_order(experiment.pilots, [objective.pilot])
    pilots = {name: experiment.pilots[name] for name in needed}
    level = next(level for level in experiment.evaluation.levels if Path(level).stem == objective.level)
    evaluation = experiment.evaluation.model_copy(update={"levels": (level,), "shown": 1})
    left_out = {"targets": Targets(), "claims": None}
    return experiment.model_copy(update={"pilots": pilots, "evaluation": evaluation, **left_out})


@one_thread()
def carry_out(job: str) -> str:
    """Train and evaluate; JSON of the objective's value and the summary of the episodes."""
    from swamp_rl.experiments.config.scene import read_scene
    from swamp_rl.experiments.evaluation.episodes import try_pilots
    from swamp_rl.experiments.training.train import get_data, train_pilots

    from swamp_rl.evaluation import summary

    asked = json.loads(job)
    objective = Objective.model_validate(asked["objective"])
    scene = read_scene(Experiment.model_validate(asked["experiment"]))
    with tempfile.TemporaryDirectory(prefix="swamp-rl-trial-") as name, quiet() as progress:
        dataset = get_data(scene, Path(name), progress)
        pilots = train_pilots(scene, dataset, Path(name) / "pilots", progress)
        one = {objective.pilot: pilots[objective.pilot]}
        tables = try_pilots(scene, one, progress).tables
    found = summary(tables[objective.pilot, objective.level])
    return json.dumps({"value": _value(found, objective), "summary": found}, allow_nan=False)


def _value(found: dict[str, Any], objective: Objective) -> float | None:
    if objective.measure == "success":
        return found["success_rate"]
    return found["mean_of_successes"][objective.measure]


@contextmanager
def quiet() -> Iterator["Stages"]:
    """Stages without bars and notes."""
    from rich.progress import Progress
    from swamp_rl.experiments.artifacts.stages import Stages

    with Progress(disable=True) as bars:
        yield Stages(bars, quiet=True)
