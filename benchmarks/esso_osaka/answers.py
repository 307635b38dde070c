"""What `swamp-rl diagnose DATASET --ignore wind --out FOLDER` wrote of the pond, beside the anemometer.

    python -m benchmarks.esso_osaka.answers DATASET FOLDER [DATASET FOLDER ...]

writes a table into docs/esso_osaka.md. The datasets are the runs as `swamp-rl runs import` wrote them.
"""

import math
import sys
from pathlib import Path

from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.diagnosis import measured_wind, named_causes, sets_of
from benchmarks.esso_osaka.wind import HORIZON, apart
from benchmarks.markers import DOCS, write_parts
from swamp_rl.constants import Z95
from swamp_rl.criticism.report.words import readable
from swamp_rl.criticism.result import Cause, Diagnosis, Estimate
from swamp_rl.runs import Run, inspect_dataset

HEAD = [
    "dataset, result",
    "verdict",
    "causes, by rank",
    "not in the extended file",
    "wind intervals with the truth",
]


def held(estimates: dict[str, Estimate], runs: list[Run]) -> list[bool]:
    """Whether the 95 % intervals of a wind's speed and direction hold those of the anemometer."""
    speed, angle = measured_wind(runs)
    return [
        abs(estimates["speed"].value - speed) < Z95 * estimates["speed"].standard_error,
        abs(math.radians(apart(estimates["from"].value, angle))) < Z95 * estimates["from"].standard_error,
    ]


def winds_held(wind: Cause, runs: list[Run]) -> list[bool]:
    """Of each run's wind, or of the one that all runs share."""
    if not wind.groups:
        return held(wind.parameters, runs)
    return [one for run in runs for one in held(wind.groups[run.name], [run])]


def row(dataset: Path, folder: Path) -> list[str]:
    """The row of one result."""
    found = Diagnosis.model_validate_json((folder / "diagnosis.json").read_text(encoding="utf-8"))
    winds = [cause for cause in named_causes(found) if cause.effect == "wind"]
    inside = winds_held(winds[0], inspect_dataset(dataset).runs) if winds else []
    spoilt = [cause.effect for cause in (*found.causes, *found.minor) if not cause.carries_over]
    gain = next(one.position_rmse_m for one in found.gain if one.horizon_s == HORIZON)
    error = ""
    if gain is not None:
        low, high = gain.ci95
        error = f"{gain.before:.3f} to {gain.after:.3f} ({low:+.3f} to {high:+.3f})"
    return [
        f"{dataset.name}, {folder.name}",
        found.verdict,
        "; ".join(readable(one) for one in sets_of(found)),
        readable(" + ".join(spoilt)) if spoilt else "",
        f"{sum(inside)} of {len(inside)}" if inside else "none named",
        found.gain_on.replace("_", " "),
        error,
    ]


def main() -> None:
    """Write the table."""
    given = [Path(one) for one in sys.argv[1:]]
    if not given or len(given) % 2:
        raise SystemExit(__doc__)
    rows = [row(dataset, folder) for dataset, folder in zip(given[::2], given[1::2], strict=True)]
    head = [*HEAD, "error at 30 s, runs", "error at 30 s, m (gain's 95 % interval)"]
    write_parts(DOCS / "esso_osaka.md", {"answers": table(head, rows)})


if __name__ == "__main__":
    main()
