"""Channels without a white noise floor: smoothed by a filter, with errors that wander, or free of noise.

Near the Nyquist frequency the error of a receiver that wanders, a Gauss-Markov process, has the spectrum of
white noise behind a filter of first order with the same time constant: the channel does not tell the two.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from swamp_rl.doctor.finding import Finding, Level
from swamp_rl.runs import Run

Array = NDArray[np.float64]

SEGMENT = 64
"""Rows of a spectrum's segments (Hann windows, half overlapping)."""
LOW, HIGH = (0.35, 0.5), (0.85, 1.0)
"""Bands as parts of the Nyquist frequency. A hull's motion is far below both where the rows resolve it."""
MOTION, FALL = ((0.1, 0.2), (0.2, 0.3)), 4.0
"""Bands between which a motion's power falls with that power of the frequency or a greater one: forces act on
accelerations, and a position has two integrals. Noise behind a filter of first order falls with 2 at most."""
SEEN = 2.0
"""Power density of the high band over that of an extrapolated motion from which noise is seen in it."""
LARGEST_DROP = 1.6
"""Power density of the low band over that of the high one; 1 for white noise. A first-order filter with a
time constant T of two steps has 2.1, of five 2.6: |H|² is 1 / (1 + p² − 2 p cos ω), p = exp(−step / T)."""
DEVIATIONS = 4.0
"""Standard errors of the ratio's logarithm beyond which it is no chance."""
CHANNELS = ("north", "east", "heading")
"""Twice integrated from forces, so that motion falls off steeply; velocities may be rough by themselves."""


def filter_findings(runs: Sequence[Run], measured: bool) -> list[Finding]:
    """Channels whose spectrum falls up to the Nyquist frequency; measured: whether noise is expected."""
    drops = {}
    for name in CHANNELS:
        parts = [_whole(run.columns[name], name) for run in runs if name in run.columns]
        if parts and (drop := power_drop(parts)) is not None:
            drops[name] = drop
    if not drops:
        return []
    message = "no white noise floor: power density falls by a factor of " + ", ".join(
        f"{float(f'{drop:.2g}'):,g} ({name})" for name, drop in drops.items()
    )
    message += f" from {LOW[0]:g}-{LOW[1]:g} to {HIGH[0]:g}-{HIGH[1]:g} of the Nyquist frequency"
    advice = (
        "a filter, resampling or an integral smoothed them, or the receiver's error wanders: log the raw "
        "sensor if these are not its values; errors of successive rows are correlated, and intervals from "
        "white noise too short"
        if measured
        else "as simulated runs without sensor noise do"
    )
    level: Level = "fault" if measured else "note"
    return [Finding(level, "filtered", tuple(drops), message, advice, figures=drops)]


def _whole(values: Array, name: str) -> Array:
    return np.unwrap(values) if name == "heading" and np.isfinite(values).all() else values


def power_drop(parts: Sequence[Array]) -> float | None:
    """The ratio of power densities of a position or heading, less the motion left in the low band, where it
    is significantly above LARGEST_DROP; None where there is a white noise floor, or no part is long enough.
    """
    spectra, weights = [], []
    for values in parts:
        changes = np.diff(values)
        if len(values) < 2 * SEGMENT or not np.isfinite(values).all() or np.mean(changes == 0.0) > 0.2:
            continue
        # Second differences leave no trend to leak into the high band; they are divided out again.
        frequency, power = welch(np.diff(values, 2), fs=2.0, nperseg=SEGMENT, detrend=False)
        spectra.append(power[1:] / (4.0 * np.sin(0.5 * np.pi * frequency[1:]) ** 2) ** 2)
        weights.append(len(values))
    if not spectra:
        return None
    mean = np.average(spectra, axis=0, weights=weights)
    bands = [(frequency[1:] >= a) & (frequency[1:] <= b) for a, b in (*MOTION, LOW, HIGH)]
    first, second, low, high = (float(mean[band].mean()) for band in bands)
    rows = sum(weights)
    if high <= 0.0:
        return None
    ratio = max(low - _motion_left(first, second, high), 0.0) / high
    # A band of width w of N rows has N w / 2 independent periodogram ordinates, each of relative variance 1.
    error = np.sqrt(sum(2.0 / (rows * (b - a)) for a, b in (LOW, HIGH)))
    return ratio if ratio > LARGEST_DROP and np.log(ratio) > DEVIATIONS * error else None


def _motion_left(first: float, second: float, high: float) -> float:
    """Power density of the motion in the low band, at most, from those of the bands of MOTION: that of a
    quick boat in few rows. Zero where it does not fall as a motion, or where the high band may be motion too.
    """
    if min(first, second) <= 0.0:
        return 0.0
    one, other, low, top = (0.5 * (a + b) for a, b in (*MOTION, LOW, HIGH))
    fall = np.log(first / second) / np.log(other / one)
    motion = [second * (frequency / other) ** -fall for frequency in (low, top)]
    return float(motion[0]) if fall > FALL and high > SEEN * motion[1] else 0.0
