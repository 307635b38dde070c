"""From logs of a boat that is not quite as its file says to pilots that drive it better.

A true boat has effects that nothing but the sailing knows. It is logged, its logs are diagnosed against the
boat file, pilots are trained in the simulator with and without what was found, and all are flown in the true
boat, in the same episodes.
"""

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.artifacts.provenance import CONFIG, TRUE_BOAT, WORK, seeds
from swamp_rl.experiments.artifacts.results import pilot_results
from swamp_rl.experiments.artifacts.stages import Stages, measured
from swamp_rl.experiments.config.digests import write_hashes
from swamp_rl.experiments.config.named_files import levels_flown
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.config.schema import Logs
from swamp_rl.experiments.evaluation.episodes import try_pilots
from swamp_rl.experiments.training.effects_twice import effects_twice
from swamp_rl.experiments.training.train import get_data, train_pilots

from swamp_rl.angles import wrapped
from swamp_rl.boat import load_boat
from swamp_rl.criticism.diagnose import RESULT, diagnose
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.effects import parse_effects
from swamp_rl.effects.entries import entry_mapping
from swamp_rl.errors import UserError
from swamp_rl.evaluation import Table, success_difference, write_episodes
from swamp_rl.files import find_config, write_yaml
from swamp_rl.pilots.record import NOTES, drive_episodes
from swamp_rl.pilots.scripted import Habits, ScriptedPilot
from swamp_rl.pilots.store import save_pilot
from swamp_rl.runs import Run, append_run, create_dataset
from swamp_rl.runs.schema import meta_of
from swamp_rl.unfinished import folder_beside

Array = NDArray[np.float64]

SIMULATORS = ("nominal", "extended")
SCRIPTED = "scripted"
"""Name of the untrained pilot that is evaluated as a reference."""
LOGGED = ("time", "north", "east", "heading", "surge", "sway", "yaw_rate")
COMMANDS = ("azimuth_", "throttle_", "rudder_", "propeller_", "joy_")
FIRST_LOG = 2**32
"""Seeds of logged episodes lie above those that pilots learn from or are tried on."""


def true_scene(scene: Scene) -> Scene:
    """The experiment's scene with the true boat in place of the boat file's.

    UserError for a wrong effect, and for a pilot of the name that the scripted one is evaluated under.
    """
    hidden = scene.experiment.hidden
    assert hidden is not None
    if SCRIPTED in scene.experiment.pilots:
        raise UserError(f"pilots.{SCRIPTED}: a closed loop evaluates it anyway; drop it, or rename yours")
    effects = parse_effects(hidden.effects, "hidden", scene.boat.thruster_names)
    boat = scene.boat.model_copy(update={"effects": (*scene.boat.effects, *effects)})
    return replace(scene, boat=boat)


def close_loop(scene: Scene, folder: Path, progress: Stages) -> dict[str, Any]:
    """Every stage in turn, each writing what it makes into `folder`; what goes into results.json."""
    truth, plan = true_scene(scene), scene.experiment.hidden
    assert plan is not None
    write_true_boat(truth, folder)
    named = truth.boat.model_copy(update={"name": true_name(truth)})
    for line in effects_twice(named, levels_flown(truth.experiment)):
        progress.say(line)
    if not (folder / "logs").exists():
        with progress.stage("log the true boat"), folder_beside(folder / "logs") as part:
            write_logs(truth, plan.logs, part)
    if not (folder / "diagnosis").exists():
        with progress.stage("diagnose"):
            diagnose(folder / "logs", scene.experiment.boat, folder / "diagnosis")
    found = Diagnosis.model_validate_json((folder / "diagnosis" / RESULT).read_text(encoding="utf-8"))
    extended = folder / "diagnosis" / "extended_boat.yaml"
    tables: dict[tuple[str, str], Table] = {}
    for simulator, own in zip(SIMULATORS, (scene, with_boat(scene, str(extended))), strict=True):
        stages = Stages(progress.bars).logged_in(folder / simulator / WORK / "seconds.json")
        flown = fly(own, truth, folder / simulator, stages)
        tables |= {(called(name, simulator), level): table for (name, level), table in flown.items()}
        progress.seconds.update({f"{name}, {simulator}": s for name, s in stages.seconds.items()})
    write_episodes(folder / "episodes.parquet", tables)
    return results_of(scene, found, tables, progress, folder)


def write_true_boat(truth: Scene, folder: Path) -> None:
    """The true boat as a file that extends the copy of the boat file in the folder of results."""
    assert truth.experiment.hidden is not None
    base = find_config("boats", truth.experiment.boat).name
    effects = parse_effects(truth.experiment.hidden.effects, "hidden", truth.boat.thruster_names)
    write_yaml(
        folder / TRUE_BOAT,
        {
            "extends": f"{CONFIG}/boats/{base}",
            "name": true_name(truth),
            "effects": [entry_mapping(entry) for entry in effects],
        },
    )


def true_name(truth: Scene) -> str:
    """How the true boat is named, in its file and in notes."""
    return f"{truth.boat.name}-true"


def called(name: str, simulator: str) -> str:
    """How a pilot trained there is named; the scripted one learned nowhere."""
    return name if name == SCRIPTED else f"{name}, {simulator}"


def with_boat(scene: Scene, boat: str) -> Scene:
    """The scene with another boat file."""
    experiment = scene.experiment.model_copy(update={"boat": boat})
    return replace(scene, experiment=experiment, boat=load_boat(boat))


def fly(own: Scene, truth: Scene, folder: Path, progress: Stages) -> dict[tuple[str, str], Table]:
    """Train the pilots in their own simulator and fly them in the true boat; episodes by pilot and level."""
    dataset = get_data(own, folder, progress)
    pilots = train_pilots(own, dataset, folder / "pilots", progress)
    if folder.name == SIMULATORS[0]:
        pilots[SCRIPTED] = ScriptedPilot(
            own.experiment.evaluation.seed, Habits(boat_length=own.boat.length), own.experiment.step
        )
        save_pilot(pilots[SCRIPTED], folder / "pilots" / SCRIPTED)
    return dict(try_pilots(truth, pilots, progress, folder / WORK / "tried").tables)


def write_logs(truth: Scene, logs: Logs, folder: Path) -> None:
    """Runs of the scripted pilot in the true boat as sensors see them, under the boat file's own name."""
    pilot = ScriptedPilot(logs.seed, Habits(boat_length=truth.boat.length), truth.experiment.step)
    boats = truth.boats_at(logs.disturbances)(logs.runs, pilot.senses)
    pilot.reset(logs.runs)
    seeds = FIRST_LOG + 1000 * logs.seed + np.arange(logs.runs)
    try:
        driven = drive_episodes(boats, pilot, truth.boat, seeds, pilot.step)
    finally:
        boats.close()
    meta = meta_of(
        truth.boat,
        truth.experiment.boat,
        1.0 / truth.experiment.step,
        "scripted",
        course=truth.experiment.course,
        notes=NOTES,
    )
    create_dataset(folder, meta)
    rng = np.random.default_rng(logs.seed)
    for number, run in enumerate(driven):
        append_run(folder, Run(f"log-{number:03d}", noisy(run, logs, rng)))


def noisy(run: Run, logs: Logs, rng: np.random.Generator) -> dict[str, Array]:
    """The columns that a logger on the boat would have: motion with the sensors' noise, and commands."""
    columns = {
        name: run.columns[name].copy() for name in run.columns if name in LOGGED or name.startswith(COMMANDS)
    }
    sizes = (
        [logs.position_noise] * 2 + [logs.heading_noise] + [logs.velocity_noise] * 2 + [logs.yaw_rate_noise]
    )
    for name, size in zip(LOGGED[1:], sizes, strict=True):
        columns[name] += size * rng.standard_normal(len(columns[name]))
    columns["heading"] = wrapped(columns["heading"])
    return columns


def results_of(
    scene: Scene, found: Diagnosis, tables: dict[tuple[str, str], Table], progress: Stages, folder: Path
) -> dict[str, Any]:
    """All of results.json; report.md and its figure are written beside."""
    from swamp_rl.experiments.reports.closed_loop import write_report

    experiment = scene.experiment
    assert experiment.hidden is not None
    levels = pilot_results(tables)
    results = {
        "name": experiment.name,
        "description": experiment.description,
        "boat": scene.boat.name,
        "course": scene.course.name,
        "hidden": experiment.hidden.model_dump(mode="json"),
        "diagnosis": {
            "verdict": found.verdict,
            "causes": [cause.model_dump(mode="json") for cause in found.causes],
            "gain": [gain.model_dump(mode="json") for gain in found.gain],
        },
        "evaluation": {
            "levels": list(scene.levels),
            "episodes": experiment.evaluation.episodes,
            "seed": experiment.evaluation.seed,
        },
        "pilots": {name: {"levels": by_level} for name, by_level in levels.items()},
        "differences": differences_of(scene, tables),
        "targets": [],
        "data": {"sha256": write_hashes(folder / "logs", folder)},
        "seeds": seeds(experiment),
        "measured": measured(progress),
    }
    write_report(folder, results)
    return results


def differences_of(scene: Scene, tables: dict[tuple[str, str], Table]) -> list[dict[str, Any]]:
    """Success of each pilot trained in the extended simulator less that of its twin, paired over episodes."""
    found = []
    for pilot in scene.experiment.pilots:
        for level in scene.levels:
            nominal, extended = (tables[called(pilot, s), level]["success"] for s in SIMULATORS)
            made = success_difference(extended, nominal)
            found.append({"pilot": pilot, "level": level, "extended_less_nominal": asdict(made)})
    return found
