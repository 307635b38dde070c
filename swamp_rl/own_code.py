"""Code of the user's own, named `module:attribute`.

Naming it imports its module, which runs its code. `own_code` is called for what the user named: an experiment
file of theirs, an argument. What is read from a stored pilot or a folder of results is only looked up, by
`refuse_unnamed`.
"""

import importlib
import os
import re
import sys
from collections.abc import Iterable
from typing import Any

from swamp_rl.errors import UserError

CODE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")

_modules: set[str] = set()


def is_code(name: Any) -> bool:
    """Whether a name is `module:attribute`."""
    return isinstance(name, str) and CODE.fullmatch(name) is not None


def own_code(name: str) -> Any:
    """The attribute that the user named as `module:attribute`; its module is imported.

    Modules are looked for in the working directory too, last. UserError where there is none.
    """
    module, _, attribute = name.partition(":")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    importlib.invalidate_caches()
    try:
        found = getattr(importlib.import_module(module), attribute)
    except (ImportError, TypeError, ValueError) as error:
        raise UserError(f"{name}: cannot be imported ({error}); put it on PYTHONPATH") from error
    except AttributeError as error:
        raise UserError(f"{name}: {error}; name what the module has") from error
    _modules.add(module)
    return found


def is_named(name: str) -> bool:
    """Whether the user has named anything of this module in this process."""
    return name.partition(":")[0] in _modules


def refuse_unnamed(names: Iterable[Any], what: str) -> None:
    """UserError for the first of `names` that is code which the user has not named; what: who wants it."""
    for name in names:
        if is_code(name) and not is_named(name):
            raise UserError(f"{what} {name}, which is code; if it is yours, name it: {name}=FOLDER")
