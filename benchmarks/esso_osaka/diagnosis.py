"""What `swamp-rl diagnose` itself says of the pond's runs once their wind columns are hidden."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.wind import anemometer, apart
from swamp_rl.boat import Boat
from swamp_rl.constants import Z95
from swamp_rl.criticism.data.run_set import run_set_of
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.report.words import readable
from swamp_rl.criticism.result import Cause, Diagnosis, Estimate
from swamp_rl.one_thread import one_thread
from swamp_rl.runs import Run


@dataclass(frozen=True)
class Diagnosed:
    """Runs of one day, what was diagnosed from them, and the wind in it: speed [m/s] and where from [rad]
    with their standard errors; none where no wind was named.
    """

    runs: Sequence[Run]
    diagnosis: Diagnosis
    speed: Estimate | None
    angle: Estimate | None


@one_thread()
def diagnosed(boat: Boat, runs: Sequence[Run]) -> Diagnosed:
    """The diagnosis of runs taken together, without the anemometer."""
    without_wind = run_set_of(list(runs), boat, "pond", ignore=["wind"])
    found = examine(without_wind, None, np.random.default_rng(0)).diagnosis
    winds = [cause for cause in named_causes(found) if cause.effect == "wind"]
    if not winds:
        return Diagnosed(runs, found, None, None)
    return Diagnosed(runs, found, winds[0].parameters["speed"], winds[0].parameters["from"])


def named_causes(found: Diagnosis) -> list[Cause]:
    """The causes, and those of every explanation that these runs cannot tell from them."""
    return [*found.causes, *(cause for one in found.contrasts for cause in one.rival)]


def measured_wind(runs: Sequence[Run]) -> tuple[float, float]:
    """Mean speed [m/s] over runs, and the direction of the mean wind [rad]."""
    joined = {
        name: np.concatenate([run.columns[name] for run in runs]) for name in ("wind_speed", "wind_from")
    }
    return anemometer(Run("all", joined))


def days(runs: Sequence[Run]) -> dict[str, list[Run]]:
    """Runs by the day in their names, which is between underscores."""
    found: dict[str, list[Run]] = {}
    for run in runs:
        found.setdefault(run.name.split("_")[1], []).append(run)
    return found


def sets_of(found: Diagnosis) -> list[str]:
    """The explanations that stay side by side, the best first."""
    return (
        found.indistinguishable[0] if found.indistinguishable else [" + ".join(_labels(found)) or "nothing"]
    )


def _labels(found: Diagnosis) -> list[str]:
    return [cause.effect for cause in found.causes]


def diagnosis_table(every: dict[str, Diagnosed]) -> str:
    """Verdict, names and wind of each dataset, beside the anemometer."""
    rows = []
    for name, day in every.items():
        speed, angle = measured_wind(day.runs)
        cells = ["none", "none", "", ""]
        if day.speed is not None and day.angle is not None:
            off = apart(day.angle.value, angle)
            cells = [
                f"{day.speed.value:.2f} ± {Z95 * day.speed.standard_error:.2f}",
                f"{math.degrees(day.angle.value):.0f} ± {math.degrees(Z95 * day.angle.standard_error):.0f}",
                f"{off:+.0f}",
                f"{day.speed.value / speed:.2f}",
            ]
        rows.append(
            [
                f"{name}, {len(day.runs)} run{'s' * (len(day.runs) > 1)}",
                day.diagnosis.verdict,
                "; ".join(readable(one) for one in sets_of(day.diagnosis)),
                f"{speed:.2f} from {math.degrees(angle):.0f}",
                *cells,
            ]
        )
    head = ["runs", "verdict", "causes, by rank", "anemometer, m/s, deg", "identified wind, m/s"]
    return table([*head, "from, deg", "error, deg", "speed / measured"], rows)
