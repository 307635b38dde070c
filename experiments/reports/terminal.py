"""What a job prints at its end, and the JSON that it writes."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.claims import print_claims
from swamp_rl.experiments.reports.experiment import rate, targets_reached

from swamp_rl.files import write_text


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Strict JSON, beside first and then renamed: what has no value is null, never NaN."""
    text = json.dumps(data, indent=2, allow_nan=False, default=_plain) + "\n"
    write_text(path, text)


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} does not go into JSON")


def print_results(results: Mapping[str, Any], folder: Path) -> None:
    """The table that ends the job: success by pilot and level, the targets missed, where everything lies."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    if "claims" in results:
        print_claims(results, folder)
        return
    levels = results["evaluation"]["levels"]
    episodes = results["evaluation"]["episodes"]
    title = f"{results['name']}: success in {episodes} episodes, percent"
    table = Table(title=title, box=SIMPLE_HEAD, collapse_padding=True)
    table.add_column("pilot", overflow="fold")
    for level in levels:
        table.add_column(level, justify="right", no_wrap=True)
    for name, pilot in results["pilots"].items():
        table.add_row(name, *(rate(pilot["levels"][level]) for level in levels))
    console = Console(markup=False, soft_wrap=True)  # a path stays on its line
    console.print(table, soft_wrap=False)
    console.print(targets_reached(results["targets"]))
    for target in (one for one in results["targets"] if not one["reached"]):
        console.print(f"  not: {target['what']} of {target['pilot']}, {target['level']}")
    measured = results["measured"]
    console.print(
        f"{measured['total_seconds']:.0f} s, {measured['peak_memory_gb']:.1f} GB: see {folder}/report.md"
    )
