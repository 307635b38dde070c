"""Compiled code: an edit of any source gives another cache folder, and no array is freed while it is used."""

import ast
import importlib
import os
import shutil
import stat
from pathlib import Path
from types import SimpleNamespace as Namespace
from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from swamp_rl.physics import compile as module

Array = NDArray[np.float64]


@pytest.fixture
def nested(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A module of constants that a compiled function imports, in a library of its own."""
    package = tmp_path / "swamp_rl" / "physics"
    source = package / "deeper" / "forces.py"
    source.parent.mkdir(parents=True)
    (tmp_path / "envs").mkdir()
    for folder in (package, source.parent):
        (folder / "__init__.py").write_text("")
    uses = (
        "from swamp_rl.physics.compile import compiled\nfrom swamp_rl.physics.deeper import (\n    forces,\n)"
    )
    (package / "step.py").write_text(f"{uses}\n\n\n@compiled\ndef step(): ...\n")
    source.write_text("GAIN = 1.0\n")
    monkeypatch.setattr(module, "__file__", str(package / "compile.py"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return source


@pytest.mark.parametrize("name", ["deeper/forces.py", "deeper/__init__.py", "step.py"])
def test_an_edit_of_a_compiled_source_or_one_it_imports_gives_another_cache_folder(
    nested: Path, name: str
) -> None:
    before = module.cache_folder.__wrapped__()
    assert module.cache_folder.__wrapped__() == before
    with (nested.parents[1] / name).open("a") as source:
        source.write("GAIN = 2.0\n")
    assert module.cache_folder.__wrapped__() != before


def test_a_source_that_no_compiled_one_imports_is_not_hashed(nested: Path) -> None:
    before = module.cache_folder.__wrapped__()
    for name in ("rows.py", "deeper/rows.py"):
        (nested.parents[1] / name).write_text("ROWS = 3\n")
    assert module.cache_folder.__wrapped__() == before


def test_the_same_sources_installed_elsewhere_find_what_a_checkout_has_compiled(
    nested: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path / "site" / "swamp_rl"
    kernel = "from swamp_rl.physics.compile import compiled\n\n\ndef one_more(x):\n    return x + 1.0\n"
    (tmp_path / "envs" / "kernel.py").write_text(kernel)
    shutil.copytree(tmp_path / "swamp_rl", elsewhere)
    shutil.copytree(tmp_path / "envs", elsewhere / "envs")
    found = []
    for library, envs in ((tmp_path / "swamp_rl", tmp_path / "envs"), (elsewhere, elsewhere / "envs")):
        names: dict[str, Any] = {"__name__": "swamp_rl.envs.kernel"}
        exec(compile(kernel.partition("\n")[2], str(envs / "kernel.py"), "exec"), names)
        with monkeypatch.context() as patch:
            patch.setattr(module, "__file__", str(library / "physics" / "compile.py"))
            patch.setattr(module, "cache_folder", module.cache_folder.__wrapped__)
            function = module.compiled(entry=True)(names["one_more"])
            assert function(1.0) == 2.0
            found.append((module.cache_folder(), sum(function.stats.cache_hits.values())))
    assert [hits for _, hits in found] == [0, 1]
    assert found[0][0] == found[1][0]


def test_every_constant_of_a_compiled_function_is_assigned_in_a_hashed_source() -> None:
    package = Path(module.__file__).parents[1]
    sources, missing = module.compiled_sources(), list[str]()
    assigned = {name for source in sources for name in assigned_in(source)}
    for source in sources:
        if b"@compiled" in source.read_bytes():
            inside = source.relative_to(package if source.is_relative_to(package) else package.parent)
            made = importlib.import_module(".".join(("swamp_rl", *inside.with_suffix("").parts)))
            functions = [one.py_func for one in vars(made).values() if hasattr(one, "py_func")]
            names = {name for function in functions for name in function.__code__.co_names}
            constants = {name for name in names if isinstance(vars(made).get(name), int | float | np.ndarray)}
            missing += [f"{made.__name__}: {name}" for name in constants - assigned]
    assert len(sources) > 1 and not missing


def assigned_in(source: Path) -> set[str]:
    """The names that a module assigns."""
    made = [one for one in ast.parse(source.read_bytes()).body if isinstance(one, ast.Assign | ast.AnnAssign)]
    return {one.id for each in made for one in ast.walk(each) if isinstance(one, ast.Name)}


def test_where_no_cache_can_be_written_functions_are_compiled_without_one(
    nested: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(nested))  # a file
    (Path(module.__file__).parent / "__pycache__").mkdir()
    monkeypatch.setattr(module.os, "access", lambda path, mode: False)
    monkeypatch.setattr(module, "cache_folder", module.cache_folder.__wrapped__)
    assert module.cache_folder() is None
    assert module.compiled(lambda x: x + 1)(1) == 2


def test_a_user_without_a_home_has_the_cache_that_is_named_or_none_elsewhere(
    nested: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(module.Path, "home", homeless)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "named"))
    assert module.cache_folder.__wrapped__().is_relative_to(tmp_path / "named")
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    assert module.cache_folder.__wrapped__() is None


def test_nobody_else_may_write_to_the_cache_whatever_the_umask(nested: Path) -> None:
    before = os.umask(0)
    try:
        folder = module.cache_folder.__wrapped__()
    finally:
        os.umask(before)
    assert [stat.S_IMODE(path.stat().st_mode) for path in (folder, folder.parent)] == [0o700, 0o700]


def test_the_cache_of_another_user_is_not_used(nested: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = module.cache_folder.__wrapped__()
    monkeypatch.setattr(module.os, "geteuid", lambda: theirs.stat().st_uid + 1)
    assert module.cache_folder.__wrapped__() != theirs


def test_functions_are_compiled_without_a_cache_on_a_full_disk(
    nested: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (Path(module.__file__).parent / "__pycache__").mkdir()
    monkeypatch.setattr(module.shutil, "disk_usage", lambda path: Namespace(free=4096))
    assert module.cache_folder.__wrapped__() is None


def test_compiling_is_reported_once_and_only_of_this_package_s_functions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard: list[str] = []
    monkeypatch.setattr(module, "cache_folder", lambda: None)
    monkeypatch.setattr(module.LOG, "info", lambda line, kept: heard.append(line % kept))
    others, first, second = (module.compiled(f) for f in (lambda x: x + 1, lambda x: x + 1, lambda x: x + 1))
    for function in (first, second):
        function.py_func.__module__ = "swamp_rl.physics.step"
    monkeypatch.setattr(module._LISTENER, "announced", False)
    others(1)
    assert heard == []
    assert first(1) == second(1) == 2
    assert len(heard) == 1 and "in every process: name a folder for it" in heard[0]


def _kept(given: Array, found: Array) -> Array:
    room = np.empty(given.shape[0])
    view = module.uncounted(room)
    for k in range(given.shape[0]):
        view[k] = given[k]
    other = np.full(given.shape[0], -1.0)  # in the place of `room`, if that were free
    for k in range(given.shape[0]):
        found[k] = view[k]
    module.still_used(room)
    return other


def test_an_array_that_is_still_used_is_not_freed_before() -> None:
    given, found = np.arange(50.0), np.zeros(50)
    numba.njit(_kept)(given, found)
    np.testing.assert_array_equal(found, given)


def _one_more(x: float) -> float:
    return x + 1.0


def test_python_may_call_what_only_compiled_functions_have_called_or_left_in_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "cache_folder", lambda: tmp_path)
    for loads in (0, 1):
        inner: Any = module.compiled(_one_more)
        assert _twice(inner)(1.0) == 4.0
        assert inner(1.0) == 2.0
        for function in (inner, inner.entry):
            assert sum(function.stats.cache_hits.values()) == loads


def _twice(inner: Any) -> Any:
    return numba.njit(lambda x: 2.0 * inner(x))


def test_what_takes_a_field_of_a_record_or_a_read_only_array_uncounted_is_compiled_once() -> None:
    total = numba.njit(lambda values: values[0] + values[1])
    uncounted = module.uncounted
    records, fixed = np.array([([1.0, 2.0],)], [("pair", float, (2,))]), np.array([10.0, 20.0])
    fixed.flags.writeable = False

    @numba.njit
    def of_all(records: Array, fixed: Array, other: Array) -> float:
        first = total(uncounted(records[0].pair)) + total(uncounted(fixed))
        return float(first + total(uncounted(other)))

    assert of_all(records, fixed, np.array([100.0, 200.0])) == 333.0
    assert len(total.signatures) == 1


def _freed_early(function: ast.FunctionDef) -> set[str]:
    """Names of a function's own arrays seen uncounted, which it neither returns nor mentions at its end."""
    calls = [node for node in ast.walk(function) if isinstance(node, ast.Call)]
    given: dict[str, set[str]] = {"uncounted": set(), "still_used": set()}
    for call in calls:
        if isinstance(call.func, ast.Name) and call.func.id in given:
            given[call.func.id] |= {node.id for node in ast.walk(call.args[0]) if isinstance(node, ast.Name)}
    back = {
        one.value.id
        for one in ast.walk(function)
        if isinstance(one, ast.Return) and isinstance(one.value, ast.Name)
    }
    return given["uncounted"] - {one.arg for one in function.args.args} - given["still_used"] - back


def test_every_array_of_a_functions_own_that_numba_does_not_count_is_still_used_at_its_end() -> None:
    package, uncounting = Path(module.__file__).parents[1], 0
    for source in package.rglob("*.py"):
        for node in ast.walk(ast.parse(source.read_text())):
            if isinstance(node, ast.FunctionDef) and "uncounted(" in ast.unparse(node):
                uncounting += 1
                assert not _freed_early(node), f"{source.name}: {node.name}"
    assert uncounting >= 4
