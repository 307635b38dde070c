"""The output-error fit of a boat's numbers: short windows, then longer ones weighted by the residual."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.hypothesis import FreeBoat
from swamp_rl.constants import Z95
from swamp_rl.criticism.data.measurement_noise import noise_floor
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import (
    Fit,
    fit,
    fit_states,
    inverse,
    losses,
    prior_penalty,
)
from swamp_rl.criticism.model.scales import state_scale
from swamp_rl.criticism.nuisance.process_noise import (
    correlation_samples,
    residual_rms,
)
from swamp_rl.errors import UserError
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]

SHORT = 5.0  # s of the first windows
PASSED, LEAST, MOST = (
    8.0,
    8.0,
    30.0,
)  # lengths that the boat passes in a window, and its s at least and at most
# added to the noise in the first fit, in `state_scale`: a guessed boat misses by far more than the noise
SOFT = np.array([0.03, 0.03, 0.05, 0.05, 0.05, 0.05])
MOST_ROUNDS = 12  # repetitions of fit and weights, at most
SETTLED = 0.05  # relative change of the residuals' standard deviations, below which no repetition follows
STEPS, STATE_ROUNDS = 6, 12  # Jacobians of a fit, iterations of its first initial states
LEAST_LEFT = 0.2  # of the independent samples, that a fit leaves at least
LAST_STEPS = 3  # Jacobians of the fit whose likelihood is scaled down
EXCESS = 1.2  # of the jackknife's variance over that of independent noise, from which it is
SHARE = 0.3  # of a number's variance that must be the data's, to be counted in that ratio
HUBER = 1.5  # times the median residual of a window, beyond which its weight falls


@dataclass(frozen=True)
class BoatFit:
    """Numbers fitted to runs. covariance: (p, p) of the fit's x, sandwich; sigma: (6,) standard deviation of
    the residual by channel.
    """

    hypothesis: FreeBoat
    problem: Shooting
    fit: Fit
    covariance: Array
    sigma: Array

    @property
    def joint_covariance(self) -> Array:
        """(p, p) of x for what the numbers do together: the inverse of the information, times the geometric
        mean of the ratios in which the sandwich's variances are larger.

        The sandwich's covariances are of as many blocks as there are windows, hardly more than there are
        numbers: their noise would undo what errors of several numbers cancel.
        """
        plain = self.fit.covariance
        ratio = np.diag(self.covariance) / np.diag(plain)
        return np.asarray(plain * np.exp(np.log(ratio).mean()))


def window_length(boat: Boat) -> float:
    """Seconds of the windows of the last fit."""
    return float(np.clip(PASSED * reference_of(boat).time, LEAST, MOST))


def soft_weights(weight: Array, boat: Boat) -> Array:
    """Weights (R, T, 6) with SOFT added to the noise."""
    soft = SOFT * state_scale(boat)
    return np.asarray(np.where(weight > 0, 1.0 / np.hypot(1.0 / np.maximum(weight, 1e-12), soft), 0.0))


@np.errstate(over="ignore", invalid="ignore")  # where numbers make the boat diverge
def fit_windows(
    run_set: RunSet,
    weight: Array,
    seconds: float,
    hypothesis: FreeBoat,
    starts: Sequence[Array],
    steps: int = STEPS,
) -> tuple[Shooting, Fit, float]:
    """The fit to windows of that length, from the likeliest of starts (p,), its problem, and its chi2 in all
    windows, the prior included: of a window in which the boat diverges (`sound_fit`), the chi2 of a motion
    that stays where it begins.

    Its last Jacobian is taken at the solution: from a start file that is far off, steps along an earlier one
    end far from the optimum.
    """
    whole = Shooting(run_set, weight, seconds)
    x, states, _ = likeliest(whole, hypothesis, starts)
    problem, made, kept = sound_fit(whole, hypothesis, x, states, steps, fresh=True)
    measured = whole.windows.measured
    still = losses(whole.residuals(np.broadcast_to(measured[:, :1], measured.shape)))
    return problem, made, made.chi2 + float(still[~kept].sum())


def likeliest(problem: Shooting, hypothesis: FreeBoat, starts: Sequence[Array]) -> tuple[Array, Array, Array]:
    """The start (p,) with the smallest chi2, the prior included, its initial states (W, 6) and residual."""
    begun = []
    for one in starts:
        states, _, residual = fit_states(problem, hypothesis, one, problem.initial_states(), STATE_ROUNDS)
        chi2 = float(losses(residual).sum()) + prior_penalty(hypothesis, one)
        begun.append((chi2, one, states, residual))
    return min(begun, key=lambda one: one[0])[1:]


def short_fit(run_set: RunSet, weight: Array, hypothesis: FreeBoat, x: Array) -> Fit:
    """The fit to windows of SHORT with SOFT noise, from x (p,) or the start file. weight: (R, T, 6) by the
    noise.
    """
    soft = soft_weights(weight, run_set.boat)
    return fit_windows(run_set, soft, SHORT, hypothesis, (x, hypothesis.prior()[0]))[1]


def sound_fit(
    problem: Shooting, hypothesis: FreeBoat, x: Array, states: Array, steps: int, fresh: bool = False
) -> tuple[Shooting, Fit, NDArray[np.bool_]]:
    """The fit from x (p,) and states (W, 6), its problem, and (W,) the windows that it keeps: those in which
    the boat of x and the boats a difference away from it do not diverge. Another window has no slopes; with
    it the fit would end where it is, without a covariance.

    Where one diverges, half the simulator's step is tried first: a fit passes through boats that damp faster,
    and states that are faster, than those of the runs, for which the longest stable step is shorter.
    """
    kept, usual = np.ones(len(states), dtype=bool), substeps_of(problem.dt, problem.boat)
    while True:
        at_usual = problem.substeps == usual
        made = fit(problem, hypothesis, x, states, steps, fresh, while_finite=at_usual)
        information, gradient = made.normal.information, made.normal.gradient
        sound = np.asarray(np.isfinite(information).all(axis=(1, 2)) & np.isfinite(gradient).all(axis=1))
        if at_usual and not sound.all():
            problem = problem.integrated_in(2 * usual)
        elif sound.all() or not sound.any():
            return problem, made, kept
        else:
            kept[kept] = sound
            problem, x, states = problem.part(sound), made.x, made.states[sound]


def fit_boat(run_set: RunSet, weight: Array, hypothesis: FreeBoat, x: Array) -> BoatFit:
    """The numbers fitted to runs, from x (p,): in short windows, then as `long_fit`."""
    return long_fit(run_set, weight, hypothesis, short_fit(run_set, weight, hypothesis, x).x)


@np.errstate(over="ignore", invalid="ignore")  # where numbers make the boat diverge
def long_fit(run_set: RunSet, weight: Array, hypothesis: FreeBoat, x: Array) -> BoatFit:
    """The numbers fitted to runs in windows of `window_length`, from x (p,) or the start file, whichever is
    likelier: a fit ends no farther from the runs than the file that it is given.

    Weights of the windows: the residual's standard deviation by channel, at least `noise_floor` (that of a
    simulator's output is the error of the integration), its integrated autocorrelation time, so that the
    likelihood counts independent samples beside the prior, and Huber's weight of each window. Fit and weights
    are repeated until the standard deviations have settled. Windows in which the boat of x, or of a later one
    (`sound_fit`), diverges are left out. weight: (R, T, 6) by the measurement noise.
    """
    boat = run_set.boat
    seconds, soft = window_length(boat), soft_weights(weight, boat)
    seen, least = weight > 0, noise_floor(boat)
    sigma = 1.0 / np.maximum(soft.max(axis=(0, 1)), 1e-12)
    problem = Shooting(run_set, seen / sigma, seconds)
    x, states, residual = likeliest(problem, hypothesis, (x, hypothesis.prior()[0]))
    sound = np.asarray(np.isfinite(residual).all(axis=1), dtype=bool)
    if not sound.any():
        raise UserError(
            f"boat {boat.name} diverges in every window of {seconds:.3g} s; check its masses and damping, "
            "or the units of the runs"
        )
    trust, states, substeps = np.ones(int(sound.sum())), states[sound], problem.substeps

    def fitted(
        sigma: Array, x: Array, states: Array, steps: int, fresh: bool = False
    ) -> tuple[Shooting, Fit]:
        nonlocal sound, trust, substeps
        problem = weighted(Shooting(run_set, seen / sigma, seconds).part(sound), trust)
        problem = problem.integrated_in(substeps)
        problem, made, kept = sound_fit(problem, hypothesis, x, states, steps, fresh)
        sound[sound], trust, substeps = kept, trust[kept], problem.substeps
        return problem, made

    samples = correlation_samples(problem.windows.by_channel(residual[sound]))
    for _ in range(MOST_ROUNDS):
        before, wide = sigma, sigma * np.sqrt(samples)
        problem, made = fitted(wide, x, states, STEPS)
        x, states = made.x, made.states
        samples = correlation_samples(problem.windows.by_channel(made.residual))
        rms, trust = reweighted(problem, made, trust)
        sigma = np.where(seen.any(axis=(0, 1)), np.maximum(wide * rms, least), sigma)
        if np.abs(np.log(sigma / before)).max() < SETTLED:
            break
    sigma = sigma * np.sqrt(lost_freedom(problem, made, samples))
    for steps in (STEPS, LAST_STEPS):
        problem, made = fitted(sigma * np.sqrt(samples), made.x, made.states, steps, fresh=True)
        covariance, excess = jackknife_covariance(made)
        if excess < EXCESS:
            break
        samples *= excess
    problem.correlation_samples = samples
    return BoatFit(hypothesis, problem, made, covariance, sigma)


def jackknife_covariance(made: Fit) -> tuple[Array, float]:
    """(p, p) covariance of x: the sandwich whose meat is that of a jackknife over windows, which allows for
    the fit having followed each window's own disturbance (CR3; Bell and McCaffrey 2002), and the prior's
    part.

    C = J + H⁻¹ P H⁻¹, J = (W − 1)/W Σ δ_w δ_wᵀ, δ_w = (H − I_w)⁻¹ g_w; H: information with the prior's P;
    I_w, g_w: information and score of window w. No variance is below that of H⁻¹; all are widened by
    Student's t for W windows. Also the ratio by which the likelihood counts too much beside the prior
    (Ribatet, Cooley and Davison 2012): of the geometric mean of J and the plain sandwich to what both would
    be under independent noise, H⁻¹ (H − P) H⁻¹, mean over the numbers.
    """
    from scipy.special import stdtrit

    precision = made.hypothesis.prior_precision
    information, score = made.normal.information, made.normal.gradient
    H = information.sum(axis=0) + precision
    covariance, count = inverse(H), len(score)
    away = score - score.mean(axis=0)
    moved = np.stack([inverse(H - own) @ one for own, one in zip(information, away, strict=True)])
    jackknife = (count - 1) / count * (moved**2).sum(axis=0)
    plain = ((away @ covariance) ** 2).sum(axis=0)  # of windows as the fit left them, hence too small
    of_prior = np.diag(covariance @ precision @ covariance)
    of_data = np.maximum(np.diag(covariance) - of_prior, 1e-300)
    known = of_data > SHARE * np.diag(covariance)
    between = np.sqrt(plain[known] * jackknife[known]) / of_data[known]
    excess = float(np.exp(np.mean(np.log(between)))) if known.any() else 1.0
    ratio = (jackknife + of_prior) / np.maximum(np.diag(covariance), 1e-300)
    wider = np.sqrt(np.maximum(ratio, 1.0)) * stdtrit(max(count - 1, 2), 0.975) / Z95
    return np.asarray(covariance * np.outer(wider, wider)), excess


def lost_freedom(problem: Shooting, made: Fit, samples: float) -> float:
    """Ratio n / (n - q) [1] of the independent samples n to those that the fit has left: q initial states and
    numbers, the latter by the share of their precision that is not the prior's, none where a window diverges
    and the covariance is infinite.
    """
    precision = made.hypothesis.prior_precision
    known = np.isfinite(made.covariance).all()
    free = max(0.0, len(precision) - float((made.covariance * precision).sum())) if known else 0.0
    count = problem.samples / samples
    return count / max(count - len(made.states) * made.states.shape[1] - free, LEAST_LEFT * count)


def window_rms(problem: Shooting, made: Fit) -> Array:
    """(W,) root mean square standardised residual of each window."""
    seen = np.maximum((problem.windows.weight > 0).sum(axis=(1, 2)), 1)
    return np.asarray(np.sqrt((made.residual**2).sum(axis=1) / seen))


def reweighted(problem: Shooting, made: Fit, trust: Array) -> tuple[Array, Array]:
    """(6,) root mean square residual of each channel, and (W,) Huber's weight of each window: 1 up to HUBER
    median residuals, then falling with the residual's root. trust: (W,) the weights of the fit so far.
    """
    size = window_rms(problem, made) / trust
    new = np.sqrt(np.minimum(1.0, HUBER * np.median(size) / np.maximum(size, 1e-12)))
    return residual_rms(problem, replace(made, residual=made.residual * (new / trust)[:, None])), new


def weighted(problem: Shooting, trust: Array) -> Shooting:
    """The problem with each window's weights times trust (W,)."""
    weight = problem.windows.weight * trust[:, None, None]
    problem.windows = replace(problem.windows, weight=weight)
    problem.last_slopes.clear()  # which are in standard deviations
    return problem
