"""What a result was made with: versions of the code, of Python and of the libraries."""

import os
import platform
import re
import subprocess
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from swamp_rl import __version__


def versions() -> dict[str, str | int | None]:
    """This project's version and commit, Python's, the machine's kind and each dependency's version."""
    return {
        "swamp_rl": __version__,
        "commit": _commit(),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processors": os.cpu_count(),
    } | {name: _version(name) for name in _dependencies()}


def _dependencies() -> list[str]:
    try:
        wanted = requires("swamp-rl") or []
    except PackageNotFoundError:
        return ["numpy", "torch", "stable-baselines3", "gymnasium", "numba"]
    return sorted(re.split(r"[^\w.-]", line)[0] for line in wanted if "extra ==" not in line)


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _commit() -> str | None:
    """The checkout's commit, with a plus sign if tracked files differ from it; None outside a checkout."""
    here = Path(__file__).parents[1]
    try:
        asked = ["git", "-C", str(here), "describe", "--always", "--abbrev=12", "--dirty=+", "--exclude=*"]
        found = subprocess.run(asked, capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return found.stdout.strip() or None
