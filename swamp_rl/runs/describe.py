"""What `dataset.yaml` says, and what is worked out from files, boat and times for each key it leaves out."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Any

from pydantic import ValidationError

from swamp_rl.boat import Boat
from swamp_rl.clipped import clipped
from swamp_rl.counted import counted
from swamp_rl.course import Course
from swamp_rl.course.outcome import outcome_of
from swamp_rl.errors import UserError
from swamp_rl.files import explanations, read_yaml
from swamp_rl.names import YAML, file_in, is_yaml
from swamp_rl.runs.check import STEP_TOLERANCE, typical_step
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import META, DatasetMeta, parsed_meta
from swamp_rl.runs.table import FORMATS

PARTICULARS = {"mass": "kg", "draught": "m", "water_density": "kg/m³"}
UNKNOWN: dict[str, Any] = {"mass": 1.0, "draught": 1.0, "water_density": 1.0, "sample_rate": 1.0}
"""Stand-ins for what is yet to be worked out, while the rest is validated."""


@dataclass(frozen=True)
class Description:
    """A description that is right as far as it goes: `lacking` are the keys yet to be worked out.

    named_boat, named_course: the reader's, where they are taken.
    """

    meta: DatasetMeta
    lacking: frozenset[str]
    named_boat: str | Path | None = None
    named_course: str | Path | None = None


def parse(
    folder: Path, boat: str | Path | None = None, course: str | Path | None = None
) -> tuple[Description | None, list[Fault]]:
    """What the folder says of itself, and all that is wrong with that.

    boat, course: names or files that are taken where it has no `dataset.yaml`, the boat also where that names
    none.
    """
    try:
        path = file_in(folder, META, YAML)
        entries = read_yaml(path) if path.exists() else {}
    except UserError as error:
        return None, [Fault(META, None, None, str(error).removeprefix(f"{folder / META}: "))]
    tables = sorted(found.name for found in folder.iterdir() if is_table(found))
    if not path.exists() and (boat is None or not tables):
        return None, [Fault(META, None, None, _missing(folder, bool(tables)))]
    whole = UNKNOWN | {"source": "measured", "runs": [{"file": name} for name in tables]} | entries
    named_boat = boat if "vehicle" not in entries else None
    named_course = course if not path.exists() else None
    if named_boat is not None:
        whole["vehicle"] = _name(named_boat)
    if named_course is not None:
        whole["course"] = _name(named_course)
    try:
        meta = parsed_meta(whole)
    except ValidationError as error:
        faults = explanations(error, DatasetMeta)
        return None, [
            Fault(META, None, None, f"{key}: {message}" if key else message) for key, message in faults
        ]
    lacking = frozenset({*UNKNOWN, "source", "runs"} - set(entries))
    return Description(meta, lacking, named_boat, named_course), []


def _name(config: str | Path) -> str:
    return Path(config).stem if is_yaml(config) else str(config)


def is_table(path: Path) -> bool:
    """Whether a file of a folder is a run, by its name."""
    return path.suffix.lower().lstrip(".") in FORMATS and not path.name.startswith(".")


def datasets_within(folder: Path) -> str | None:
    """What to do with a folder of datasets that is taken for one; None for another folder."""
    within = sorted(str(found) for found in folder.iterdir() if (found / META).is_file())
    if not within:
        return None
    join = f", or join them: swamp-rl runs import {quote(clipped(folder))}/* --out NEW" * (len(within) > 1)
    return f"this folder holds datasets; name one, such as {clipped(within[0])}{join}"


def _missing(folder: Path, tables: bool) -> str:
    within = None if tables else datasets_within(folder)
    if within is not None:
        return f"is missing, {within}"
    if not tables:
        return "is missing; name a folder of runs, swamp-rl runs import makes one of logs"
    return "is missing, and with it the boat of these runs; name it: --boat NAME, or vehicle: NAME in it"


def described(description: Description, boat: Boat | None) -> DatasetMeta:
    """The description with the particulars that it lacks, from the boat."""
    if boat is None:
        return description.meta
    return description.meta.model_copy(
        update={k: getattr(boat, k) for k in PARTICULARS if k in description.lacking}
    )


def common_rate(runs: Sequence[Run]) -> tuple[float, list[Fault]]:
    """The sample rate [Hz] of all runs, each of which has a fixed one; a fault where they differ."""
    rates = {str(run.meta.file): rate_of([run]) for run in runs}
    first, rate = next(iter(rates.items()))
    for file, other in rates.items():
        if abs(other / rate - 1.0) > STEP_TOLERANCE:
            message = (
                f"is sampled at {other:.6g} Hz, but {first} at {rate:.6g} Hz; resample one of them "
                "(swamp-rl runs import --resample HZ), or keep them in folders of their own"
            )
            return rate, [Fault(file, None, "time", message)]
    return rate_of(runs), []


def rate_of(runs: Sequence[Run]) -> float:
    """The rate [Hz] of the rows by their `typical_step`, with as many digits as times in float64 may be
    trusted for."""
    return float(f"{1.0 / typical_step([run.time for run in runs]):.9g}")  # 10 Hz is 10, not 9.99999999


def with_outcomes(runs: Sequence[Run], course: Course | None, boat: Boat) -> list[Run]:
    """The runs, and where there is a course, how each ended on it if that is not stated."""
    if course is None:
        return list(runs)
    return [run if run.meta.outcome is not None else with_outcome(run, course, boat) for run in runs]


def with_outcome(run: Run, course: Course, boat: Boat) -> Run:
    """The run with its outcome worked out from its track."""
    found = outcome_of(run.time, run.stacked(("north", "east")), course, boat.breadth)
    return Run(run.name, run.columns, run.meta.model_copy(update={"outcome": found}))


def noted(description: Description, meta: DatasetMeta) -> list[str]:
    """A line that tells what was worked out, and one where the boat is not the dataset's own copy."""
    units = PARTICULARS | {"sample_rate": "Hz"}
    found = [
        f"{key} {getattr(meta, key):g} {unit}" for key, unit in units.items() if key in description.lacking
    ]
    found += [f"source {meta.source}"] if "source" in description.lacking else []
    found += [counted(len(meta.runs), "run")] if "runs" in description.lacking else []
    notes = [f"worked out, as no {META} gives it: {', '.join(found)}"] if found else []
    if not meta.copies:
        notes.append(
            f"no copy of boat {meta.vehicle} lies here, today's is taken; swamp-rl runs export adds one"
        )
    return notes
