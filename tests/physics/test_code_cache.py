"""Machine code on the disk: of the types that it was compiled for, whoever else compiles, and whole."""

import multiprocessing
import os
import time
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

from swamp_rl.physics import compile as module


def halved(x: Any) -> Any:
    return x // 2 if x > 1 else x


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(module, "cache_folder", lambda: tmp_path)
    return tmp_path


def _compile(x: float, both: Any = None, waits: tuple[float, ...] = ()) -> None:
    """Compile `halved` for the type of x; each file is in its place after the next of the waits [s], counted
    from the time when both processes have compiled."""
    given, replace = iter(waits), os.replace

    def later(*paths: Any) -> None:
        nonlocal both
        if both is not None:
            both.wait(60.0)
        both = None
        time.sleep(next(given, 0.0))
        replace(*paths)

    with patch.object(os, "replace", later):
        module.compiled(entry=True)(halved)(x)


def hits(function: Any) -> int:
    return sum(function.stats.cache_hits.values())


def test_two_processes_that_compile_for_two_types_at_once_keep_the_code_of_each() -> None:
    fork = multiprocessing.get_context("fork")
    both = fork.Barrier(2)
    others = [fork.Process(target=_compile, args=(7, both, (0.0, 0.6)))]
    others += [fork.Process(target=_compile, args=(7.5, both, (0.3, 0.0)))]
    for other in others:
        other.start()
    for other in others:
        other.join()
    function: Any = module.compiled(entry=True)(halved)
    assert (function(7.5), function(7)) == (3.0, 3)
    assert isinstance(function(7.5), float) and isinstance(function(7), int)
    assert hits(function) == 2


@pytest.mark.parametrize("left", [0, 20, 2000])
def test_code_that_was_cut_off_is_compiled_again(folder: Path, left: int) -> None:
    _compile(7)
    files = [path for path in folder.rglob("*") if path.is_file()]
    for path in files:
        os.truncate(path, left)
    for loads in (0, 1):
        function: Any = module.compiled(entry=True)(halved)
        assert function(7) == 3
        assert hits(function) == loads


def test_a_function_works_where_its_code_cannot_be_kept(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    function: Any = module.compiled(entry=True)(halved)

    def full(*paths: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert function(7) == 3
    assert not [path for path in folder.rglob("*") if path.is_file()]
