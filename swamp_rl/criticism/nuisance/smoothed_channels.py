"""Channels that an onboard filter smoothed, and the standard deviation that they are weighted by instead.

Third differences do not hold the low frequencies that a filter leaves. Over longer strides those of smoothed
noise have a larger variance; those of white noise have the same. Those of a motion beside white noise grow
too, but the spectrum of a position or heading then has a white floor.
"""

import itertools
import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.measurement_noise import NORMAL_OF_MAD, repeated_samples
from swamp_rl.criticism.data.run_set import CHANNELS, POSITIONS, RunSet
from swamp_rl.criticism.model.scales import state_scale
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import SmoothedNoise
from swamp_rl.doctor.filtered import SEGMENT, power_drop
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.substeps import steps_over

Array = NDArray[np.float64]
Kind = Literal["lags", "wanders"]

# times 1 / n: variance of a variance of n third differences, correlated as (20, -15, 6, -1) / 20
OF_A_VARIANCE = 4.6
OF_TWO_GROWTHS = 6 * OF_A_VARIANCE  # the same of the difference (1, -2, 1) of successive logarithms
THIRD = 3  # strides that a third difference spans
LAGGING = slice(2, 6)  # channels whose lag no effect of the library is
POSES = slice(0, 3)  # channels that have two integrals of the forces


def smoothed_channels(run_set: RunSet) -> dict[str, SmoothedNoise]:
    """The smoothed channels by name: standard deviations at the sample rate, from third differences, and of
    the white noise that is as large at low frequencies, lag included; time constant of the filter [s]. North
    and east are of one receiver: both or none.
    """
    rows = 1.0 / (run_set.dt * reference_of(run_set.boat).rate)  # in the time of a length at top speed
    if rows * options().smoothed_step < 1.0:
        return {}
    own = np.where(repeated_samples(run_set.measured), np.nan, run_set.measured)
    inside = np.arange(own.shape[1]) < run_set.lengths[:, None]
    activity = command_activity(run_set)
    least = options().rounding_noise * state_scale(run_set.boat)
    found = {}
    for index, name in enumerate(CHANNELS):
        values = own[..., index]
        if np.isfinite(values[inside]).mean() < options().own_samples:
            continue
        kind: Kind = "lags" if index >= LAGGING.start else "wanders"
        made = _smoothing(values, activity, run_set.dt, rows, kind)
        if made is None or made.sample_noise <= least[index]:
            continue
        if index >= POSES.stop or not _has_floor(run_set.measured[..., index]):
            found[name] = made
    of_receiver = [name for name in CHANNELS[POSITIONS] if name in run_set.present]
    alike = all(name in found for name in of_receiver)
    return {name: made for name, made in found.items() if alike or name not in of_receiver}


def raised(sigmas: Array, smoothed: Mapping[str, SmoothedNoise]) -> Array:
    """(6,) standard deviations with those of the smoothed channels, where these are larger."""
    wanted = [smoothed[name].standard_deviation if name in smoothed else 0.0 for name in CHANNELS]
    return np.asarray(np.where(np.isfinite(sigmas), np.maximum(sigmas, wanted), sigmas))


def command_activity(run_set: RunSet) -> Array:
    """(R, T) sum up to each row of the commands' changes, each command in its own range."""
    size = np.maximum(np.ptp(run_set.commands, axis=(0, 1)), 1e-9)
    steps = np.abs(np.diff(run_set.commands, axis=1, prepend=run_set.commands[:, :1])) / size
    return np.asarray(np.cumsum(np.nan_to_num(steps).sum(axis=2), axis=1))


def _smoothing(values: Array, activity: Array, dt: float, rows: float, kind: Kind) -> SmoothedNoise | None:
    """Of one channel (R, T), None where its noise is white: judged where commands change as little over the
    longer stride as over one sample, so that both differences hold as little of the motion. rows: in the time
    of a length at top speed; kind: what the channel may do beside.
    """
    before = steps_over(options().settled, dt)
    of_strides = {s: _third_differences(values, activity, s, before) for s in options().strides}
    judged = _third_differences(values, activity, options().judged_stride, before)
    quiet = _median_rate(*of_strides[1])
    fine, coarse = _variance(*of_strides[1], quiet), _variance(*judged, quiet)
    if fine is None or coarse is None or fine[0] <= 0.0:
        return None
    error = math.sqrt(OF_A_VARIANCE / fine[1] + OF_A_VARIANCE / coarse[1])
    ratio = coarse[0] / fine[0]
    exponent = math.log(max(ratio, 1e-12)) / math.log(options().judged_stride)
    if (
        ratio < options().smoothed_ratio
        or ratio - 1.0 < options().smoothed_certainty * error
        or exponent > options().motion_exponent
    ):
        return None
    every = {s: _variance(*own, _median_rate(*own)) for s, own in of_strides.items()}
    variances = {stride: one for stride, one in every.items() if one and one[0] > 0.0}
    measured = _without_motion(variances, rows)
    if exponent < options().first_order_exponent and _grows_to_a_walk(variances, kind):
        return None  # white noise beside a wander, or a wander alone: Gauss-Markov noise
    pole, longest = _pole(measured), max(measured)
    if (
        third_difference_variance(pole, options().judged_stride) / third_difference_variance(pole, 1)
        < options().smoothed_ratio
    ):
        return None  # white noise beside a motion that fills the longer strides
    power = measured[longest] / third_difference_variance(pole, longest)
    low = power * (1.0 + pole) / (1.0 - pole)
    seconds = -dt / math.log(pole)
    if kind == "lags" and exponent < options().first_order_exponent:
        low += _lag_power(values, seconds, dt)
    fine_sigma = math.sqrt(fine[0] / 20)
    return SmoothedNoise(sample_noise=fine_sigma, standard_deviation=math.sqrt(low), time_constant_s=seconds)


def _has_floor(values: Array) -> bool:
    """Whether the stretches (R, T) without a lost row show white noise up to the Nyquist frequency."""
    inside = [run[part] for run in values for part in np.ma.clump_unmasked(np.ma.masked_invalid(run))]
    long = [one for one in inside if len(one) >= 2 * SEGMENT]
    return bool(long) and power_drop(long) is None


def _third_differences(values: Array, activity: Array, stride: int, before: int) -> tuple[Array, Array]:
    """(R, N) third differences over a stride, and (R, N) change of commands in a row, from `before` rows
    before their first samples on; N is 0 in runs too short.
    """
    span = THIRD * stride
    if values.shape[1] <= span + before:
        return np.zeros((len(values), 0)), np.zeros((len(values), 0))
    differences = values[:, span:] - values[:, :-span]
    differences = differences - 3 * (values[:, 2 * stride : -stride] - values[:, stride : -2 * stride])
    moved = activity[:, span + before :] - activity[:, : -span - before]
    return differences[:, before:], moved / (span + before)


def _median_rate(differences: Array, rate: Array) -> float:
    """Change of commands in a row that about half of the third differences do not exceed; 0 of none."""
    measured = np.isfinite(differences)
    return float(np.median(rate[measured])) if measured.any() else 0.0


def _variance(differences: Array, rate: Array, quiet: float) -> tuple[float, int] | None:
    """Variance and number of third differences where commands change by at most `quiet` in a row, less
    outliers; None where these are too many: they are a motion in bursts.
    """
    kept = differences[np.isfinite(differences) & (rate <= quiet)]
    if len(kept) < options().fewest_differences:
        return None
    rough = NORMAL_OF_MAD * float(np.median(np.abs(kept)))
    near = kept[np.abs(kept) <= options().difference_clip * max(rough, 1e-12)]
    noise = len(near) >= options().least_inside * len(kept)
    return (float(np.mean(near**2)), len(near)) if noise else None


def _without_motion(variances: Mapping[int, tuple[float, int]], rows: float) -> dict[int, float]:
    """The variances by stride, to the one beyond the time of a length (rows) from which they grow by a higher
    power of it than before: those of a filter's noise grow ever less, a motion's by its sixth.
    """
    first = min(variances)
    found, slowest = {first: variances[first][0]}, math.inf
    for stride, growth, error in _growths(variances):
        if growth > slowest + options().motion_certainty * error and THIRD * stride > rows:
            break
        found[stride], slowest = variances[stride][0], min(growth, slowest)
    return found


def _grows_to_a_walk(variances: Mapping[int, tuple[float, int]], kind: Kind) -> bool:
    """Whether the variances by stride, with their numbers, grow as a random walk's: those of a filter's noise
    grow by a lower power of it from the longest but one than from the shortest. Of a channel that lags only
    white noise beside a walk is so recognised, as growth that rises to that of a walk and no further: motion
    in the longest stride makes it rise too.
    """
    growths = _growths(variances)
    powers = [growth for _, growth, _ in growths]
    if len(powers) < 2 or kind == "wanders":
        return len(powers) > 1 and powers[0] <= powers[-1]
    rise = max(powers) - powers[0]
    return rise > options().motion_certainty * growths[0][2] and max(powers) < options().first_order_exponent


def _growths(variances: Mapping[int, tuple[float, int]]) -> list[tuple[int, float, float]]:
    """Each stride but the shortest with the power of it that the variance grows by from the one before, and
    the standard error of a difference of two such powers.
    """
    error = math.sqrt(OF_TWO_GROWTHS / min(number for _, number in variances.values()))
    found = []
    for (before, (last, _)), (stride, (variance, _)) in pairwise(variances.items()):
        doublings = math.log(stride / before)
        found.append((stride, math.log(variance / last) / doublings, error / doublings))
    return found


def third_difference_variance(pole: float, stride: int) -> float:
    """Variance of third differences of first-order noise of unit variance: autocorrelation pole^|lag|."""
    share = pole**stride
    return 2 * (10 - 15 * share + 6 * share**2 - share**3)


def _pole(measured: Mapping[int, float]) -> float:
    """The pole whose variances over all strides have the measured ratios best (least squares of logs)."""
    poles = np.linspace(*options().poles)
    logs = np.log([measured[stride] for stride in measured])
    apart = [
        float(np.var(logs - np.log([third_difference_variance(float(pole), stride) for stride in measured])))
        for pole in poles
    ]
    return float(poles[int(np.argmin(apart))])


def _lag_power(values: Array, seconds: float, dt: float) -> float:
    """Variance of white noise whose means over `whiteness_scales` are as large as those of such a lag."""
    found = [0.0]
    for scale, run in itertools.product(options().whiteness_scales, values):
        rows = max(2, round(scale / dt))
        changes = (run[rows:] - run[:-rows])[np.isfinite(run[rows:] - run[:-rows])]
        if len(changes):
            found.append(rows * float(np.mean((seconds / (rows * dt) * changes) ** 2)))
    return max(found)
