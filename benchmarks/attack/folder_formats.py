"""Files within folders that others give: exports of learning libraries, results, fleets, checksums."""

import functools
import json
import os
import pickle
import resource
import shutil
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.attack.samples import dataset_with
from swamp_rl.errors import UserError

HANG = 5
"""Seconds of processor time that a fork may take."""
SIZE = 8  # bytes of a number from a fork
Make, Read = Callable[[Path], Path], Callable[[Path], Any]


def _exported(kind: Any, name: str) -> Make:
    """Of a file in the export of a small dataset."""

    def make(folder: Path) -> Path:
        from swamp_rl.runs.export_dataset import export_runs

        dataset_with(folder, "csv", "one.csv")
        export_runs(folder / "runs", kind, folder / "export")
        (path,) = (folder / "export").rglob(name)
        return path

    return make


def _within(work: Callable[[Path], Any]) -> Callable[[Path], Any]:
    """In this process what `apart` does in another: the file under attack is not read there."""
    return getattr(work, "__wrapped__", work)


def read_in_fork(work: Callable[[Path], Any]) -> Callable[[Path], Any]:
    """In a fork, which starts sooner, what `apart` does in a new process; AssertionError beyond `HANG`, and
    beyond 1 GiB more than this process holds.
    """

    def done(path: Path) -> Any:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                resource.setrlimit(resource.RLIMIT_CPU, (HANG, HANG))
                os.write(writing, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss.to_bytes(SIZE))
                answer: tuple[Any, str | None]
                try:
                    answer = (_within(work)(path), None)
                except UserError as error:
                    answer = (None, str(error))
                with os.fdopen(writing, "wb") as out:
                    pickle.dump(answer, out)
                os._exit(0)
            finally:
                os._exit(1)
        os.close(writing)
        with os.fdopen(reading, "rb") as answered:
            inherited, data = int.from_bytes(answered.read(SIZE)), answered.read()
        _, status, used = os.wait4(child, 0)
        code = os.waitstatus_to_exitcode(status)
        assert code != -signal.SIGKILL, f"no end after {HANG} s of processor time"
        grown = used.ru_maxrss - inherited
        assert grown < 2**20, f"holds {grown / 2**20:.1f} GB"
        if code != 0:
            raise UserError(f"the process ended with {code}")
        value, refusal = pickle.loads(data)
        if refusal is not None:
            raise UserError(refusal)
        return value

    return done


def _doctored(levels: int, episodes_by: Callable[[Any], Any] = _within) -> Read:
    """The doctor on the folder so far above the file; episodes_by: how Minari's HDF5 is read."""

    def read(path: Path) -> Any:
        from swamp_rl.doctor import read as reader
        from swamp_rl.doctor.examine import examine

        with patch.object(reader, "_minari_episodes", episodes_by(reader._minari_episodes)):
            records = reader.read_records(path.parents[levels])
        return examine(records.runs, records.boat, records.measured)

    return read


def _checked(path: Path) -> Any:
    from swamp_rl.sums import refuse_changed_files

    return refuse_changed_files(path.parent)


def _results(name: str) -> Make:
    """Of a file in a folder of results."""

    def make(folder: Path) -> Path:
        from swamp_rl.evaluation import write_episodes
        from swamp_rl.evaluation.episodes import COLUMNS
        from swamp_rl.files import dumped

        home = folder / "results"
        (home / "config").mkdir(parents=True)
        plan = {"kind": "reservoir", "options": {"seed": 0, "ridge": 3.0}}
        experiment = {"name": "small", "boat": "swamp", "course": "camogli", "step": 0.1}
        experiment |= {"pilots": {"a": plan, "b": {"kind": "ppo", "options": {"start_from": "a"}}}}
        (home / "config" / "experiment.yaml").write_text(dumped(experiment))
        entries = {"pilots": {"a": {"learned_from": "3 runs"}}, "data": {"source": "human"}}
        (home / "results.json").write_text(json.dumps(entries))
        (home / "versions.json").write_text(json.dumps({"commit": "0123abc", "numpy": "2.0"}))
        table = {column: np.arange(3.0) for column in COLUMNS}
        table |= {"seed": np.arange(3), "success": np.array([True, False, True])}
        table["outcome"] = np.array(["success", "buoy", "success"])
        write_episodes(home / "episodes.parquet", {(pilot, "calm"): table for pilot in ("a", "b")})
        (path,) = home.rglob(name)
        return path

    return make


def _listed(path: Path) -> Any:
    """The leaderboard of the folder above, and the comparison."""
    from swamp_rl.experiments.artifacts.result_folders import entrants, find_results, read_result
    from swamp_rl.experiments.reports.leaderboard import gather, page

    folder = next(above for above in path.parents if above.name == "results")
    entrants([read_result(one) for one in find_results([folder])])
    return page(gather(folder))


def _fleet(name: str) -> Make:
    """Of the state of one of two datasets in a fleet."""

    def make(folder: Path) -> Path:
        for one in ("a", "b"):
            (folder / "in" / one).mkdir(parents=True)
            (folder / "in" / one / "run.csv").write_text(one)
        _go_on(folder)
        return folder / "out" / "a" / name

    return make


def _go_on(folder: Path) -> Any:
    from swamp_rl.experiments.fleet import diagnose_fleet

    pool = _Pool()
    diagnose_fleet([folder / "in" / "a", folder / "in" / "b"], folder / "out", pool=pool)
    return pool.done


def _state(path: Path) -> Any:
    """The fleet, gone on with; refused counts what is diagnosed again."""
    if _go_on(path.parents[2]):
        raise UserError("a damaged state: diagnosed again")


class _Pool:
    """Diagnoses in no time."""

    size = 1

    def __init__(self) -> None:
        self.jobs: list[tuple[int, str]] = []
        self.done = 0

    def submit(self, number: int, job: str) -> None:
        self.jobs.append((number, job))

    def wait(self) -> tuple[int, str | None, str]:
        from swamp_rl.experiments.fleet.work import INPUT, RESULT

        number, job = self.jobs.pop()
        asked = json.loads(job)
        out = Path(asked["out"])
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        (out / RESULT).write_text(_diagnosis())
        (out / INPUT).write_text(json.dumps(asked["input"]))
        self.done += 1
        return number, json.dumps({"verdict": "cause", "seconds": 0.0}), ""


@functools.cache
def _diagnosis() -> str:
    from swamp_rl.criticism.result import Cause, Diagnosis, Estimate, HeldOut

    empty = ("indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    mass = Cause(
        effect="mass",
        parameters={"mass": Estimate(value=60.0, standard_error=1.0, unit="kg")},
        held_out=HeldOut(gain=80.0, low=1.0, level=0.999),
    )
    given: dict[str, Any] = {name: [] for name in empty} | {"noise": {}, "adequacy": {}}
    found = Diagnosis(**given, verdict="cause", causes=[mass], separating_trial=None, elapsed_s=1.0)
    return found.model_dump_json()


FOLDER_FORMATS: dict[str, tuple[Make, Read]] = {
    "SHA256SUMS": (_exported("csv", "SHA256SUMS"), _checked),
    "doctor, lerobot info.json": (_exported("lerobot", "info.json"), _doctored(1)),
    "doctor, lerobot swamp_rl.json": (_exported("lerobot", "swamp_rl.json"), _doctored(1)),
    "doctor, lerobot frames.parquet": (_exported("lerobot", "data/**/file-000.parquet"), _doctored(2)),
    "doctor, minari metadata.json": (_exported("minari", "metadata.json"), _doctored(1)),
    "doctor, minari main_data.hdf5": (_exported("minari", "main_data.hdf5"), _doctored(1, read_in_fork)),
    "results, experiment.yaml": (_results("experiment.yaml"), _listed),
    "results.json": (_results("results.json"), _listed),
    "results, versions.json": (_results("versions.json"), _listed),
    "fleet, diagnosis.json": (_fleet("diagnosis.json"), _state),
    "fleet, fleet_input.json": (_fleet("fleet_input.json"), _state),
}
"""Of each name the maker and the reader."""
