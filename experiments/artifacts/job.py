"""A job in its folder: under a lock, taken up where an earlier life left it, and whole when it is seen."""

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from swamp_rl.experiments.artifacts.provenance import RESULTS, TENSORBOARD, TRAINED, WORK, description
from swamp_rl.experiments.artifacts.stages import Stages, stages
from swamp_rl.experiments.config.scene import Scene

from swamp_rl.errors import UserError
from swamp_rl.files import os_error, write_beside
from swamp_rl.json_text import read_json
from swamp_rl.names import refuse_link
from swamp_rl.one_thread import one_thread
from swamp_rl.ordinary import contents
from swamp_rl.sums import all_but_folders
from swamp_rl.unfinished import taken_up

SECONDS = "seconds.json"
TAKEN = ("data", "pilots/*", f"{TENSORBOARD}/*")
"""Folders that an evaluation takes over from a training."""


@contextmanager
def job(
    scene: Scene, folder: Path, replaces: tuple[str, ...], trained: Path | None
) -> Iterator[tuple[Path, Stages]]:
    """Yield the folder to build in, renamed to `folder` at the end, and the stages with their times so far.

    trained: a folder whose data and pilots are taken over where they are not there yet. replaces: the marks
    of folders that may be replaced. Linear algebra has one thread meanwhile, for the same bits everywhere.
    """
    with one_thread(), taken_up(folder, replaces, description(scene)) as part, stages() as bars:
        if trained is not None:
            _take_over(trained, part)
        yield part, bars.logged_in(part / WORK / SECONDS)
        for work in list(part.rglob(WORK)):
            shutil.rmtree(work)


def same_job(folder: Path, scene: Scene) -> bool:
    """Whether a folder was made with this configuration and these versions."""
    files = description(scene).items()
    return all((folder / name).is_file() and (folder / name).read_bytes() == held for name, held in files)


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
