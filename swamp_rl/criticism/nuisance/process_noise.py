"""Model error: its process noise against measurement noise, and weights from its size."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import CHANNELS, POSITIONS, RunSet
from swamp_rl.criticism.likelihood.force_sensitivity import (
    AXES,
    force_grid,
    force_normal_equations,
    inverse_correlation,
)
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, first_states, fit
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.options import options

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RandomForces:
    """First-order Gauss-Markov forces of surge, sway and yaw in the B intervals of W windows, of the most
    likely power.

    prior (3 B, 3 B): inverse of their covariance; spread (W, 3 B, 3 B): covariance given the data; force (W,
    3 B): expected [N, N m]; power (3,): variance; gain: 2 log likelihood ratio to no forces.
    """

    prior: Array
    spread: Array
    force: Array
    power: Array
    gain: float


def random_forces(
    information: Array, gradient: Array, piece: float, correlation_time: float, scale: Array
) -> RandomForces:
    """From chi2 as a function of forces, initial states eliminated: information (W, 3 B, 3 B) and gradient
    (W, 3 B); intervals of `piece` s, correlation time [s], scale: `force_scale`. One power for each axis.
    """
    windows, pieces = len(gradient), gradient.shape[1] // AXES
    alike = inverse_correlation(pieces, piece, correlation_time)

    def at(power: Array) -> RandomForces:
        prior = np.asarray(np.kron(alike, np.diag(1.0 / power)))
        spread = np.asarray(np.linalg.inv(information + prior), dtype=np.float64)
        force = (spread @ gradient[..., None])[..., 0]
        volume = np.linalg.slogdet(spread)[1].sum() + windows * np.linalg.slogdet(prior)[1]
        return RandomForces(prior, spread, force, power, float((gradient * force).sum() + volume))

    def deviance(power: Array) -> tuple[float, Array]:
        made = at(power)
        expected = expected_power(made.spread.sum(axis=0) + made.force.T @ made.force, alike, windows)
        return -made.gain, windows * pieces * (1.0 - expected / power)

    sizes = options().process_reach, options().process_least, options().process_most
    return at(likeliest_variances(deviance, *((np.array(size) * scale) ** 2 for size in sizes)))


def expected_power(squares: Array, alike: Array, windows: int) -> Array:
    """(3,) expected squares of a Gauss-Markov force in units of its correlation; squares (3 B, 3 B): expected
    products of it, summed over the windows; alike (B, B): its inverse correlation.
    """
    pieces = len(alike)
    products = squares.reshape(pieces, AXES, pieces, AXES)
    return np.asarray(np.einsum("bc,baca->a", alike, products) / (windows * pieces))


def likeliest_variances(
    deviance: Callable[[Array], tuple[float, Array]], begin: Array, least: Array, most: Array
) -> Array:
    """(K,) variances of least deviance, from `least` to `most`, from those to begin with; deviance: of them,
    with its gradient by their logarithms. Expectation-maximisation converges too slowly for likelihood
    ratios where the likelihood is flat (Dempster, Laird and Rubin 1977), and gives the gradient: L-BFGS-B
    (Byrd, Lu, Nocedal and Zhu, SIAM J. Sci. Comput. 16, 1995).
    """
    from scipy.optimize import minimize

    if not np.isfinite(deviance(begin)[0]):  # where a simulation diverged
        return begin
    found = minimize(
        lambda log: deviance(np.exp(log)),
        np.log(begin),
        jac=True,
        method="L-BFGS-B",
        bounds=list(zip(np.log(least), np.log(most), strict=True)),
        options={"ftol": options().variance_tolerance},
    )
    return np.asarray(np.exp(found.x))


def process_noise_gain(problem: Shooting, at: Fit) -> float:
    """2 log likelihood ratio of Gauss-Markov forces beside a fit, its parameters fixed."""
    shortest = (problem.windows.rows - 1) * problem.dt / options().process_pieces
    grid = force_grid(problem, max(options().process_piece, shortest))
    where = (problem, at.hypothesis, at.x, at.states, grid, (0, 1, 2))
    normal = force_normal_equations(*where, at.states_jacobian, at.residual)
    piece, scale = grid.block * problem.dt, force_scale(problem.boat)
    return max(
        random_forces(normal.information, normal.gradient, piece, correlation_time, scale).gain
        for correlation_time in options().process_times
    )


def measurement_noise_gain(white: Fit, aware: Shooting, at: Fit) -> float:
    """2 log likelihood ratio of Gauss-Markov measurement noise, under which `at` is, to white noise."""
    return 0.0 if aware.filter is None else white.chi2 - at.chi2 - log_determinant(aware)


def log_determinant(problem: Shooting) -> float:
    """Logarithm of the determinant of the covariance of standardised measurements, 0 for white noise."""
    if problem.filter is None:
        return 0.0
    scale = problem.filter.scale
    return -2.0 * float(np.log(scale[scale > 0.0]).sum())


@dataclass(frozen=True)
class ModelError:
    """Windows weighted by the model error, and the fit whose residual it was estimated from.

    errors: (6, 3) standard deviation [the channel's unit] of the residual, 0 where nothing was measured, its
    correlation time [s], and 1 for the white noise beside it.
    """

    problem: Shooting
    fit: Fit
    errors: Array

    @property
    def run_set(self) -> RunSet:
        """The runs with the model error as Gauss-Markov noise."""
        return replace(self.problem.run_set, gauss_markov=self.errors)

    @property
    def volume(self) -> float:
        """Sum of the logarithms of the standard deviations."""
        sizes = self.errors[:, 0]
        return float(np.log(sizes[sizes > 0.0]).sum())


def model_error(
    run_set: RunSet, weight: Array, hypothesis: Hypothesis, x: Array, longest: float | None = None
) -> ModelError:
    """Windows weighted by the standard deviation of each channel's residual, one for north and east, no
    longer than `longest` [s], `model_error_window` by default, nor so long that they are too few.

    Weights are divided by the root of the residual's integrated autocorrelation time, so that chi2 counts
    independent samples. weight: (R, T, 6); x: (p,).
    """
    every = float(run_set.lengths.sum() * run_set.dt)
    seconds = min(longest or options().model_error_window, every / options().model_error_windows)
    seen = weight > 0
    sigma = 1.0 / np.where(seen.any(axis=(0, 1)), weight.max(axis=(0, 1)), 1.0)
    problem = Shooting(run_set, seen / sigma, seconds)
    states = first_states(problem, hypothesis, x, problem.initial_states())
    steps = options().check_steps
    for _ in range(options().model_error_rounds):
        made = fit(problem, hypothesis, x, states, steps)
        x, states = made.x, made.states
        sigma = sigma * residual_rms(problem, made)
        problem = Shooting(run_set, seen / sigma, seconds)
    samples = correlation_samples(
        problem.windows.by_channel(fit(problem, hypothesis, x, states, steps).residual)
    )
    problem = Shooting(run_set, seen / (sigma * np.sqrt(samples)), seconds)
    problem.correlation_samples = samples
    sizes = np.where(seen.any(axis=(0, 1)), sigma, 0.0)
    times = np.full(len(CHANNELS), 0.5 * samples * run_set.dt)
    made = fit(problem, hypothesis, x, states, steps)
    return ModelError(problem, made, np.column_stack([sizes, times, np.ones(len(CHANNELS))]))


def in_noise_units(at: Fit, problem: Shooting, weight: Array) -> Fit:
    """A fit with its residual in standard deviations of the noise that gives weight (R, T, 6)."""
    own, noise = (np.maximum(one.max(axis=(0, 1)), 1e-12) for one in (problem.weight, weight))
    residual = at.residual.reshape(len(at.residual), -1, len(CHANNELS)) * (noise / own)
    return replace(at, residual=residual.reshape(at.residual.shape))


def residual_rms(problem: Shooting, at: Fit) -> Array:
    """(6,) root mean square residual of each channel in standard deviations; 1 where nothing was measured."""
    seen = problem.windows.weight[:, problem.windows.pad :] > 0
    count = seen.sum(axis=(0, 1))
    power = (problem.windows.by_channel(at.residual) ** 2).sum(axis=(0, 1)) / np.maximum(count, 1)
    power[POSITIONS] = power[POSITIONS].mean()
    return np.where(count > 0, np.sqrt(np.maximum(power, 1e-12)), 1.0)


def correlation_samples(errors: Array) -> float:
    """Integrated autocorrelation time in samples, 1 for white noise: 1 + 2 times the sum of autocorrelations
    up to the first negative one, mean over the channels of errors (W, T, 6).
    """
    errors = errors[..., (errors != 0.0).any(axis=(0, 1))]
    if not errors.size:
        return 1.0
    power = (errors**2).sum(axis=(0, 1))
    total, alive = np.ones_like(power), np.ones(power.shape, dtype=bool)
    for lag in range(1, errors.shape[1] // 2):
        share = (errors[:, lag:] * errors[:, :-lag]).sum(axis=(0, 1)) / power
        alive &= share > 0.0
        if not alive.any():
            break
        total += 2.0 * np.where(alive, share, 0.0)
    return float(total.mean())
