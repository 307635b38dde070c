"""A job in its folder: under a lock, taken up where an earlier life left it, and whole when it is seen."""

import json
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from swamp_rl.experiments.artifacts.provenance import (
    CONFIG,
    EXPERIMENT,
    OWN_CODE,
    RESULTS,
    TENSORBOARD,
    TRAINED,
    VERSIONS,
    WORK,
    checkpoints,
    description,
)
from swamp_rl.experiments.artifacts.stages import Stages, stages
from swamp_rl.experiments.config.scene import Scene

from swamp_rl.errors import UserError
from swamp_rl.files import os_error, read_yaml, write_beside
from swamp_rl.json_text import read_json
from swamp_rl.names import refuse_link
from swamp_rl.one_thread import one_thread
from swamp_rl.ordinary import contents
from swamp_rl.own_code import is_code, is_user_fault
from swamp_rl.sums import all_but_folders
from swamp_rl.unfinished import taken_up
from swamp_rl.yaml_text import parsed

SECONDS = "seconds.json"
TAKEN = ("data", "pilots/*", f"{TENSORBOARD}/*")
"""Folders that an evaluation takes over from a training."""
KEPT = f"{CONFIG}/{EXPERIMENT}"


@contextmanager
def job(
    scene: Scene, folder: Path, replaces: tuple[str, ...], trained: Path | None
) -> Iterator[tuple[Path, Stages]]:
    """Yield the folder to build in, renamed to `folder` at the end, and the stages with their times so far.

    trained: a folder whose data and pilots are taken over where they are not there yet. replaces: the marks
    of folders that may be replaced. Unfinished work of an experiment that differs in pilots not yet begun is
    continued. A UserError, or one in the user's own code, leaves no recorded runs where no pilot is trained.
    Linear algebra has one thread meanwhile, for the same bits everywhere.
    """
    held = description(scene)
    with (
        one_thread(),
        taken_up(folder, replaces, held, partial(same_training, held)) as part,
        stages() as bars,
    ):
        try:
            if trained is not None:
                _take_over(trained, part)
            yield part, bars.logged_in(part / WORK / SECONDS)
        except Exception as error:
            if is_user_fault(error):
                _clear_untrained(part)
            raise
        for work in list(part.rglob(WORK)):
            shutil.rmtree(work)


def _clear_untrained(part: Path) -> None:
    """Remove the recorded runs, and how long they took, where nothing else is finished."""
    made = {path.relative_to(part) for path in part.rglob("*") if path.is_file()}
    rest = {path for path in made if path.parts[0] not in ("data", CONFIG, VERSIONS)}
    if rest <= {Path(WORK, SECONDS)}:
        for name in ("data", WORK):
            shutil.rmtree(part / name, ignore_errors=True)


def same_training(held: Mapping[str, bytes], folder: Path) -> bool:
    """Whether the data and pilots in `folder` are those of the job of the description `held`.

    Targets may differ, and pilots of which nothing is there yet, with the code that they alone name.
    """
    found = {name: (folder / name).read_bytes() for name in held if (folder / name).is_file()}
    others = found.keys() - {KEPT, VERSIONS}
    if not {KEPT, VERSIONS} <= found.keys() or any(found[name] != held[name] for name in others):
        return False
    if all(found[name] == held[name] for name in (KEPT, VERSIONS)):
        return True
    return not (folder / RESULTS).is_file() and _same_but_pilots(held, folder)


def _same_but_pilots(held: Mapping[str, bytes], folder: Path) -> bool:
    new = parsed(held[KEPT].decode())
    try:
        old = read_yaml(folder / KEPT)
        before, after = old["pilots"], new["pilots"]
        begun = {name for name in before | after if _is_begun(folder / "pilots", name)}
        versions = json.loads(held[VERSIONS]), read_json(folder / VERSIONS, "remove it")
        unlike = [key for key in {**versions[0], **versions[1]} if len({v.get(key) for v in versions}) > 1]
    except (UserError, KeyError, TypeError):  # of a file that no job wrote
        return False
    kept = new.keys() - {"pilots", "targets"}
    plain = new["claims"] is None and new["hidden"] is None
    same = all(before.get(name) == after.get(name) for name in begun)
    fixed = {key: new[key] for key in kept} | {"pilots": {name: after.get(name) for name in begun}}
    free = {f"{OWN_CODE} {module}" for module in _modules([old, new]) - _modules(fixed)}
    return plain and same and free.issuperset(unlike) and all(old.get(key) == new[key] for key in kept)


def _modules(part: Any) -> set[str]:
    """The modules of all code that a part of a configuration names."""
    if isinstance(part, Mapping):
        return _modules([*part, *part.values()])
    if isinstance(part, list):
        return {module for one in part for module in _modules(one)}
    return {part.partition(":")[0]} if is_code(part) else set()


def _is_begun(pilots: Path, name: str) -> bool:
    return any(path.exists() for path in (pilots / name, *checkpoints(pilots, name)))


def _take_over(trained: Path, part: Path) -> None:
    """Copy what is TAKEN, each folder whole or not at all, and its times; UserError for links."""
    for top in [trained / Path(name).parts[0] for name in TAKEN]:
        refuse_link(top)
    for folder in [folder for name in TAKEN for folder in sorted(trained.glob(name))]:
        target = part / folder.relative_to(trained)
        if not folder.name.startswith(".") and not target.exists():
            target.parent.mkdir(exist_ok=True)
            _copied(folder, target.with_name(f".part-{target.name}")).rename(target)
    for mark in (RESULTS, TRAINED):
        if (trained / mark).is_file() and not (part / WORK / SECONDS).exists():
            measured = read_json(trained / mark, "train again into another folder").get("measured")
            took = measured.get("seconds") if isinstance(measured, dict) else None
            if not isinstance(took, dict):
                raise UserError(f"{trained / mark}: tells no times of training; train again")
            earlier = {name: value for name, value in took.items() if name.startswith(("record", "train"))}
            (part / WORK).mkdir(exist_ok=True)
            (part / WORK / SECONDS).write_text(json.dumps(earlier), encoding="utf-8")


def _copied(folder: Path, target: Path) -> Path:
    """A new folder of the same files; UserError unless they are ordinary ones of this folder."""
    refuse_link(folder)
    target.mkdir()
    for path in all_but_folders(folder):
        refuse_link(path)
        try:
            held = contents(path, follow=False)
        except OSError as error:
            raise os_error(error, path) from error
        with write_beside(target / path.relative_to(folder)) as file:
            file.write_bytes(held)
    return target
