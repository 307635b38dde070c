"""Which runs `swamp-rl demo` shows: of datasets, results folders and single files, by who drove."""

import fnmatch
from dataclasses import dataclass, field
from pathlib import Path

from swamp_rl.course import Course, load_course
from swamp_rl.demo.scene import Align, DemoScene, demo_scene
from swamp_rl.errors import UserError
from swamp_rl.json_text import parsed_json
from swamp_rl.runs import DatasetMeta, Run, read_dataset, read_run
from swamp_rl.runs.copies import course_file
from swamp_rl.runs.dataset import META, boat_of, read_meta

RESULTS = "results.json"


@dataclass
class Found:
    """Runs by who drove them; `chosen` are the labels shown when nothing else is asked for, None for all."""

    groups: dict[str, list[Run]] = field(default_factory=dict)
    course: Course | None = None
    size: tuple[float, float] = (0.0, 0.0)
    chosen: set[str] | None = None

    def add(self, group: str, runs: list[Run]) -> None:
        """More runs; a driver of another source that is called the same gets a number."""
        name, number = group, 1
        while name in self.groups:
            number += 1
            name = f"{group} {number}"
        self.groups[name] = runs


def read_shown(sources: list[Path], patterns: list[str], align: Align) -> DemoScene:
    """All runs of `sources` whose name, or DRIVER/NAME, fits one of `patterns` (with * and ?).

    Without patterns, a results folder shows its race only. UserError where nothing fits, or where the sources
    are of different courses.
    """
    parts = [_read(source) for source in sources]
    courses = {part.course for part in parts}
    if len(courses) > 1:
        named = ", ".join(sorted(course.name if course else "none" for course in courses))
        raise UserError(f"these are runs of different courses ({named}); show each course by itself")
    all_of_them = Found()
    for part in parts:
        for group, runs in part.groups.items():
            kept = [run for run in runs if _wanted(part, group, run, patterns)]
            if kept:
                all_of_them.add(group, kept)
    if not all_of_them.groups:
        known = [
            f"{group}/{run.name}" for part in parts for group, runs in part.groups.items() for run in runs
        ]
        some = ", ".join(known[:6]) + (", …" if len(known) > 6 else "")
        raise UserError(f"no run fits --runs {' '.join(patterns)}; there are {some}")
    title = ", ".join(source.resolve().name for source in sources)
    return demo_scene(title, all_of_them.groups, parts[0].course, parts[0].size, align)


def _wanted(part: Found, group: str, run: Run, patterns: list[str]) -> bool:
    label = f"{group}/{run.name}"
    if not patterns:
        return part.chosen is None or label in part.chosen
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns for name in (label, run.name))


def _read(source: Path) -> Found:
    if source.is_file():
        return _read_file(source)
    if (source / RESULTS).is_file():
        return _read_results(source)
    if not source.is_dir():
        raise UserError(f"{source}: no such file or folder; name a dataset, a results folder or a run's file")
    return _read_dataset(source)


def _read_dataset(folder: Path, group: str | None = None, kept: Path | None = None) -> Found:
    """kept: the folder of courses that came with the results, for a dataset of before it had its own."""
    dataset = read_dataset(folder)
    boat = dataset.boat
    groups: dict[str, list[Run]] = {}
    for run in dataset.runs:
        groups.setdefault(group or _driver(run, dataset.meta.source), []).append(run)
    return Found(groups, _course(folder, dataset.meta, kept), (boat.length, boat.breadth))


def _driver(run: Run, source: str) -> str:
    """Who had the helm, where a pilot was aboard; else the dataset's source."""
    told = run.meta.model_extra or {}
    pilot, helm = told.get("pilot", "pilot"), told.get("helm")
    return {"pilot": str(pilot), "both": f"{source} and {pilot}"}.get(str(helm), source)


def _read_file(path: Path) -> Found:
    if not (path.parent / META).is_file():
        raise UserError(f"{path}: has no {META} beside it to tell its boat; import it: swamp-rl runs import")
    meta = read_meta(path.parent)
    boat = boat_of(path.parent, meta)
    run = read_run(path)
    course = _course(path.parent, meta, None)
    return Found({_driver(run, meta.source): [run]}, course, (boat.length, boat.breadth))


def _read_results(folder: Path) -> Found:
    """The runs learned from and the pilots' own; those of the race are chosen."""
    try:
        results = parsed_json((folder / RESULTS).read_bytes())
        race, data_source = dict(results["race"]["runs"]), str(results["data"]["source"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UserError(f"{folder / RESULTS}: cannot be read ({error}); make the results again") from error
    driven = sorted(path for path in (folder / "driven").glob("*") if path.is_dir())
    if not driven:
        raise UserError(f"{folder}: keeps no runs of its pilots (driven/); make the results again")
    found = Found()
    data, kept = folder / "data", folder / "config" / "courses"
    parts = [_read_dataset(data, data_source, kept)] if data.is_dir() else []
    parts += [
        _read_dataset(path, path.name if path.name != data_source else f"{path.name} pilot", kept)
        for path in driven
    ]
    for part in parts:
        for group, runs in part.groups.items():
            found.add(group, runs)
    found.course, found.size = parts[-1].course, parts[-1].size
    found.chosen = {f"{group}/{name}" for group, name in race.items()}
    return found


def _course(folder: Path, meta: DatasetMeta, kept: Path | None) -> Course | None:
    copy = None if kept is None or meta.copies else kept / f"{meta.course}.yaml"
    found = copy if copy is not None and copy.is_file() else course_file(folder, meta)
    return None if found is None else load_course(found)
