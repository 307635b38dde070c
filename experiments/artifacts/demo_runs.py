"""What `swamp-rl demo` shows: runs of datasets, results folders and single files, and pilots flown beside."""

import fnmatch
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from swamp_rl.experiments.artifacts.flown import flown, opened_for
from swamp_rl.experiments.artifacts.provenance import CONFIG, RESULTS, home_of

from swamp_rl.boat import Boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.config_kind import config_kind, one_file
from swamp_rl.course import Course, fitted, load_course
from swamp_rl.demo.conditions import conditions
from swamp_rl.demo.scene import Align, DemoScene, demo_scene
from swamp_rl.errors import UserError
from swamp_rl.files import read_yaml, shipped_folders
from swamp_rl.json_text import read_json
from swamp_rl.names import YAML, file_in, is_yaml
from swamp_rl.pilots.arguments import Asked, asked_pilot, names_pilot
from swamp_rl.pilots.store import BUILT_IN, known_names
from swamp_rl.runs import DatasetMeta, Run, read_dataset, read_run
from swamp_rl.runs.copies import course_file
from swamp_rl.runs.dataset import META, boat_of, read_meta
from swamp_rl.runs.describe import is_table


@dataclass
class Found:
    """Runs of one boat by who drove them, their rows `step` s apart.

    chosen: the labels shown when nothing else is asked for, None for all.
    """

    boat: Boat
    step: float
    course: Course | None
    groups: dict[str, list[Run]] = field(default_factory=dict)
    chosen: set[str] | None = None

    def add(self, group: str, runs: list[Run]) -> None:
        """More runs; a driver of another source that is called the same gets a number."""
        _add(self.groups, group, runs)


def read_shown(sources: Sequence[str | Path], patterns: list[str], align: Align | None) -> DemoScene:
    """The runs of `sources` whose name, or DRIVER/NAME, fits one of `patterns` (with * and ?), and pilots.

    Without patterns, a results folder shows its race only. A source that names a pilot (see `asked_pilot`) is
    flown in the episode of each run shown; without any other source, in that of `_usual_runs`; without any
    source at all, the pilots that come with the package are. UserError where nothing fits, or where the
    sources are of different courses.
    """
    refuse_missing([str(source) for source in sources])
    pilots = [asked_pilot(str(source)) for source in sources if names_pilot(str(source))]
    folders = [Path(source) for source in sources if not names_pilot(str(source))]
    if not sources:
        pilots = [asked_pilot(name) for name in (*shipped_folders("pilots"), *BUILT_IN)]
    named = [(folder, _read(folder)) for folder in folders] or _usual_runs(pilots)
    parts = [part for _, part in named]
    if len({_text(part.course) for part in parts}) > 1:
        courses = ", ".join(sorted(part.course.name if part.course else "none" for part in parts))
        raise UserError(f"these are runs of different courses ({courses}); show each course by itself")
    each = [_of_source(part, pilots, patterns) for part in parts]
    if not any(each):
        raise UserError(_nothing_fits(parts, patterns))
    first = parts[0]
    one_boat = len({boat_digest(part.boat) for part in parts}) == 1
    title = ", ".join(folder.resolve().name for folder, _ in named)
    size = first.boat.length, first.boat.breadth
    shown = _told_apart(each, _names(named))
    return demo_scene(title, shown, first.course, size, align, one_boat)


def _of_source(part: Found, pilots: Sequence[Asked], patterns: list[str]) -> dict[str, list[Run]]:
    """The runs of a source that are wanted, and the pilots beside them, by driver."""
    kept = {
        group: [run for run in runs if _wanted(part, group, run, patterns)]
        for group, runs in part.groups.items()
    }
    shown = {group: runs for group, runs in kept.items() if runs}
    beside = [run for runs in shown.values() for run in runs]
    for pilot in pilots if beside else ():
        _add(shown, pilot.name, _beside(pilot, part, beside))
    return shown


def _names(named: Sequence[tuple[Path, Found]]) -> list[str]:
    """What tells sources apart: their boats, where each has another, else their folders or files."""
    boats = [part.boat.name for _, part in named]
    return boats if len(set(boats)) == len(boats) else [source.resolve().stem for source, _ in named]


def _told_apart(each: Sequence[dict[str, list[Run]]], names: Sequence[str]) -> dict[str, list[Run]]:
    """The runs of all sources by driver, and by the source's name where a driver is of several."""
    count = Counter(group for groups in each for group in groups)
    shown: dict[str, list[Run]] = {}
    for groups, name in zip(each, names, strict=True):
        for group, runs in groups.items():
            _add(shown, f"{group} {name}" if count[group] > 1 else group, runs)
    return shown


def _usual_runs(pilots: Sequence[Asked]) -> list[tuple[Path, Found]]:
    """A run of the experiment that the first of the pilots was trained in, of those whose folder of results
    keeps runs; else the run that comes with the package."""
    for pilot in pilots:
        home = None if pilot.folder is None else home_of(pilot.folder)
        data = None if home is None else _data_of(home)
        if home is not None and data is not None:
            return [(home, _first_alone(_read_dataset(data, kept=home / CONFIG / "courses")))]
    return [(folder, _read(folder)) for folder in shipped_folders("runs").values()]


def _first_alone(found: Found) -> Found:
    """The same with one run chosen: the first successful one, else the first."""
    labelled = [(f"{group}/{run.name}", run) for group, runs in found.groups.items() for run in runs]
    label, _ = min(labelled, key=lambda one: one[1].meta.outcome != "success")
    return replace(found, chosen={label})


def _data_of(results: Path) -> Path | None:
    """The runs learned from in a folder of results; where they lie elsewhere, the run of the race alone."""
    return next((path for path in (results / "data", results / "shown") if path.is_dir()), None)


def _text(course: Course | None) -> str:
    return "" if course is None else course.model_dump_json()


def _add(groups: dict[str, list[Run]], group: str, runs: list[Run]) -> None:
    name, number = group, 1
    while name in groups:
        number += 1
        name = f"{group} {number}"
    groups[name] = runs


def _beside(asked: Asked, part: Found, runs: list[Run]) -> list[Run]:
    """The pilot's own runs, one in each of the episodes that the runs are of."""
    if part.course is None:
        raise UserError(f"{asked.name}: the runs have no course to fly on; name a dataset that has one")
    pilot = opened_for(asked, part.boat, part.step, named_by="runs of boat")
    episodes: list[Run] = []
    for run in runs:
        if not any(conditions([run, other]).same for other in episodes):
            episodes.append(run)
    return [flown(pilot, asked.name, run, part.boat, part.course, part.step) for run in episodes]


def _nothing_fits(parts: list[Found], patterns: list[str]) -> str:
    known = [f"{group}/{run.name}" for part in parts for group, runs in part.groups.items() for run in runs]
    some = ", ".join(known[:6]) + (", …" if len(known) > 6 else "")
    return f"no run fits --runs {' '.join(patterns)}; there are {some}"


def _wanted(part: Found, group: str, run: Run, patterns: list[str]) -> bool:
    label = f"{group}/{run.name}"
    if not patterns:
        return part.chosen is None or label in part.chosen
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns for name in (label, run.name))


def refuse_missing(sources: Sequence[str]) -> None:
    """UserError for the first source that is neither a file or folder nor names a pilot."""
    for source in sources:
        if not (names_pilot(source) or Path(source).exists()):
            raise UserError(
                f"{source}: no such file or folder; name a dataset, a results folder, a run's file or a "
                f"pilot{known_names(source)}"
            )


def _read(source: Path) -> Found:
    if source.is_file():
        return _read_file(source)
    return _read_results(source) if (source / RESULTS).is_file() else _read_dataset(source)


def _read_dataset(folder: Path, group: str | None = None, kept: Path | None = None) -> Found:
    """kept: the folder of courses that came with the results, for a dataset of before it had its own."""
    if not (folder / META).exists() and any(map(is_table, folder.iterdir())):
        raise UserError(
            f"{folder}: has no {META} to tell the boat of its runs; write vehicle: NAME into one, or import "
            "them: swamp-rl runs import"
        )
    dataset = read_dataset(folder)
    course = _course(folder, dataset.meta, kept, dataset.boat)
    groups: dict[str, list[Run]] = {}
    for run in dataset.runs:
        groups.setdefault(group or _driver(run, dataset.meta.source), []).append(run)
    return Found(dataset.boat, 1.0 / dataset.meta.sample_rate, course, groups)


def _driver(run: Run, source: str) -> str:
    """Who had the helm, where a pilot was aboard; else the dataset's source."""
    entries = run.meta.model_extra or {}
    pilot, helm = entries.get("pilot", "pilot"), entries.get("helm")
    return {"pilot": str(pilot), "both": f"{source} and {pilot}"}.get(str(helm), source)


def _read_file(path: Path) -> Found:
    if not is_table(path):
        kind = config_kind(read_yaml(path)) if is_yaml(path) else None
        what = one_file(kind) if kind else "no file of a run (.csv, .parquet)"
        raise UserError(f"{path}: is {what}; name a dataset, a results folder, a run's file or a pilot")
    if not (path.parent / META).is_file():
        raise UserError(f"{path}: has no {META} beside it to tell its boat; import it: swamp-rl runs import")
    meta = read_meta(path.parent)
    boat = boat_of(path.parent, meta)
    run = read_run(path)
    course = _course(path.parent, meta, None, boat)
    return Found(boat, 1.0 / meta.sample_rate, course, {_driver(run, meta.source): [run]})


def _read_results(folder: Path) -> Found:
    """The runs learned from and the pilots' own; those of the race are chosen."""
    results = read_json(folder / RESULTS, "make the results again")
    if not results.keys().isdisjoint(("hidden", "claims")):
        raise UserError(
            f"{folder}: an experiment with hidden or claims keeps no runs of its pilots; name a dataset or a "
            "pilot's folder in it"
        )
    try:
        race, data_source = dict(results["race"]["runs"]), str(results["data"]["source"])
    except (ValueError, KeyError, TypeError) as error:
        raise UserError(
            f"{folder / RESULTS}: lacks race.runs or data.source; make the results again"
        ) from error
    driven = sorted(path for path in (folder / "driven").glob("*") if path.is_dir())
    if not driven:
        raise UserError(f"{folder}: keeps no runs of its pilots (driven/); make the results again")
    kept, data = folder / CONFIG / "courses", _data_of(folder)
    parts = [] if data is None else [_read_dataset(data, data_source, kept)]
    parts += [
        _read_dataset(path, path.name if path.name != data_source else f"{path.name} pilot", kept)
        for path in driven
    ]
    found = Found(parts[-1].boat, parts[-1].step, parts[-1].course)
    for part in parts:
        for group, runs in part.groups.items():
            found.add(group, runs)
    found.chosen = {f"{group}/{name}" for group, name in race.items()}
    return found


def _course(folder: Path, meta: DatasetMeta, kept: Path | None, boat: Boat) -> Course | None:
    copy = None if kept is None or meta.copies else file_in(kept, f"{meta.course}.yaml", YAML)
    found = copy if copy is not None and copy.is_file() else course_file(folder, meta)
    return None if found is None else fitted(load_course(found), boat.length)
