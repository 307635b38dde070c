"""An experiment of a few seconds, and what two results of it must have in common."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import yaml
from swamp_rl.experiments.reports import figures

from swamp_rl.criticism.report import page
from swamp_rl.replacement import WRITTEN

TINY = """
name: tiny
boat: swamp
course: camogli
time_limit: 30.0
data: {record: {good: 3, failed: 0}}
pilots:
  scripted: {kind: scripted}
  reservoir: {kind: reservoir, takeover: 1.0, options: {units: 20}}
  net: {kind: cloning, options: {epochs: 3}}
  ppo:
    kind: ppo
    disturbances: calm
    options: {decisions: 1024, boats: 16, horizon: 16, batch_size: 64, leg: 1}
evaluation: {levels: [calm], episodes: 3, seed: 1, shown: 2}
"""
EXACT = ("config", "data", "pilots", "driven", "episodes.parquet", "data.sha256", "versions.json")


def write_tiny(folder: Path, *only: str) -> Path:
    """The experiment's file, with only some of its pilots if any are named."""
    data = yaml.safe_load(TINY)
    data["pilots"] = {name: plan for name, plan in data["pilots"].items() if not only or name in only}
    (folder / "tiny.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    return folder / "tiny.yaml"


@contextmanager
def empty_figures() -> Iterator[None]:
    """The PNGs of an experiment's report, half of the time of a small one, and those of a diagnosis, two
    seconds, are empty files meanwhile.
    """
    with pytest.MonkeyPatch.context() as patch:
        for name in ("tracks", "commands", "success_rates"):
            patch.setattr(figures, name, _empty)
        patch.setattr(page, "draw", _empty)
        yield


def _empty(path: Path, *drawn: Any) -> Path:
    path.write_bytes(b"")
    return path


def content(folder: Path) -> dict[str, Any]:
    """All of a result that does not depend on when and how it came about: bytes by file, and results.json.

    Not the list of the files' digests, which depends on how long a training took.
    """
    every = (path for name in EXACT for path in (folder / name, *(folder / name).rglob("*")))
    files = [path for path in every if path.is_file() and path.name != WRITTEN]
    found: dict[str, Any] = {path.relative_to(folder).as_posix(): _bytes(path) for path in files}
    results = json.loads((folder / "results.json").read_text())
    return found | {"results.json": {key: value for key, value in results.items() if key != "measured"}}


def _bytes(path: Path) -> Any:
    """What a file holds; a curve without how long its points took."""
    if path.suffix != ".jsonl":
        return path.read_bytes()
    points = [json.loads(line) for line in path.read_text().splitlines()]
    return [{key: value for key, value in point.items() if key != "seconds"} for point in points]
