"""The project's one way to compile a function, with a cache that notices edits in called functions.

numba's own cache looks only at the file of the function that was called, so an edit to a function that it
calls would go unnoticed. Here the cache folder's name holds a hash of every compiled source.
"""

import errno
import hashlib
import logging
import os
import re
import shutil
from collections.abc import Callable
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, TypeVar, cast, overload

import numba
import numba.extending
import numpy as np
from numba import config
from numba.core import cgutils, event
from numba.core.caching import UserProvidedCacheLocator
from numba.core.registry import CPUDispatcher

from swamp_rl.physics.code_cache import CodeCache

F = TypeVar("F", bound=Callable[..., object])

LOG = logging.getLogger(__name__)
"""Reports, once in a process, that machine code is missing in the cache and is being compiled."""

KEPT_CACHES = 4
ROOM = 2**26
"""Bytes that must be free where machine code is kept."""

# A division by zero is inf or nan, no exception; no wrapper for calls from C, a tenth of a compilation.
NUMERICS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}
INSIDE = NUMERICS | {"forceinline": True}
THREADED = NUMERICS | {"nogil": True}


USES_THE_CACHE = b"from swamp_rl.physics.compile import"
IMPORT = re.compile(rb"^ *from swamp_rl([.\w]*) import (\([^)]*\)|.*)", re.MULTILINE)


def compiled_sources() -> list[Path]:
    """Every source that compiles a function or uses the cache, and those that it imports from, in the order
    of their modules' names.

    A constant is compiled into the functions that name it, whether of their own module or imported.
    """
    library = Path(__file__).resolve().parents[1]
    envs = library / "envs" if (library / "envs").is_dir() else library.parent / "envs"
    texts = {source: source.read_bytes() for top in (library, envs) for source in top.rglob("*.py")}
    users = {source: text for source, text in texts.items() if USES_THE_CACHE in text}
    imported = {
        path.with_suffix(".py") if path.with_suffix(".py").is_file() else path / "__init__.py"
        for text in users.values()
        for module in _modules(text)
        for path in (library.joinpath(*module), envs.parent.joinpath(*module))
    }
    return sorted({*users, *(path for path in imported if path.is_file())}, key=_place)


def _place(source: Path) -> tuple[str, ...]:
    """Folders and name of a source of this package, the same in a checkout, where `envs` lies beside the
    package, and in an installed one; empty for any other source.
    """
    library = Path(__file__).resolve().parents[1]
    for top in (library, library.parent / "envs"):
        if source.is_relative_to(top):
            return (*(() if top == library else ("envs",)), *source.relative_to(top).parts)
    return ()


def _modules(text: bytes) -> set[tuple[str, ...]]:
    """Parts of the names of this package's modules that a source imports from, without the package's own;
    a name imported from one may be a module too.
    """
    return {
        (*module.decode().split(".")[1:], *more)
        for module, names in IMPORT.findall(text)
        for more in ((), *((name,) for name in re.findall(r"\w+", names.decode())))
    }


@lru_cache(maxsize=1)
def cache_folder() -> Path | None:
    """Folder of the machine code of exactly these sources; older ones beyond `KEPT_CACHES` are removed.

    Only its owner may write there, or read: numba unpickles what it finds and runs it. The package's own
    where the user has none that can be written or its disk is full, None where that cannot either.
    """
    digest = hashlib.sha256()
    for source in compiled_sources():
        digest.update(source.read_bytes())
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "swamp_rl"
        folder_of_sources = base / digest.hexdigest()[:16]
        folder_of_sources.mkdir(parents=True, exist_ok=True)
        for folder in (base, folder_of_sources):
            if folder.stat().st_uid != os.geteuid():
                raise PermissionError(f"{folder} belongs to another user")
            folder.chmod(0o700)
        os.utime(folder_of_sources)
        if shutil.disk_usage(base).free < ROOM:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        for old in sorted(base.iterdir(), key=lambda path: path.stat().st_mtime)[:-KEPT_CACHES]:
            shutil.rmtree(old, ignore_errors=True)
    except (OSError, RuntimeError):  # RuntimeError: a user without a home
        inside = Path(__file__).parent / "__pycache__"
        kept = os.access(inside, os.W_OK) and shutil.disk_usage(inside).free >= ROOM
        return inside if kept else None
    return folder_of_sources


@overload
def compiled(function: F) -> F: ...


@overload
def compiled(*, parallel: bool = False, threaded: bool = False, entry: bool = False) -> Callable[[F], F]: ...


def compiled(
    function: F | None = None, *, parallel: bool = False, threaded: bool = False, entry: bool = False
) -> F | Callable[[F], F]:
    """Compile with numba: IEEE arithmetic (no fast-math), so a batch gives the bits that one boat gives.

    parallel: its `prange` is divided among numba's threads; threaded: several threads of Python may run it at
    the same time; entry: Python calls it often, or for every boat. Python may call any other too, but that is
    0.2 us slower and compiles it once more.

    A function lands inside those that call it: a call costs more than what most of them compute, above all
    for counting who still uses the arrays that it takes.
    """
    if function is None:
        if not (parallel or threaded or entry):
            return compiled
        options = NUMERICS | {"parallel": True} if parallel else THREADED if threaded else INSIDE
        return lambda decorated: cast(F, _entry(decorated, **options))
    return cast(F, _kept(_Inside(function, {}, INSIDE | {"nopython": True, "no_cpython_wrapper": True}), ""))


class _ByPlace(UserProvidedCacheLocator):
    """Where numba keeps a function: by its module's place in this package, so that the same sources in
    another folder are not compiled again.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """The folder of a source within the cache."""
        place = _place(Path(py_file).resolve())
        return os.path.join("own", *place[:-1]) if place else super().get_suitable_cache_subpath(py_file)


class _Inside(CPUDispatcher):
    """A function as other compiled ones call it; Python calls another one, compiled when it first does.

    The entry from Python takes a fifth of a compilation, and most functions never need one.
    """

    def __call__(self, *given: Any, **named: Any) -> Any:
        return self.entry(*given, **named)

    @cached_property
    def entry(self) -> Any:
        """The function as Python calls it."""
        return _entry(self.py_func, **INSIDE)


def _entry(function: Any, **options: Any) -> Any:
    """A function that Python may call."""
    return _kept(numba.njit(**options)(function), "entries")


def _kept(function: Any, part: str) -> Any:
    """The function, its machine code kept in that part of the cache: numba takes both kinds for the same."""
    if (folder := cache_folder()) is None:
        return function
    before = config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES
    config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES = str(folder / part), f"{__name__}.{_ByPlace.__name__}"
    try:
        function._cache = CodeCache(function.py_func)
    finally:
        config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES = before
    return function


class _FirstCompilation(event.Listener):
    """Hears of every function that numba compiles; one that it finds in a cache is not compiled."""

    announced = False

    def on_start(self, event: Any) -> None:
        """Tell `LOG` of the first function of this package."""
        own = event.data["dispatcher"].py_func.__module__.partition(".")[0] == __name__.partition(".")[0]
        if own and not self.announced:
            self.announced = True
            kept = "once" if cache_folder() else "in every process: name a folder for it in XDG_CACHE_HOME"
            LOG.info("compiling the simulator for this processor and boat: up to half a minute, %s", kept)

    def on_end(self, event: Any) -> None:
        """Do nothing."""


_LISTENER = _FirstCompilation()
event.register("numba:compile", _LISTENER)


@numba.extending.intrinsic
def uncounted(typing: Any, array: Any) -> Any:
    """The same array within a compiled function, whose users numba does not count.

    The caller's own name keeps an argument alive meanwhile; an array made in the function itself is freed
    after the last mention of its name, which must be `still_used`, behind all uses of the view. Counting,
    atomic and at each inlined call that takes the array, costs a fifth of a boat's step. A field of a record
    and an array that may not be written have the type of any other array here: what takes the view is
    compiled once for all of them.
    """
    plain = numba.types.Array(array.dtype, array.ndim, array.layout, aligned=array.aligned)

    def view(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        seen = context.make_array(plain)(context, builder, given[0])
        seen.meminfo = cgutils.get_null_value(seen.meminfo.type)
        seen.parent = cgutils.get_null_value(seen.parent.type)
        return seen._getvalue()

    return plain(array), view


@numba.extending.intrinsic
def still_used(typing: Any, array: Any) -> Any:
    """Nothing; an array that is named here is not freed before."""

    def nothing(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return context.get_dummy_value()

    return numba.types.none(array), nothing


def by_field(field: str, present: F, absent: F) -> F:
    """One of two functions: `present` where the first record given has the field, else `absent`.

    The choice falls when a caller is compiled, so the other one costs nothing.
    """

    def chosen(*given: Any) -> Any:
        record = next(item for item in given if isinstance(item, np.void))
        return (present if field in (record.dtype.names or ()) else absent)(*given)

    # Not strict: numba would want one spelling of the arguments, and a wrapper for it costs time.
    @numba.extending.overload(chosen, strict=False, jit_options=INSIDE)
    def choose(*given: Any) -> Any:
        record = next(item for item in given if isinstance(item, numba.types.Record))
        return (present if field in record.fields else absent).py_func  # type: ignore[attr-defined]

    return cast(F, chosen)
