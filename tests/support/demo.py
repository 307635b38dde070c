"""Datasets to show, and the command line as a process."""

import os
import subprocess
from pathlib import Path

from swamp_rl.runs import Run, RunMeta, append_run, create_dataset
from tests.support.command_line import COMMAND
from tests.support.runs import circling, described


def dataset(folder: Path, source: str, names: list[str], **changes: object) -> Path:
    create_dataset(folder, described(source=source, **changes))
    for i, name in enumerate(names):
        append_run(folder, Run(name, circling(start=0.1 * i), RunMeta(outcome="success")))
    return folder


def started(*words: object, **environment: str) -> subprocess.Popen[str]:
    without = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.Popen(
        [COMMAND, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=without | environment,
    )
