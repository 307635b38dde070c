"""Results folders read again: which pilots they hold, and which of those are trainings of one kind."""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.evaluation import Table, read_episodes
from swamp_rl.files import read_yaml
from swamp_rl.json_text import read_json
from swamp_rl.names import YAML, file_in, refuse_odd_label

if TYPE_CHECKING:
    from swamp_rl.experiments.config.learners import Learner

EPISODES = "episodes.parquet"
DOINGS = ("success", "time", "command_change")
"""Columns by which the doings of a pilot in an episode are distinguished."""
FILES = {"boat": "boats", "course": "courses"}
LIMITS = ("time_limit", "bounds", "depth")
"""Keys of an experiment that replace those of its course."""
STORED = {"stored": "folder", "onnx": "file", "sb3": "file"}
"""Kinds that are read from a file, and the option that says where it is."""


@dataclass(frozen=True)
class Result:
    """A folder of results: its experiment as it was run, its episodes by pilot and level, its own account."""

    folder: Path
    experiment: Mapping[str, Any]
    tables: Mapping[tuple[str, str], Table]
    results: Mapping[str, Any]
    "`results.json`, empty where there is none"
    versions: Mapping[str, Any]
    "`versions.json`, likewise"
    origins: Mapping[str, tuple[str, "Result"]] = field(default_factory=dict)
    "By name of a stored pilot: its name and result where it was trained, if that is compared too."

    @property
    def pilots(self) -> list[str]:
        """Names of the pilots, in their order."""
        return list(dict.fromkeys(pilot for pilot, _ in self.tables))

    @property
    def levels(self) -> list[str]:
        """Names of the levels, in their order."""
        return list(dict.fromkeys(level for _, level in self.tables))

    def setting(self) -> dict[str, str]:
        """What pilots must share to be compared: boat, course, its limits, step, hidden effects and levels,
        as marks."""
        kept = self.folder / "config"
        marks = {
            what: _mark([read_yaml(file) for file in sorted((kept / files).glob("*.yaml"))])
            for what, files in FILES.items()
        }
        folder = kept / "disturbances"
        levels = {level: file_in(folder, f"{level}.yaml", YAML) for level in self.levels}
        marks |= {f"level {name}": _mark(read_yaml(f)) for name, f in levels.items() if f.is_file()}
        return marks | {key: _mark(self.experiment.get(key) or None) for key in ("step", "hidden", *LIMITS)}


@dataclass(frozen=True)
class Entrant:
    """One training method: its name, and for each of its training seeds the pilot and its result."""

    label: str
    pilot: str
    trained: tuple[tuple[str, Result], ...]
    members: tuple[tuple[str, Result], ...]
    "As `trained`, with those that are a pilot of an earlier result."

    @property
    def results(self) -> tuple[Result, ...]:
        """The result of each training seed."""
        return tuple(result for _, result in self.trained)

    def tables(self, level: str) -> list[Table]:
        """Its episodes at a level, one table for each training seed."""
        return [result.tables[pilot, level] for pilot, result in self.trained]


def find_results(paths: Iterable[Path]) -> list[Path]:
    """The folders at or below `paths` that hold episodes; UserError for a path with none, and where a folder
    below has a name on which a table or a terminal would act, as reports and messages name it.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            lacks = "is a file" if path.exists() else "no such folder"
            raise UserError(f"{path}: {lacks}; name a folder of results")
        below = [file.parent for file in sorted(path.rglob(EPISODES)) if not _hidden(file, path)]
        if not below:
            raise UserError(f"{path}: no {EPISODES} in it or below; name a folder that `run` has written")
        for part in {part for folder in below for part in folder.relative_to(path).parts}:
            refuse_odd_label(path, part, "folder of results", "rename it")
        found += below
    return list({folder.resolve(): folder for folder in found}.values())


def _hidden(file: Path, below: Path) -> bool:
    return any(part.startswith(".") for part in file.relative_to(below).parts)


def read_result(folder: Path) -> Result:
    """A folder of results; UserError where the experiment or the episodes are missing or broken."""
    experiment = _experiment(folder / "config" / "experiment.yaml")
    tables = read_episodes(folder / EPISODES)
    results, versions = (_json(folder / name) for name in ("results.json", "versions.json"))
    return Result(folder, experiment, tables, results, versions)


def _experiment(path: Path) -> dict[str, Any]:
    """What the file holds; UserError where its pilots are no plans."""
    found = read_yaml(path)
    plans = found.get("pilots", {})
    whole = isinstance(plans, dict) and all(
        isinstance(plan, dict) and isinstance(plan.get("options", {}), dict) for plan in plans.values()
    )
    if not whole:
        raise UserError(f"{path}: pilots: holds no plans of pilots; run the experiment again")
    return found


def entrants(results: Sequence[Result]) -> list[Entrant]:
    """The pilots of all results; those that differ in nothing but seeds are seeds of one entrant, those of
    one result under the name of `_methods`.

    A pilot of the same seeds in several results, copied or evaluated again, is one, with the episodes of all;
    so is one that its seeds do not touch. UserError where the same seeds did different things in an episode.
    """
    results = _traced(results)
    groups: dict[tuple[str, str], list[tuple[str, Result]]] = {}
    for result in results:
        for pilot, method in _methods(result).items():
            key = method, _mark(seedless(plan_of(result, pilot)))
            groups.setdefault(key, []).append((pilot, result))
    made = []
    for (method, _), members in groups.items():
        shared = sum(other == method for other, _ in groups) > 1
        label = f"{method} ({members[0][1].folder.resolve().name})" if shared else method
        made.append(Entrant(label, method, _different(members), tuple(members)))
    labels = [one.label for one in made]
    return [
        replace(one, label=f"{one.pilot} ({one.results[0].folder})") if labels.count(one.label) > 1 else one
        for one in made
    ]


def _traced(results: Sequence[Result]) -> list[Result]:
    """With the origins of stored pilots, by the SHA-256 that both results give."""
    trained: dict[str, tuple[str, Result]] = {}
    for result in results:
        measured = _mapping(result.results.get("pilots"))
        for name, plan in result.experiment.get("pilots", {}).items():
            sha = _mapping(measured.get(name)).get("sha256")
            if isinstance(sha, str) and _kind(plan) not in STORED:
                trained.setdefault(sha, (name, result))

    def origins(result: Result) -> dict[str, tuple[str, Result]]:
        plans = result.experiment.get("pilots", {})
        stored = {
            n: plan.get("options", {}).get("sha256") for n, plan in plans.items() if _kind(plan) == "stored"
        }
        return {name: trained[sha] for name, sha in stored.items() if isinstance(sha, str) and sha in trained}

    return [replace(result, origins=origins(result)) for result in results]


def _mapping(data: Any) -> Mapping[str, Any]:
    """What should be a mapping, as a folder may hold anything; an empty one for anything else."""
    return data if isinstance(data, Mapping) else {}


def _kind(plan: Mapping[str, Any]) -> str:
    return str(plan.get("kind"))


def _methods(result: Result) -> dict[str, str]:
    """The name of its training method by pilot: its own, or, where several differ in seeds only, what their
    names begin with, or the first name where that is another's."""
    alike: dict[str, list[str]] = {}
    for pilot in result.pilots:
        alike.setdefault(_mark(seedless(plan_of(result, pilot))), []).append(pilot)
    groups: list[list[str]] = []
    for names in alike.values():
        trained = {_mark(plan_of(result, name)) for name in names}
        groups += [names] if len(trained) == len(names) else [[name] for name in names]
    stems = [_stem(names) if len(names) > 1 else names[0] for names in groups]
    found: dict[str, str] = {}
    for stem, names in zip(stems, groups, strict=True):
        own = stem and stems.count(stem) == 1 and (stem in names or stem not in result.pilots)
        found |= dict.fromkeys(names, stem if own else names[0])
    return {pilot: found[pilot] for pilot in result.pilots}


def _stem(names: Sequence[str]) -> str:
    """What all names begin with, without the digits and marks at its end."""
    same = takewhile(lambda letters: len(set(letters)) == 1, zip(*names, strict=False))
    return "".join(letters[0] for letters in same).rstrip("0123456789-_. ")


def _different(members: Sequence[tuple[str, Result]]) -> tuple[tuple[str, Result], ...]:
    trained: dict[str, tuple[str, Result]] = {}
    for pilot, result in members:
        plan = _mark(plan_of(result, pilot))
        trained[plan] = _joined(*trained[plan], pilot, result) if plan in trained else (pilot, result)
    kept: dict[str, tuple[str, Result]] = {}
    for one in trained.values():
        kept.setdefault(_did(*one), one)
    return tuple(kept.values())


def _joined(name: str, first: Result, pilot: str, other: Result) -> tuple[str, Result]:
    """The first pilot and result, with the episodes that the same pilot drove in the other one only.

    UserError where it did otherwise in an episode that both have.
    """
    tables = dict(first.tables)
    for level in other.levels:
        more, own = other.tables.get((pilot, level)), tables.get((name, level))
        if more is None or own is None:
            tables |= {} if more is None else {(name, level): more}
            continue
        _, ours, theirs = np.intersect1d(own["seed"], more["seed"], return_indices=True)
        if any(own[one][ours].tobytes() != more[one][theirs].tobytes() for one in DOINGS):
            raise UserError(
                f"{other.folder}: {pilot} did otherwise than in {first.folder} in the same episodes, though "
                "trained alike from the same seeds; other versions made them, name one of the two"
            )
        new = np.setdiff1d(np.arange(len(more["seed"])), theirs)
        tables[name, level] = {
            column: np.concatenate([own[column], more[column][new]]) for column in own if column in more
        }
    return name, replace(first, tables=tables)


def _did(pilot: str, result: Result) -> str:
    """A mark of all that a pilot did in its episodes, by their seeds."""
    sha = hashlib.sha256()
    for level in sorted(result.levels):
        table = result.tables.get((pilot, level))
        if table is not None:
            order = np.argsort(table["seed"], kind="stable")
            sha.update(level.encode())
            for name in ("seed", *DOINGS):
                sha.update(np.ascontiguousarray(table[name][order]).tobytes())
    return sha.hexdigest()


def plan_of(result: Result, pilot: str) -> dict[str, Any]:
    """All that went into a pilot's training: its plan and those of pilots it starts from; the data, where
    one of them learned from runs; the reward, where one learned in the simulator."""
    if pilot in result.origins:
        name, trained = result.origins[pilot]
        return plan_of(trained, name)
    experiment = result.experiment
    plans = experiment.get("pilots", {})
    name = pilot if pilot in plans else pilot.rsplit(", ", 1)[0]
    if name not in plans:
        return {"plans": plans, "data": experiment.get("data")}
    used = [name]
    for one in used:
        options = plans[one].get("options", {}).values()
        used += [other for other in plans if other in options and other not in used]
    made: dict[str, Any] = {"plans": [_without_place(plans[one]) for one in used]}
    learners = [_learner(plans[one]) for one in used]
    if any(one is None or one.from_runs for one in learners):
        made["data"] = experiment.get("data")
    if any(one is None or one.by_trying for one in learners):
        made["reward"] = {
            term: weight for term, weight in _mapping(experiment.get("reward")).items() if weight
        }
    return made


def _learner(plan: Mapping[str, Any]) -> "Learner | None":
    """The learner of a plan's kind; None for a class of one's own, which may learn from anything."""
    from swamp_rl.experiments.config.learners import LEARNERS

    kind = "stored" if _kind(plan) in STORED else _kind(plan)
    return LEARNERS[kind]() if kind in LEARNERS else None


def _without_place(plan: Mapping[str, Any]) -> Mapping[str, Any]:
    """A stored pilot's plan names the file by its SHA-256 alone, wherever it lies."""
    place = STORED.get(_kind(plan))
    options = plan.get("options", {})
    if place is None or "sha256" not in options:
        return plan
    return {**plan, "options": {key: value for key, value in options.items() if key != place}}


def seedless(data: Any) -> Any:
    """Without the keys `seed`, at any depth."""
    if isinstance(data, Mapping):
        return {key: seedless(value) for key, value in data.items() if key != "seed"}
    return [seedless(value) for value in data] if isinstance(data, list) else data


def refuse_other_settings(results: Sequence[Result]) -> None:
    """UserError for the first result whose `setting` differs from that of the first."""
    first = results[0]
    marks = first.setting()
    for result in results[1:]:
        theirs = result.setting()
        for what in sorted(marks.keys() & theirs.keys()):
            if marks[what] != theirs[what]:
                raise UserError(
                    f"{result.folder}: another {what} than in {first.folder}; only results of the same boat, "
                    "course and its limits, levels and step compare"
                )


def _mark(data: Any) -> str:
    return hashlib.sha256(json.dumps(_by_text(data), sort_keys=True, default=str).encode()).hexdigest()


def _by_text(data: Any) -> Any:
    """With every key as a text, so that keys of any kinds can be sorted."""
    if isinstance(data, Mapping):
        return {str(key): _by_text(value) for key, value in data.items()}
    return [_by_text(value) for value in data] if isinstance(data, list) else data


def _json(path: Path) -> dict[str, Any]:
    return read_json(path, "run the experiment again") if path.is_file() else {}
