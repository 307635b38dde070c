"""What a folder of results keeps of how it was made, and how an experiment is found again in one."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

from swamp_rl.experiments.artifacts.versions import versions
from swamp_rl.experiments.config.digests import digest, hashes, pilot_hash
from swamp_rl.experiments.config.scene import Scene, config_files
from swamp_rl.experiments.config.schema import Experiment, senses_in

from swamp_rl.errors import UserError
from swamp_rl.files import CONFIG_KINDS, config_copies, read_yaml, refuse_object, yaml_text
from swamp_rl.names import is_yaml
from swamp_rl.own_code import source_digests
from swamp_rl.pilots.own import SHIPPED, model_file, own_class, settings_of
from swamp_rl.runs.copies import extending

RESULTS, TRAINED = "results.json", "training.json"
"""Marks of a whole result and of one whose pilots are trained but not evaluated."""
TRUE_BOAT = "true_boat.yaml"
"""Of a closed loop: the boat that its pilots are evaluated in, for other pilots."""
CONFIG, EXPERIMENT, VERSIONS = "config", "experiment.yaml", "versions.json"
OWN_CODE = "own code"
"""Before the name of a module in the versions."""
WORK = ".work"
"""Folders of what is needed only until the result is whole."""
TENSORBOARD = "tensorboard"
"""The folder of event files in a folder of results, by pilot."""


def checkpoints(pilots: Path, name: str) -> tuple[Path, Path]:
    """The files from which a pilot's training goes on, in the folder of pilots: its own, and that of the
    learner in DAgger's rounds."""
    return pilots / f".checkpoint-{name}", pilots / f".checkpoint-{name}-round"


def description(scene: Scene) -> dict[str, bytes]:
    """The files that say what a result is of, by path in its folder: configuration and versions."""
    written = yaml_text(scene.experiment.model_dump(mode="json"))
    files = {f"{CONFIG}/{EXPERIMENT}": written.encode()}
    files |= {f"{CONFIG}/{name}": text for name, text in _copies(scene).items()}
    own = own_code_of(scene.experiment)
    entries = versions() | {f"{OWN_CODE} {module}": digest for module, digest in own.items()}
    return files | {VERSIONS: (json.dumps(entries, indent=2) + "\n").encode()}


def digests_of_inputs(scene: Scene) -> dict[str, str]:
    """SHA-256 of each file that an experiment names: boat, course, levels and the modules of own code."""
    files = {name: hashlib.sha256(text).hexdigest() for name, text in _copies(scene).items()}
    return files | own_code_of(scene.experiment)


def _copies(scene: Scene) -> dict[str, bytes]:
    """The files that an experiment names, by the path that each is kept at. One that extends another extends
    the copy of that.
    """
    files = config_files(scene)
    texts = {name: file.read_bytes() for name, file in files.items()}
    for name, base in pairwise(files):
        data, beside = read_yaml(files[name]), Path(base).name
        if data.get("extends", beside) not in (beside, Path(beside).stem):
            texts[name] = extending(texts[name], data, beside)
    return texts


def own_code_of(experiment: Experiment) -> dict[str, str]:
    """`source_digests` of the kinds, observations and reward terms that an experiment names as code."""
    plans = experiment.pilots.values()
    observed = [name for plan in plans for senses in senses_in(plan.options) for name in senses]
    return source_digests([*(plan.kind for plan in plans), *experiment.reward, *observed])


def kept_config(given: str | Path) -> Path | None:
    """The `config` folder of a result, given by it, by the result's own folder or by the file in it.

    UserError for what is neither a name nor a path.
    """
    refuse_object("experiments", given)
    path = Path(given)
    for folder in (path / CONFIG, path, path.parent):
        if (folder / EXPERIMENT).is_file() and (path.is_dir() or path.name == EXPERIMENT):
            return folder
    return None


def home_of(folder: Path) -> Path | None:
    """The folder of results that this is, or that holds this pilot's folder or configuration."""
    config = kept_config(folder)
    home = folder.resolve().parent.parent if config is None else config.resolve().parent
    if config is None and not (home / CONFIG / EXPERIMENT).is_file():
        return None
    here = Path.cwd()
    below = not folder.is_absolute() and home != here and home.is_relative_to(here)
    return home.relative_to(here) if below else home


def experiment_name(folder: Path) -> str | None:
    """The name of the experiment that a folder of results keeps; None where it keeps none."""
    kept = folder / CONFIG / EXPERIMENT
    return str(read_yaml(kept).get("name")) if kept.is_file() else None


@contextmanager
def same_configs(config: Path | None) -> Iterator[None]:
    """Within the block boats, courses and disturbances are those copied into `config`, by their old names."""
    if config is None:
        yield
        return
    copies = {
        (kind, file.stem): file for kind in CONFIG_KINDS for file in sorted((config / kind).glob("*.yaml"))
    }
    for name in _named_in(read_yaml(config / EXPERIMENT)):
        for kind in CONFIG_KINDS:
            if (config / kind / Path(name).name).is_file():
                copies[kind, name] = config / kind / Path(name).name
    with config_copies(copies):
        yield


def _named_in(data: Any) -> Iterator[str]:
    """Every text in a configuration that may be the path of a file."""
    if isinstance(data, str):
        if is_yaml(data):
            yield data
    elif isinstance(data, Mapping | list):
        for part in data.values() if isinstance(data, Mapping) else data:
            yield from _named_in(part)


def with_data_hash(experiment: Experiment, where: str) -> Experiment:
    """The experiment with the digest of the folder it learns from; UserError where it names another one."""
    data = experiment.data
    if data.folder is None:
        return experiment
    try:
        found = digest(hashes(Path(data.folder)))
    except UserError as error:
        raise UserError(f"{where}: data.folder: {error}") from error
    if data.sha256 not in (None, found):
        raise UserError(
            f"{where}: data.sha256: the runs in {data.folder} are no longer those that it was made with; "
            "bring them back, or drop the key to learn from what is there"
        )
    return experiment.model_copy(update={"data": data.model_copy(update={"sha256": found})})


def with_pilot_hashes(experiment: Experiment, where: str) -> Experiment:
    """The experiment with the hash of each pilot given by its folder or its model's file.

    UserError where such a file is not there, holds no model that can steer, or is another one than the
    experiment names.
    """
    plans = dict(experiment.pilots)
    for name, plan in plans.items():
        if plan.kind in SHIPPED:
            model = hashlib.sha256(model_file(plan.options["file"], plan.options.get("sha256"))).hexdigest()
            found = own_class(plan.kind)
            found.read(
                settings_of(found).model_validate(plan.options)
            )  # one that cannot steer is refused now
            plans[name] = plan.model_copy(update={"options": plan.options | {"sha256": model}})
        if plan.kind != "stored":
            continue
        held = pilot_hash(plan.options["folder"])
        if plan.options.get("sha256") not in (None, held):
            raise UserError(
                f"{where}: pilots.{name}.options.sha256: the pilot in {plan.options['folder']} is no longer "
                "the one that it was made with; bring it back, or drop the key to take what is there"
            )
        plans[name] = plan.model_copy(update={"options": plan.options | {"sha256": held}})
    return experiment.model_copy(update={"pilots": plans})


def seeds(experiment: Experiment) -> dict[str, Any]:
    """Every seed of an experiment: of its recorded runs, of its pilots by name, of its episodes."""
    pilots = {
        name: plan.options["seed"] for name, plan in experiment.pilots.items() if "seed" in plan.options
    }
    recorded = {} if experiment.data.folder else {"record": experiment.data.record.seed}
    hidden = {} if experiment.hidden is None else {"logs": experiment.hidden.logs.seed}
    return recorded | hidden | {"pilots": pilots, "first_episode": experiment.evaluation.seed}
