"""All numbers of the monitor."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Options:
    """The numbers that the monitor depends on, by the part that uses them.

    Units: SI and rad; L, U: a boat's length and top speed; the criterion: fall of chi2 less two for each size
    that is fitted. Numbers without a reason beside them were chosen on simulated streams
    (`benchmarks/monitor`).
    """

    # ---- First seconds
    warm_up: float = 30.0  # s that noise and usual innovations are estimated from
    settled: float = 5.0  # s after which the actuators no longer depend on where they stood at first
    # ---- Filter
    kept: float = 6.0  # s of history
    # standard deviations at first, in `scale_of`
    start: tuple[float, ...] = (0.8, 0.8, 0.05, 0.09, 0.09, 0.05, 0.13, 0.13)
    # random walk, in `scale_of` per sqrt(L/U)
    walk: tuple[float, ...] = (0.0, 0.0, 0.0, 0.045, 0.045, 0.033, 0.018, 0.018)
    walks: tuple[float, ...] = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)  # multiples of it that are tried
    # standard deviation of an unknown acceleration to the north, east and in yaw, in `scale_of` per L/U
    strength: tuple[float, ...] = (0.002, 0.002, 0.002)
    strengths: tuple[float, ...] = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0)  # multiples of it that are tried
    gust_time: float = 5.0  # s, its time constant
    least_walk: float = 0.0  # of them that are tried: more for streams that may grow rougher
    outlier: float = 5.0  # standard deviations of an innovation that is left out,
    outliers: int = 3  # unless it comes that many times in a row
    # ---- Test for a change
    windows: tuple[float, ...] = (0.3, 1.0, 3.0)  # s
    least_samples: int = 3  # of a window
    clip: float = 5.0  # of a normalised innovation, so that one outlier alone does not alarm
    forget: float = 60.0  # s, of the mean square of a statistic
    threshold: float = 6.0  # standard deviations
    # ---- Frozen sensors
    repeats: float = 0.8  # s for which a reading must repeat
    repeats_usual: float = 3.0  # of the longest repetition that is usual, for which it must
    beyond_noise: float = 5.0  # standard deviations of motion that a working sensor of no noise would show
    # ---- Isolation
    onsets: float = 0.5  # s between the onsets that are tried first
    leaders: int = 4  # candidates whose onset and size are then refined
    iterations: int = 10  # Gauss-Newton steps of their size at most
    converged: float = 0.1  # fall of chi2 of all of them, below which there is no further step
    shares: tuple[float, ...] = (1.0, 0.3, 0.1)  # of such a step that are tried; the best is taken
    # ---- Naming
    # fall of minus twice the log-likelihood against a rougher sea, from which a cause is named; that of two
    # sizes exceeds it by chance with probability exp(-sea / 2) (Wilks 1938)
    sea: float = 20.0
    rougher: tuple[float, ...] = (1.0, 1.5, 2.0, 3.0)  # multiples of the process noise that it may have,
    light_wind: tuple[float, float] = (0.1, 2.0)  # of at least so many times `walk` and `strength`
    clear: float = 9.0  # of the criterion, by which a cause leads its rivals when it is named at once
    rival: float = 6.0  # of the criterion, within which a rival is named too
    tenable: float = 3.0  # standard deviations by which the chi2 that a cause leaves may exceed its mean
    soonest: float = 0.5  # s from an alarm to the earliest naming
    patience: float = 2.0  # s from an alarm to the latest naming
    again: float = 0.3  # s between two isolations
    refined: float = 15.0  # s for which the size of a cause is corrected without another notice


DEFAULT = Options()
