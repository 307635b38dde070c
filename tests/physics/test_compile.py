"""The cache of compiled code: an edit of any source of a compiled package gives another cache folder."""

from pathlib import Path

import pytest

from swamp_rl.physics import compile as module


@pytest.fixture
def nested(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A source in a sub-folder of a package that holds a compiled function, in a library of its own."""
    package = tmp_path / "swamp_rl" / "physics"
    (package / "deeper" / "still").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "step.py").write_text("@compiled\ndef step(): ...\n")
    (tmp_path / "envs").mkdir()
    source = package / "deeper" / "still" / "force.py"
    source.write_text("GAIN = 1.0\n")
    monkeypatch.setattr(module, "__file__", str(package / "compile.py"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return source


def test_an_edit_in_a_sub_package_of_a_compiled_package_gives_another_cache_folder(nested: Path) -> None:
    before = module.cache_folder.__wrapped__()
    assert module.cache_folder.__wrapped__() == before
    nested.write_text("GAIN = 2.0\n")
    assert module.cache_folder.__wrapped__() != before


def test_a_package_without_a_compiled_function_is_not_hashed(nested: Path) -> None:
    other = nested.parents[3] / "runs"
    other.mkdir()
    before = module.cache_folder.__wrapped__()
    for name in ("__init__.py", "table.py"):
        (other / name).write_text("ROWS = 3\n")
    assert module.cache_folder.__wrapped__() == before


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


def test_compiling_is_told_once_and_only_of_this_package_s_functions(monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[str] = []
    monkeypatch.setattr(module, "cache_folder", lambda: None)
    monkeypatch.setattr(module.LOG, "info", lambda line, kept: heard.append(line % kept))
    others, first, second = (module.compiled(f) for f in (lambda x: x + 1, lambda x: x + 1, lambda x: x + 1))
    for function in (first, second):
        function.py_func.__module__ = "swamp_rl.physics.step"
    monkeypatch.setattr(module._LISTENER, "told", False)
    others(1)
    assert heard == []
    assert first(1) == second(1) == 2
    assert len(heard) == 1 and "in every process: name a folder for it" in heard[0]
