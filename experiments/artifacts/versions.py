"""What a result was made with: versions of the code, of Python and of the libraries, and the machine."""

import os
import platform
import re
import subprocess
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from swamp_rl import __version__


def versions() -> dict[str, str | None]:
    """This project's version and commit, Python's, and each dependency's version."""
    return {
        "swamp_rl": __version__,
        "commit": _commit(),
        "python": platform.python_version(),
    } | {name: _version(name) for name in _dependencies()}


def hardware() -> dict[str, str | int | float | None]:
    """The machine: its system, processor, how many of those this process may use, and its memory [GB]."""
    try:
        memory = round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1)
    except (ValueError, OSError):
        memory = None
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "platform": platform.platform(),
        "processor": _processor(),
        "processors": usable,
        "memory_gb": memory,
    }


def _processor() -> str:
    """The processor's name, as Linux tells it; its kind elsewhere."""
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


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
    here = Path(__file__).parents[2]
    try:
        asked = ["git", "-C", str(here), "describe", "--always", "--abbrev=12", "--dirty=+", "--exclude=*"]
        found = subprocess.run(asked, capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return found.stdout.strip() or None
