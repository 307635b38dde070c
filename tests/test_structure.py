"""Modules import only from their own floor or from below, and never in a circle.

Imports at the top of a module, inside functions and for type checking count alike.
"""

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FLOORS = (
    {
        "angles",
        "errors",
        "clipped",
        "config_kind",
        "counted",
        "constants",
        "digits",
        "explain",
        "extras",
        "json_text",
        "names",
        "ordinary",
        "yaml_text",
        "figure_style",
        "html_page",
        "one_thread",
        "own_code",
        "seal",
        "sums",
        "units",
        "whole_number",
        "workers",
    },
    {"files", "arrays_file", "replacement", "sqlite_file", "tensors_file", "unfinished"},
    {"physics", "boat", "effects", "course"},
    {"runs", "simulator"},
    {"boat_numbers", "doctor", "logs"},
    {"allocation", "energy", "guidance", "link", "navigation", "manoeuvres", "identification", "pilots"},
    {"link"},
    {"criticism", "design", "evaluation", "export"},
    {"boat_fit", "monitor", "printed_figures"},
    {"teleop", "demo", "api"},
    {"envs"},
    {"experiments.config"},
    {"experiments.artifacts", "experiments.synthetic"},
    {"experiments.training", "experiments.evaluation"},
    {"experiments.reports"},
    {"experiments.studies"},
    {"experiments.sweep"},
    {"experiments.fleet"},
    {"experiments.cli"},
    {"__main__"},
)
CRITICISM = (
    {"result", "progress", "options", "threads"},
    {"model"},
    {"data"},
    {"likelihood"},
    {"nuisance"},
    {"selection"},
    {"inference"},
    {"report"},
    {"diagnose"},
)
FLOOR = {package: number for number, packages in enumerate(FLOORS) for package in packages}
NOT_OF_THE_LIBRARY = FLOOR["envs"]


def modules() -> dict[str, Path]:
    """Every module by the name that it is imported by."""
    found = {}
    for folder, name in (
        ("swamp_rl",) * 2,
        ("envs", "swamp_rl.envs"),
        ("experiments", "swamp_rl.experiments"),
    ):
        for file in sorted((ROOT / folder).rglob("*.py")):
            parts = [name, *file.relative_to(ROOT / folder).with_suffix("").parts]
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


def imported(source: str, known: dict[str, Path]) -> Iterator[str]:
    """The modules of `known` that a source imports anywhere."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            for alias in node.names:
                inside = f"{node.module}.{alias.name}"
                if inside in known:
                    yield inside
                elif node.module in known:
                    yield str(node.module)


def package_of(module: str) -> str:
    """`boat` of `swamp_rl.boat.load`, `experiments.cli` of `swamp_rl.experiments.cli.app`."""
    parts = module.split(".")[1:]
    return ".".join(parts[: 2 if parts[:1] == ["experiments"] else 1])


MODULES = modules()


@cache
def graph() -> dict[str, set[str]]:
    """The modules that each module imports."""
    return {name: set(imported(file.read_text(), MODULES)) - {name} for name, file in MODULES.items()}


@cache
def packages() -> dict[str, set[str]]:
    """The packages that each package imports."""
    found: dict[str, set[str]] = {}
    for name, others in graph().items():
        found.setdefault(package_of(name), set()).update(package_of(other) for other in others)
    return found


def test_every_package_has_a_floor() -> None:
    assert set(packages()) - {"", "experiments"} == set(FLOOR)


@pytest.mark.parametrize("of", ["modules", "packages"])
def test_nothing_is_imported_in_a_circle(of: str) -> None:
    without_itself = {name: others - {name} for name, others in packages().items()}
    try:
        TopologicalSorter(graph() if of == "modules" else without_itself).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))


def test_no_module_imports_from_a_floor_above_its_own() -> None:
    upward = [
        f"{name} imports {other}"
        for name, others in graph().items()
        for other in others
        if package_of(name) in FLOOR and FLOOR.get(package_of(other), 0) > FLOOR[package_of(name)]
    ]
    assert upward == []


def test_the_parts_of_criticism_import_from_their_own_floor_or_from_below() -> None:
    floor = {part: number for number, parts in enumerate(CRITICISM) for part in parts}
    inside = {
        name: {other for other in others if other.startswith("swamp_rl.criticism.")}
        for name, others in graph().items()
        if name.startswith("swamp_rl.criticism.")
    }
    assert {name.split(".")[2] for name in inside} == set(floor)
    upward = [
        f"{name} imports {other}"
        for name, others in inside.items()
        for other in others
        if floor[other.split(".")[2]] > floor[name.split(".")[2]]
    ]
    assert upward == []


def test_the_library_imports_neither_environments_nor_experiments() -> None:
    library = {package for package, floor in FLOOR.items() if floor < NOT_OF_THE_LIBRARY}
    above = set(FLOOR) - library
    assert all(not packages()[package] & above for package in library)


def test_a_circle_and_an_import_inside_a_function_are_seen() -> None:
    known = {"swamp_rl.a": Path(), "swamp_rl.b": Path()}
    source = "def f():\n    from swamp_rl.b import g\n"
    assert list(imported(source, known)) == ["swamp_rl.b"]
    with pytest.raises(CycleError):
        TopologicalSorter({"a": {"b"}, "b": {"a"}}).prepare()


def test_no_test_is_imported_and_tests_and_benchmarks_leave_each_other_alone() -> None:
    for here, other in (("tests", "benchmarks"), ("benchmarks", "tests")):
        for file in (ROOT / here).rglob("*.py"):
            for node in ast.walk(ast.parse(file.read_text())):
                names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                names += [str(node.module)] if isinstance(node, ast.ImportFrom) else []
                for name in names:
                    assert name.split(".")[0] != other, f"{file} imports {name}"
                    assert ".test_" not in name, f"{file} imports {name}"


def test_no_source_is_longer_than_400_lines() -> None:
    folders = ("swamp_rl", "envs", "experiments", "benchmarks", "tests", "docs", "examples")
    long = {
        str(file): lines
        for folder in folders
        for file in (ROOT / folder).rglob("*.py")
        if (lines := len(file.read_text().splitlines())) > 400
    }
    assert long == {}
