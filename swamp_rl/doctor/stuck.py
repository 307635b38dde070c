"""Measured channels that stay at one value while the boat moves, or come at a lower rate than the rows."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.commands import is_command
from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.own_samples import holds, usual_hold, usual_slope
from swamp_rl.runs import Run

Array = NDArray[np.float64]

LONGEST_HOLD = 8.0
"""Times the channel's usual hold (the 90 % quantile of the rows between two changes)."""
FEWEST_ROWS = 10
MOVED = 0.25
"""The other channels' root mean square step during the stay, relative to that of the whole run: below it the
boat may have been at rest."""
SELDOM = 3.0
"""Median rows between two changes of a channel, from which it is sampled more slowly than the rows."""
FEWEST_HELD, FEWEST_LEVELS, OFF_GRID = 3, 4, 0.1
"""Rows of a value that is the sensor's own and not interpolated; how many of these show its last digit, and
how far they lie from multiples of it at most, relative to it."""
QUIET = 3.0
"""Digits by which a channel moves at most next to its stay at a value: its motion is steady."""
PARTNERS = {"heading": ("yaw_rate",), "yaw_rate": ("heading",), "sway": ("yaw_rate", "heading")}
"""Channels that move where that channel must; on a straight course without noise all three stand still."""
MEASURED = ("north", "east", "heading", "surge", "sway", "yaw_rate", "latitude", "longitude", "wind_speed")
CALM = {"wind_speed": 0.0}
"""Values that a sound sensor stays at: an anemometer reads 0 in a calm."""


def stuck_findings(runs: Sequence[Run], measured: bool = True) -> list[Finding]:
    """Channels that stuck, by run, and channels that are repeated between their own samples.

    measured: whether channels have noise; without it a steady turn holds its velocities.
    """
    places: dict[str, list[tuple[str, float, float]]] = {}
    repeated: dict[str, float] = {}
    channels: dict[str, list[Array]] = {}
    for run in runs:
        for name in run.columns:
            if _measured(name, run):
                channels.setdefault(name, []).append(run.columns[name])
    digits = {name: _digit(values) for name, values in channels.items()}
    for run in runs:
        names = [name for name in run.columns if _measured(name, run)]
        for name in names:
            partners = [other for other in PARTNERS.get(name, ()) if other in names]
            others = [run.columns[other] for other in partners or names if other != name]
            stay = _stay(run.columns[name], others, digits[name])
            if stay and run.columns[name][stay[0]] != CALM.get(name):
                first, last = stay
                places.setdefault(name, []).append((run.name, run.time[first], run.time[last]))
            elif (hold := usual_hold(run.columns[name])) >= SELDOM:
                repeated[name] = max(hold, repeated.get(name, 0.0))
    found = [
        Finding(
            "fault" if measured else "note",
            "stuck",
            (name,),
            f"does not change from {at[0][1]:.1f} to {at[0][2]:.1f} s of {at[0][0]} while the boat moves",
            "cut the run there (--bad-rows), or leave the channel out",
            tuple(run for run, _, _ in at),
            {"seconds": max(end - start for _, start, end in at)},
        )
        for name, at in places.items()
    ]
    if repeated:
        hold = max(repeated.values())
        message = f"change only every {hold:.0f} rows"
        advice = "import at the sensor's own rate (--resample HZ): repeated values look like noise-free data"
        found.append(Finding("note", "repeated", tuple(repeated), message, advice, figures={"rows": hold}))
    return found


def _measured(name: str, run: Run) -> bool:
    values = run.columns[name]
    known = name in MEASURED or name.startswith("observation")
    return known and not is_command(name) and bool(np.isfinite(values).all()) and len(values) > FEWEST_ROWS


def _stay(values: Array, others: Sequence[Array], digit: float) -> tuple[int, int] | None:
    """First and last row of the longest stay at one value, where it is no ordinary one and others moved.

    digit: the channel's last digit, 0 where it has none."""
    starts, lengths = holds(values)
    long = np.flatnonzero(lengths >= FEWEST_ROWS)
    longest_first = long[np.argsort(-lengths[long], kind="stable")]
    stays = (int(n) for n in longest_first if not _is_quiet(values, int(starts[n]), int(lengths[n]), digit))
    longest = next(stays, None)
    if longest is None:
        return None
    rows = int(lengths[longest])
    rest = np.delete(lengths, longest)
    usual = max(float(np.quantile(rest, 0.9)) if len(rest) else 0.0, usual_slope(values))
    whole = rows == len(values)
    if not whole and rows <= LONGEST_HOLD * max(usual, 1.0):
        return None
    first, last = int(starts[longest]), int(starts[longest]) + rows - 1
    moved = [_share(other, first, last) for other in others if np.ptp(other) > 0.0]
    # At rest most channels stand still.
    if not moved or sorted(moved)[len(moved) // 2] < MOVED:
        return None
    return first, last


def _digit(channels: Sequence[Array]) -> float:
    """The last digit of a sensor by the values that it held, 0 where these show none."""
    held = [values[starts[rows >= FEWEST_HELD]] for values in channels for starts, rows in [holds(values)]]
    known = np.unique(np.concatenate(held))
    gaps = np.diff(known)
    gaps = gaps[gaps > 1e-9 * (known[-1] - known[0])] if len(known) else gaps
    if len(gaps) < FEWEST_LEVELS - 1:
        return 0.0
    digit = float(gaps.min())
    multiples = (known - known[0]) / digit
    return digit if np.abs(multiples - np.round(multiples)).max() < OFF_GRID else 0.0


def _is_quiet(values: Array, start: int, rows: int, digit: float) -> bool:
    """Whether the channel moves by a few digits only after its stay from row `start` on, or before one that
    lasts to the end, in a third as many rows: a sensor that froze goes on where the boat has moved to."""
    near = max(FEWEST_HELD, rows // 3)
    end = start + rows
    about = values[end : end + near] if end < len(values) else values[max(0, start - near) : start]
    return len(about) > 0 and bool(np.abs(about - values[start]).max() <= (QUIET + OFF_GRID) * digit)


def _share(values: Array, first: int, last: int) -> float:
    steps = np.diff(values)
    whole = float(np.sqrt(np.mean(steps**2)))
    return float(np.sqrt(np.mean(steps[first:last] ** 2))) / whole if whole > 0.0 else 0.0
