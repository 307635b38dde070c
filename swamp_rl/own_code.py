"""Code of the user's own, named `module:attribute`.

Naming it imports its module, which runs its code. `own_code` is called for what the user named: an experiment
file of theirs, an argument. What is read from a stored pilot or a folder of results is only looked up, by
`refuse_unnamed`.
"""

import hashlib
import importlib
import importlib.util
import os
import re
import sys
import traceback
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any

from swamp_rl.errors import UserError
from swamp_rl.explain import nearest

CODE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")

MOST_NAMED = 20

_modules: set[str] = set()


def is_code(name: Any) -> bool:
    """Whether a name is `module:attribute`."""
    return isinstance(name, str) and CODE.fullmatch(name) is not None


def own_code(name: str) -> Any:
    """As `imported`, of the user's own: errors that arise in the module from now on are theirs."""
    found = imported(name)
    _modules.add(name.partition(":")[0])
    return found


def imported(name: str) -> Any:
    """The attribute `module:attribute`; its module is imported.

    Modules are looked for in the working directory too, last. UserError where there is none, and for what
    goes wrong in it.
    """
    module, _, attribute = name.partition(":")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    importlib.invalidate_caches()
    try:
        made = importlib.import_module(module)
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and f"{module}.".startswith(f"{error.name}."):
            raise UserError(
                f"{name}: cannot be imported, no module {error.name!r}; put it on PYTHONPATH"
            ) from error
        raise UserError(f"{name}: {_message(error, _files_of(module))}") from error
    if not hasattr(made, attribute):
        own = [known for known in vars(made) if not known.startswith("_")]
        raise UserError(f"{name}: the module has no {attribute!r}{nearest(attribute, own[:MOST_NAMED])}")
    return getattr(made, attribute)


def fault_in_own_code(error: BaseException) -> str | None:
    """Where in code that the user named an exception arose and what it says; None if it arose elsewhere."""
    files = {file for module in _modules for file in _files_of(module)}
    return _message(error, files) if _place(error, files) else None


def is_user_fault(error: Exception) -> bool:
    """Whether an error is a UserError or arose in code that the user named: no fault of this package's."""
    return isinstance(error, UserError) or fault_in_own_code(error) is not None


def _message(error: BaseException, files: Collection[str]) -> str:
    place = _place(error, files)
    says = error.msg if isinstance(error, SyntaxError) else str(error)
    return f"{place + ': ' if place else ''}{type(error).__name__}: {' '.join(says.split())}; correct it"


def _place(error: BaseException, files: Collection[str]) -> str | None:
    """File and line of the last call of a traceback that is in one of `files`."""
    calls = [(call.filename, call.lineno) for call in traceback.extract_tb(error.__traceback__)]
    if isinstance(error, SyntaxError) and error.filename is not None:
        calls.append((error.filename, error.lineno))
    found = [call for call in calls if call[0] in files]
    return f"{os.path.relpath(found[-1][0])}, line {found[-1][1]}" if found else None


def _files_of(module: str) -> list[str]:
    """The file of a module, imported or not."""
    loaded = sys.modules.get(module)
    if loaded is not None:
        return [file] if (file := getattr(loaded, "__file__", None)) else []
    try:
        spec = importlib.util.find_spec(module)
    except Exception:  # of a package around it, which is run
        return []
    return [spec.origin] if spec is not None and spec.origin else []


def source_digests(names: Iterable[Any]) -> dict[str, str]:
    """SHA-256 of the file of each module in which those of `names` that are code lie, by the module's name.

    A module that it imports in turn is not looked at.
    """
    modules = sorted({name.partition(":")[0] for name in names if is_code(name)})
    found = {module: file for module in modules for file in _files_of(module)}
    return {module: hashlib.sha256(Path(file).read_bytes()).hexdigest() for module, file in found.items()}


def is_named(name: str) -> bool:
    """Whether the user has named anything of this module in this process."""
    return name.partition(":")[0] in _modules


def refuse_unnamed(names: Iterable[Any], what: str, holder: str = "FOLDER") -> None:
    """UserError for the first of `names` that is code which the user has not named; what: who wants it;
    holder: how an argument names what holds the pilot."""
    for name in names:
        if is_code(name) and not is_named(name):
            raise UserError(f"{what} {name}, which is code; if it is yours, name it: {name}={holder}")
