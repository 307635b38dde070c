"""The numerical options of the critic: one place, and nothing that decides beside it."""

import ast
from collections.abc import Iterator
from dataclasses import FrozenInstanceError, fields
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.likelihood.adequacy import Adequacy
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.model.candidates import candidates
from swamp_rl.criticism.options import Options, options, using
from tests.support.criticism import simulated_runs

ROOT = Path(__file__).parents[2]
CRITICISM = ROOT / "swamp_rl" / "criticism"
DECIDING = CRITICISM, ROOT / "swamp_rl" / "printed_figures"
# Every source that may read them.
USING = *DECIDING, ROOT / "experiments" / "config"
# Sentences and drawings, formats of files, and manoeuvres, which are no options.
ELSEWHERE = ("report", "options.py", "schema.py", "manoeuvres.py")
# Columns, counts of coordinates, stages and constants of probability.
CONSTANTS = {
    *("NORTH", "EAST", "HEADING", "SURGE", "SWAY", "YAW_RATE", "POSITIONS", "OTHERS", "LAGGING", "AXES"),
    *("FIRST_ACTUATOR", "STATES", "AXES_OF", "COMPONENTS", "QUANTITIES", "MIDDLE", "LAST", "CORRECTED"),
    *("ONE_RUN", "NONE", "NOWHERE", "NOTHING", "NO_ACCELERATION", "POWER", "NORMAL_OF_MAD", "OF_A_VARIANCE"),
    *("OF_TWO_GROWTHS", "THIRD", "POSES", "GAIN_OF_THIRD_DIFFERENCE", "SPREAD", "Z95", "CHI2_95", "TINY"),
    *("SIZE", "SECONDS", "WHITE"),
}
PLAIN = (0.0, 0.5, 1.0, 2.0, 100.0)  # arithmetic: halves, squares, percent
NEGLIGIBLE, HUGE = 1e-6, 1e30  # guards against a division by zero and steps of differences; overflow


def sources() -> list[Path]:
    """Every module whose numbers decide."""
    return [
        file
        for folder in DECIDING
        for file in sorted(folder.rglob("*.py"))
        if not set(file.relative_to(folder).parts) & set(ELSEWHERE)
    ]


def numbers(node: ast.AST) -> Iterator[ast.Constant]:
    """Literals of a part of a source."""
    for one in ast.walk(node):
        if isinstance(one, ast.Constant) and type(one.value) in (int, float):
            yield one


def constants(source: str) -> set[str]:
    """Names that a module gives numbers."""
    found = set()
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value and any(numbers(node.value)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = (one for target in targets for one in ast.walk(target))
            found |= {one.id for one in names if isinstance(one, ast.Name)}
    return found


def bare(source: str) -> list[float]:
    """Numbers with a decimal point inside functions that are neither arithmetic nor guards."""
    functions = [one for one in ast.walk(ast.parse(source)) if isinstance(one, ast.FunctionDef)]
    return [
        one.value
        for function in functions
        for one in numbers(function)
        if isinstance(one.value, float) and one.value not in PLAIN and NEGLIGIBLE < abs(one.value) < HUGE
    ]


@pytest.mark.parametrize("file", sources(), ids=lambda file: str(file.relative_to(ROOT / "swamp_rl")))
def test_no_number_that_decides_stands_outside_the_options(file: Path) -> None:
    source = file.read_text()
    advice = "make it a field of Options in swamp_rl/criticism/options.py"
    assert constants(source) <= CONSTANTS, advice
    assert bare(source) == [], advice


def test_a_bare_number_and_a_constant_of_a_module_are_seen() -> None:
    assert constants("A, B = 3, 'b'\nC: float = 1e-3\nD = 'd'\n") == {"A", "B", "C"}
    assert bare("def f(x, tail=0.025):\n    return x > 1.5 * 2.0 + 1e-12\n") == [0.025, 1.5]


def test_options_are_frozen_and_every_one_is_used() -> None:
    with pytest.raises(FrozenInstanceError):
        options().tail = 0.1  # type: ignore[misc]
    files = [file for folder in USING for file in folder.rglob("*.py") if file.name != "options.py"]
    text = "".join(file.read_text() for file in files)
    assert [field.name for field in fields(Options) if f".{field.name}" not in text] == []


def test_every_option_says_what_it_is() -> None:
    lines = (CRITICISM / "options.py").read_text().splitlines()
    for number, line in enumerate(lines):
        if line.startswith("    ") and line.split(":")[0].strip() in Options.__dataclass_fields__:
            assert "  # " in line or lines[number - 1].lstrip().startswith("# "), line


def test_a_changed_option_changes_the_behaviour_and_is_taken_back() -> None:
    runs = simulated_runs([])
    weight = weights(runs, noise_levels(runs))
    windows = Shooting(runs, weight, 10.0).windows
    residual = Adequacy(np.array([[4.0]]))
    groups = {"run": (0, 1, 2)}
    every = candidates(load_boat("swamp"), 40.0, groups)
    with using(pad=2.0, whiteness_limit=3.0, most_groups=1):
        assert Shooting(runs, weight, 10.0).windows.pad == 2 * windows.pad
        assert not residual.adequate
        assert not any(one.groups for one in candidates(load_boat("swamp"), 40.0, groups))
    assert options() == Options()
    assert residual.adequate
    assert any(one.groups for one in every)


def test_an_unknown_option_is_refused() -> None:
    with pytest.raises(TypeError, match="no_such"), using(no_such=1.0):
        pass
