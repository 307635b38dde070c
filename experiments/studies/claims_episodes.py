"""What the claims are tested on: a pilot trained anew for each choice of runs and flown, each flight kept."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from swamp_rl.experiments.artifacts.stages import Stages
from swamp_rl.experiments.config.claims import Claims
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.config.schema import PilotPlan
from swamp_rl.experiments.studies.claims_effects import Flight, Flown, Who, alone, named
from swamp_rl.experiments.training.train import train, with_takeover

from swamp_rl.arrays_file import read_arrays, write_arrays
from swamp_rl.evaluation import Rollout, drive, episode_table
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.scripted import Habits, ScriptedPilot
from swamp_rl.pilots.store import load_pilot, save_pilot
from swamp_rl.runs import Dataset, Run


def fly(
    scene: Scene,
    plan: Claims,
    dataset: Dataset,
    lessons: Sequence[list[Run]],
    progress: Stages,
    keep: Path,
) -> Flown:
    """Train the pilot on each choice of runs and try it wherever a claim asks for it.

    keep: the folder that each pilot and flight is kept in, and read from where it is there already.
    """
    flights: dict[Who, list[Flight]] = {}
    asked = flights_asked(plan)
    for draw, lesson in enumerate(lessons):
        place = keep / f"draw {draw}"
        missing = [one for one in asked if not _file(place, one).is_file()]
        if missing:
            with progress.stage(f"draw {draw + 1} of {len(lessons)}"):
                learned_from = replace(dataset, runs=lesson)
                for one in missing:
                    pilot = _pilot(scene, plan, learned_from, asked[one], draw, place)
                    if one[0] == named(asked[one]):
                        pilot = with_takeover(scene, scene.experiment.pilots[plan.pilot], pilot)
                    _write(_file(place, one), flight(scene, pilot, one[1]))
        for one in asked:
            flights.setdefault(one, []).append(_read(_file(place, one)))
    teacher = _teacher(scene, plan, keep, progress) if dataset.meta.source == "scripted" else None
    return Flown(flights, lessons, teacher, scene.boat)


def flights_asked(plan: Claims) -> dict[Who, int]:
    """Which pilots are flown at which levels in each draw, and from how many runs each has learned."""
    asked: dict[Who, int] = {}
    for runs in plan.runs:
        levels = everywhere(plan) if runs == plan.few else (plan.at,)
        asked |= {(named(runs), level): runs for level in levels}
        asked |= {(alone(runs), level): runs for level in plan.elsewhere if runs == plan.few}
    return asked


def everywhere(plan: Claims) -> tuple[str, ...]:
    """All levels that a claim is about, each once."""
    return tuple(dict.fromkeys((plan.at, plan.calm, *plan.disturbed, *plan.elsewhere)))


def _pilot(scene: Scene, plan: Claims, dataset: Dataset, runs: int, draw: int, place: Path) -> Pilot:
    """The pilot of a draw that learned from so many runs, without anybody who drives before it."""
    folder = place / named(runs)
    if not folder.exists():
        asked, checkpoint = scene.experiment.pilots[plan.pilot], place / f".checkpoint-{runs}"
        save_pilot(trained(scene, dataset, asked, runs, draw, checkpoint), folder)
        checkpoint.unlink(missing_ok=True)
    return load_pilot(folder)


def trained(
    scene: Scene, dataset: Dataset, asked: PilotPlan, runs: int, draw: int, checkpoint: Path | None = None
) -> Pilot:
    """The pilot from the first `runs` of the dataset, by a training seed of its own where it has one."""
    options = asked.options | ({"seed": draw} if "seed" in asked.options else {})
    plan = asked.model_copy(update={"runs": runs, "options": options})
    return train(scene, dataset, plan, lambda done: None, checkpoint)


def _teacher(scene: Scene, plan: Claims, keep: Path, progress: Stages) -> Mapping[str, Flight]:
    """The scripted pilot's flights by level."""
    place, flights = keep / "teacher", {}
    scripted = ScriptedPilot(
        scene.experiment.evaluation.seed, Habits(boat_length=scene.boat.length), scene.experiment.step
    )
    missing = [level for level in everywhere(plan) if not _file(place, ("teacher", level)).is_file()]
    if missing:
        with progress.stage("demonstrator"):
            for level in missing:
                _write(_file(place, ("teacher", level)), flight(scene, scripted, level))
    for level in everywhere(plan):
        flights[level] = _read(_file(place, ("teacher", level)))
    return flights


def flight(scene: Scene, pilot: Pilot, level: str) -> Flight:
    """The experiment's episodes at a level."""
    rollout = drive(pilot, scene.boats_at(scene.levels[level]), scene.seeds)
    return episode_table(rollout, scene.boat, scene.experiment.step), rollout


def _file(place: Path, who: Who) -> Path:
    return place / f"{who[0]} at {who[1]}.npz"


def _write(file: Path, flown: Flight) -> None:
    """The table and the tracks; of levers and throttles no claim asks for more than the table has."""
    table, rollout = flown
    arrays = {f"table/{column}": values for column, values in table.items()}
    arrays |= {name: getattr(rollout, name) for name in ("seeds", "steps", "outcome", "pose")}
    write_arrays(file, arrays)


def _read(file: Path) -> Flight:
    arrays = read_arrays(file)
    table = {key.removeprefix("table/"): arrays[key] for key in arrays if key.startswith("table/")}
    nothing = np.empty((len(arrays["seeds"]), 0, 2))
    seeds, steps, outcome, pose = (arrays[name] for name in ("seeds", "steps", "outcome", "pose"))
    return table, Rollout(seeds, steps, outcome, pose, nothing, nothing, table["return"])
