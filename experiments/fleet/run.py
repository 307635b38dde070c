"""`swamp-rl fleet`: each dataset diagnosed once and kept, whatever is killed meanwhile, and then a report."""

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from swamp_rl.experiments.fleet.changes import changes_of
from swamp_rl.experiments.fleet.members import members_of
from swamp_rl.experiments.fleet.report import page
from swamp_rl.experiments.fleet.result import Fleet, Member
from swamp_rl.experiments.fleet.significance import RATE, findings_of, shared_causes, weather_of
from swamp_rl.experiments.fleet.summary import boats_of, of_boat_file, summarised
from swamp_rl.experiments.fleet.words import listed
from swamp_rl.experiments.fleet.work import (
    INPUT,
    RESULT,
    diagnose_one,
    input_of,
    is_done,
    numbers_of,
    read_diagnosis,
)

from swamp_rl import __version__
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.checks import refuse_sources_inside
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.errors import UserError
from swamp_rl.files import UNFINISHED, write_text
from swamp_rl.replacement import refuse_to_replace
from swamp_rl.simulator.weather import refuse_unknown
from swamp_rl.unfinished import locked, remove_dead
from swamp_rl.workers import Pool, completed, open_pool

FLEET, REPORT = "fleet.json", "fleet.html"
RETRIES = 2  # of a dataset whose process was lost
Tell = Callable[[str, str], None]
"""Hears each dataset's name and what came of it."""
TellKept = Callable[[int, int], None]
"""Hears how many diagnoses are kept, and how many are made again as something that they depend on changed."""


def diagnose_fleet(
    datasets: Sequence[Path | str],
    out: Path | str,
    boat: str | None = None,
    ignore: Sequence[str] = (),
    workers: int | None = None,
    ray: str | None = None,
    tell: Tell = lambda name, message: None,
    pool: Pool | None = None,
    tell_kept: TellKept = lambda kept, again: None,
) -> Fleet:
    """Diagnose every dataset into a folder of its own in `out`, and write fleet.json and fleet.html there.

    What an earlier life has finished is kept where the dataset, the boat and the version are the same, and
    otherwise until its own replacement is whole; what it has begun is removed. boat: what all are compared
    with, by default each dataset's own. workers: processes, by default one for each processor; ray: the
    address of a cluster in their place. A dataset that cannot be diagnosed has its line in the report.
    UserError for a dataset that is no folder, for an `out` that is none of a fleet, for a `boat` that is none
    and an unknown name in `ignore`.
    """
    out, given = Path(out), [Path(one) for one in datasets]
    members = members_of(given, boat)
    refuse_unknown(ignore)
    numbers = "" if boat is None else numbers_of(load_boat(boat))  # a wrong name is one fault, not many
    refuse_sources_inside(out, given)
    for dataset in given:
        if out.resolve().is_relative_to(dataset.resolve()):
            raise UserError(f"{out}: lies in the dataset {dataset}; name a folder outside with --out")
    with locked(out):
        _refuse_other_folder(out)
        jobs, wrong = _jobs(members, out, boat, numbers, ignore)
        again = sum((out / name / RESULT).is_file() for name in jobs)
        tell_kept(len(members) - len(jobs) - len(wrong), again)
        try:
            with ExitStack() as pools:
                if jobs and pool is None:  # a cluster that does not answer then leaves no folder
                    pool = pools.enter_context(open_pool(diagnose_one, workers, ray))
                out.mkdir(parents=True, exist_ok=True)
                for name, fault in wrong.items():
                    tell(name, fault)
                if pool is not None:
                    wrong |= carry_out(jobs, pool, tell)
        finally:
            remove_dead(out)  # what interrupted processes were building, which have ended with their pool
        fleet = fleet_of(members, out, wrong)
        write_text(out / FLEET, fleet.model_dump_json(indent=2) + "\n")
        write_text(out / REPORT, page(fleet))
    return fleet


def _refuse_other_folder(out: Path) -> None:
    """UserError for a link, and for a folder that holds anything but an earlier fleet."""
    if out.is_symlink():
        raise UserError(f"{out}: is a link, a folder was to be written here; name that or remove the link")
    if not out.exists() or (out / FLEET).is_file():
        return
    if not out.is_dir() or any(
        not (entry.name.startswith(UNFINISHED) or (entry.is_dir() and (entry / RESULT).is_file()))
        for entry in out.iterdir()
    ):
        raise UserError(f"{out}: already exists and is no earlier fleet; name another folder with --out")


def _jobs(
    members: Sequence[Member], out: Path, boat: str | None, numbers: str, ignore: Sequence[str]
) -> tuple[dict[str, str], dict[str, str]]:
    """By name, the jobs that are still to be done, and the faults of datasets that cannot even be read.

    A finished diagnosis is left to its job, which replaces it; a folder that has none is removed.
    """
    jobs, wrong = {}, {}
    for member in members:
        dataset, folder = Path(member.dataset), out / member.name
        try:
            note = input_of(dataset, numbers, list(ignore), __version__)
        except (UserError, OSError) as error:
            wrong[member.name] = " ".join(str(error).split())
            continue
        if is_done(folder, note):
            continue
        try:
            refuse_to_replace(folder, (RESULT, INPUT))
        except UserError as error:
            wrong[member.name] = str(error)
            continue
        if not (folder / RESULT).is_file():
            shutil.rmtree(folder, ignore_errors=True)
        job = {"dataset": str(dataset.absolute()), "boat": boat, "out": str(folder.absolute())}
        jobs[member.name] = json.dumps({**job, "ignore": list(ignore), "input": note})
    return jobs, wrong


def carry_out(jobs: Mapping[str, str], pool: Pool, tell: Tell) -> dict[str, str]:
    """Have every job done; by name, the faults of those that ended without a diagnosis."""
    names, wrong = list(jobs), dict[str, str]()
    for ended in completed(range(len(names)), lambda number: jobs[names[number]], pool, RETRIES):
        name = names[ended.number]
        result = json.loads(ended.answer) if ended.answer is not None else {"error": ended.error}
        if result.get("error"):
            wrong[name] = result["error"]
        tell(name, result.get("error") or _outcome(result))
    return wrong


def _outcome(result: Mapping[str, Any]) -> str:
    """The verdict of a diagnosis, the boat's causes and the weather."""
    causes, weather = result.get("causes"), result.get("weather")
    found = [listed(causes)] if causes else []
    return "; ".join([result["verdict"], *found, *([f"weather: {listed(weather)}"] if weather else [])])


def fleet_of(members: Sequence[Member], out: Path, wrong: Mapping[str, str]) -> Fleet:
    """The report of what the folder holds; wrong: by name, why there is no diagnosis."""
    found: dict[str, Diagnosis] = {}
    unread: dict[str, str] = {}
    for one in members:
        if one.name not in wrong:
            try:
                found[one.name] = read_diagnosis(out / one.name)
            except UserError as error:
                unread[one.name] = str(error)
    wrong = {**wrong, **unread}
    every = [one.model_copy(update={"error": wrong.get(one.name)}) for one in summarised(members, found)]
    findings, tests = findings_of(every, found)
    drifts, changes = changes_of(every, found, findings)
    return Fleet(
        version=__version__,
        rate=RATE,
        tests=tests,
        boats=boats_of(every, findings),
        members=every,
        findings=findings,
        shared=of_boat_file(shared_causes(findings), every, found),
        weather=weather_of(findings),
        drifts=drifts,
        changes=changes,
        measured={name: round(one.elapsed_s, 2) for name, one in found.items()},
    )
