"""From an experiment's YAML to a folder of results; or only to its pilots, to be evaluated later."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from swamp_rl.experiments.artifacts.job import job, same_training
from swamp_rl.experiments.artifacts.provenance import (
    RESULTS,
    TRAINED,
    description,
    experiment_name,
    kept_config,
    same_configs,
    with_data_hash,
    with_pilot_hashes,
)
from swamp_rl.experiments.artifacts.stages import Stages, measured
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene
from swamp_rl.experiments.config.schema import Experiment
from swamp_rl.experiments.reports.terminal import print_results, write_json
from swamp_rl.experiments.studies.main import do_experiment
from swamp_rl.experiments.training.train import get_data, train_pilots

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.files import written_path
from swamp_rl.json_text import read_json
from swamp_rl.unfinished import differences

Work = Callable[[Scene, Path, Stages], dict[str, Any]]
KEPT = "not replaced; name another folder with --out, or remove this one"


def run_experiment(
    name_or_path: str | Path, overrides: Iterable[str] = (), out: Path | str | None = None
) -> Path:
    """Run an experiment: record, train, evaluate and report; return the folder of results, by default
    results/NAME.

    The folder is built beside its place and renamed when complete. It replaces an earlier result of the same
    experiment; any other content is refused. An interrupted run resumes, and pilots that `train_experiment`
    has trained are used. Given a folder of results, the experiment is repeated from the configuration in the
    folder. UserError for every fault of the file, before any work.
    """
    with same_configs(kept_config(name_or_path)):
        experiment = load_experiment(name_or_path, overrides)
        folder = _folder(experiment, out)
        return evaluated(experiment, name_or_path, folder, None)


def evaluated(experiment: Experiment, given: str | Path, folder: Path, trained: Path | None) -> Path:
    """The folder of results of an experiment `given` so; runs and pilots in `trained` are taken over.

    Without it, those in `folder` are, where that holds pilots of the same job and no evaluation.
    """
    scene, work = _sound(experiment, given)
    earlier = None if trained == folder else _earlier(folder, scene)
    with job(scene, folder, (RESULTS, TRAINED), trained or earlier) as (part, progress):
        if not (part / RESULTS).is_file():
            write_json(part / RESULTS, work(scene, part, progress))
        (part / TRAINED).unlink(missing_ok=True)
        results = read_json(part / RESULTS, "remove the folder and run again")
    print_results(results, folder)
    return folder


def train_experiment(
    name_or_path: str | Path,
    overrides: Iterable[str] = (),
    out: Path | str | None = None,
    only: list[str] | str | None = None,
) -> Path:
    """Record the data of an experiment and train its pilots, all or those of `only`; evaluate none.

    Returns the folder, by default results/NAME. `run_experiment` and later calls for other pilots of the same
    experiment continue in it. UserError if it holds a complete result.
    """
    with same_configs(kept_config(name_or_path)):
        scene, work = _sound(load_experiment(name_or_path, overrides), name_or_path)
        plans = scene.experiment.pilots
        only = [only] if isinstance(only, str) else only
        if work is not do_experiment:
            raise UserError(f"{name_or_path}: its pilots are trained between other stages; use swamp-rl run")
        for name in only or ():
            if name not in plans:
                raise UserError(f"{name_or_path}: no pilot {name!r}{nearest(name, plans)}")
        folder = _folder(scene.experiment, out)
        there = _train(scene, folder, only)
    print(f"{folder}: {len(there)} of {counted(len(plans), 'pilot')} trained ({', '.join(there)})")
    return folder


def _train(scene: Scene, folder: Path, only: list[str] | None) -> list[str]:
    """The names of the pilots that lie in `folder` afterwards."""
    if (folder / RESULTS).is_file():
        raise UserError(
            f"{folder}: holds a complete result, which training does not replace; name another with --out"
        )
    with job(scene, folder, (TRAINED,), _earlier(folder, scene)) as (part, progress):
        dataset = get_data(scene, part, progress)
        train_pilots(scene, dataset, part / "pilots", progress, only)
        there = [name for name in scene.experiment.pilots if (part / "pilots" / name).exists()]
        write_json(part / TRAINED, {"pilots": there, "measured": measured(progress)})
    return there


def _folder(experiment: Experiment, out: Path | str | None) -> Path:
    return written_path(out) if out is not None else Path("results") / experiment.name


def _sound(experiment: Experiment, given: str | Path) -> tuple[Scene, Work]:
    """The scene of an experiment, and what is to be done in it; UserError for whatever is wrong."""
    from swamp_rl.experiments.studies.claims import check_claims, examine_claims
    from swamp_rl.experiments.studies.closed_loop import close_loop, true_scene

    hashed = with_pilot_hashes(with_data_hash(experiment, str(given)), str(given))
    scene = read_scene(hashed, given)
    if experiment.claims is not None:
        check_claims(scene)
        return scene, examine_claims
    if experiment.hidden is None:
        return scene, do_experiment
    true_scene(scene)  # whose effects are refused now, not after an hour
    return scene, close_loop


def _earlier(folder: Path, scene: Scene) -> Path | None:
    """The folder itself, where it holds pilots of the same job that are not evaluated yet, or of one that
    differs in pilots that are not trained there.

    UserError where it holds the result of another experiment, or pilots of another job: these are kept.
    """
    if (folder / RESULTS).is_file():
        if (name := experiment_name(folder)) not in (None, scene.experiment.name):
            raise UserError(f"{folder}: holds a result of {name}, {KEPT}")
        return None
    if not (folder / TRAINED).is_file():
        return None
    held = description(scene)
    if not same_training(held, folder):
        missing = [f"{name}: missing there" for name in held if not (folder / name).is_file()]
        other = next((f" ({one})" for one in (*differences(folder, held), *missing)), "")
        raise UserError(
            f"{folder}: holds pilots trained with another configuration or version{other}, {KEPT}"
        )
    return folder
