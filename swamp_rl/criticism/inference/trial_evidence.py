"""Expected evidence of a trial that is yet to be sailed: between hypotheses, or about one parameter."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.data.windows import Windows
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian, state_jacobian
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.normal_equations import normal_equations
from swamp_rl.criticism.likelihood.output_error import Fit, fit, inverse, losses, prior_penalty
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.scales import window_lengths
from swamp_rl.criticism.model.trial_limits import TrialLimits, rows_within, shortest_trial
from swamp_rl.criticism.options import options
from swamp_rl.simulator import initial_state, simulate, tank
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.substeps import steps_over, substeps_of

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


@dataclass(frozen=True)
class Explanation:
    """A hypothesis of the next run, its parameters x (p,) and what is known of them: precision (p, p)."""

    label: str
    hypothesis: Hypothesis
    x: Array
    precision: Array


@dataclass(frozen=True)
class Question:
    """What a trial is to decide.

    explanations: those that it is to separate, or the one that `column` is a parameter of, whose interval it
    is to narrow; run_set: the boat, the sample step and the Gauss-Markov noise; sigmas: (6,) standard
    deviation of the white noise.
    """

    run_set: RunSet
    sigmas: Array
    explanations: tuple[Explanation, ...]
    column: int | None = None


@dataclass(frozen=True)
class Rated:
    """Of W trials: tracks (H, W, T, 6), the true motion under each explanation; rows: (W,) until a limit is
    exceeded; evidence: (H, H, W) of those rows, [a, b] where a is true and b is fitted, or (1, 1, W) about
    the parameter; steps: of boats that were simulated.
    """

    tracks: Array
    rows: Rows
    evidence: Array
    steps: int

    @property
    def least(self) -> Array:
        """(W,) the least evidence of any pair."""
        size = len(self.evidence)
        pairs = ~np.eye(size, dtype=bool) if size > 1 else np.ones((1, 1), dtype=bool)
        return np.asarray(self.evidence[pairs].min(axis=0))


def explanation_of(at: Fit, covariance: Array) -> Explanation:
    """A fit with covariance (p, p) for another run, with the variance of what differs between runs."""
    hypothesis, x, columns = at.hypothesis.of_run(at.x, 0)
    between = [np.zeros(0)]
    for instance, own in at.hypothesis.parts(at.x):
        values = instance.by_group(own)
        between.append(values.var(axis=0, ddof=1) if instance.count > 1 else np.zeros(values.shape[1]))
    known = covariance[np.ix_(columns, columns)] + np.diag(np.concatenate(between))
    return Explanation(at.hypothesis.cause_label, hypothesis, x, inverse(known))


def rate(question: Question, commands: Array, limits: TrialLimits) -> Rated:
    """Expected evidence of trials from rest, bow to the north, under commands (W, T, 2K).

    Evidence between a and b: squared distance of their predictions in standard deviations of the noise,
    minimised over b's initial states and, with their posterior as prior, its linearised parameters; twice the
    expected difference of log likelihood (T-optimality: Atkinson and Fedorov, Biometrika 62, 1975). About a
    parameter: what the trial adds to its information, as a multiple of what is known, the other parameters
    and the initial states eliminated (D_s-optimality). Every explanation starts from the motion under the
    first one at the beginning of each middle window, since over a longer time an unstable
    boat magnifies differences beyond what is linear.
    """
    tracks = np.stack([_track(question.run_set, one, commands) for one in question.explanations])
    rows = rows_within(limits, tracks, question.run_set.boat.length)
    problem = _problem(question, commands)
    win = problem.windows
    seen = win.first[:, None] + np.arange(win.rows) < rows[win.run][:, None]
    states = np.nan_to_num(tracks[0][win.run, win.first])
    answers = [_response(problem, one, states, seen) for one in question.explanations]
    size = len(answers)
    evidence = np.zeros((size, size, len(commands)))
    if question.column is not None:
        evidence[0, 0] = _information(answers[0], question.explanations[0], question.column, len(commands))
    for a, b in permutations(range(size), 2):
        apart = answers[a].base - answers[b].base
        apart[..., 2] = within_half_turn(apart[..., 2])
        residual = problem.standardised(apart) * answers[b].seen
        evidence[a, b] = _distance(residual, answers[b], question.explanations[b], len(commands))
    steps = commands.shape[0] * commands.shape[1] * size + problem.boat_steps[0]
    return Rated(tracks, rows, evidence, steps)


@dataclass(frozen=True)
class KnownBefore(Hypothesis):
    """A hypothesis whose parameters have a Gaussian prior of mean (p,) and precision (p, p)."""

    mean: Array = field(default_factory=lambda: np.zeros(0), compare=False)
    precision: Array = field(default_factory=lambda: np.zeros((0, 0)), compare=False)

    def prior(self) -> tuple[Array, Array]:
        """(p,) mean and (p,) diagonal of the precision."""
        return self.mean, np.diag(self.precision)

    @property
    def prior_precision(self) -> Array:
        """(p, p) inverse covariance."""
        return self.precision


def refitted(
    question: Question, commands: Array, rated: Rated, count: int, known: Sequence[float] = ()
) -> tuple[Array, int]:
    """(W,) evidence between the two nearest explanations, of trials under commands (W, T, 2K) that `rate` has
    rated, and the boats' steps: as there, but with the other's initial states and parameters fitted to the
    motion, which is linear in them neither over a window of an unstable boat nor in a wind or a small gain.

    Trials are refitted in the order of their linearised evidence until `count` of them, with evidence already
    `known` of others, exceed the next one's; -inf for the rest, which are not among the best. It stays
    linearised about a parameter, and of trials that are too short for a diagnosis.
    """
    if question.column is not None:
        return rated.least, 0
    short = rated.rows * question.run_set.dt < shortest_trial()
    evidence, used = np.where(short, rated.least, -np.inf), 0
    best = sorted(known, reverse=True)[:count]
    for trial in np.argsort(-np.where(short, -np.inf, rated.least), kind="stable")[: int((~short).sum())]:
        enough = best[-1] if len(best) == count else -np.inf
        if rated.least[trial] <= enough:
            break
        rows = commands[trial, : rated.rows[trial]]
        evidence[trial], steps = _least_refitted(question, rows, rated.evidence[..., trial], enough)
        used += steps
        best = sorted([*best, float(evidence[trial])], reverse=True)[:count]
    return evidence, used


def _least_refitted(
    question: Question, commands: Array, linearised: Array, enough: float
) -> tuple[float, int]:
    """Least evidence of any pair under commands (T, 2K), and the boats' steps; at or below `enough` the least
    of all is not sought, nor a pair whose linearised (H, H) evidence exceeds another's.
    """
    least, used = math.inf, 0
    pairs = permutations(range(len(question.explanations)), 2)
    for a, b in sorted(pairs, key=lambda pair: float(linearised[pair])):
        if linearised[a, b] >= least or least <= enough:
            break
        own, steps = refitted_pair(question, commands, a, b)
        least, used = min(least, own), used + steps
    return least, used


def refitted_pair(question: Question, commands: Array, true: int, other: int) -> tuple[float, int]:
    """Evidence between two explanations in one trial from rest under commands (T, 2K), the other fitted to
    the motion of the true one, and the boats' steps; 0 where a simulation diverges.

    The fit begins at the best of several points, since from the other's own parameters it may end in a local
    minimum, which a search for the greatest evidence would find.
    """
    truth, fitted = question.explanations[true], question.explanations[other]
    ideal = _problem(question, commands[None])
    win = ideal.windows
    states = np.nan_to_num(_track(question.run_set, truth, commands[None])[win.run, win.first])
    ideal.windows = replace(win, measured=ideal.track(truth.hypothesis, truth.x, states))
    known = KnownBefore(fitted.hypothesis.instances, fitted.x, fitted.precision)
    chi2 = fit(ideal, known, _begun(ideal, known, states), states).chi2
    return max(chi2, 0.0) if math.isfinite(chi2) else 0.0, ideal.boat_steps[0] + len(commands)


def _begun(ideal: Shooting, known: KnownBefore, states: Array) -> Array:
    """(p,) the best of parameters on a line from the prior's mean through the linearised solution, and of the
    mean with one of them at a bound, where many an effect becomes another one: the states (V, 6) are held.
    """
    base = ideal.track(known, known.mean, states)
    residual, slopes = ideal.residuals(base), parameter_jacobian(ideal, known, known.mean, states, base)
    information = np.einsum("vmp,vmq->pq", slopes, slopes) + known.precision
    step = inverse(information) @ np.einsum("vmp,vm->p", slopes, residual)
    low, high = known.bounds()
    line = known.mean + np.array(options().trial_starts)[:, None] * step
    ends = np.where(np.eye(known.size, dtype=bool), np.stack([low, high])[:, None], known.mean)
    tried = np.clip(np.concatenate([line, ends.reshape(2 * known.size, known.size)]), low, high)
    tried = tried[np.isfinite(tried).all(axis=1)]
    chi2 = [
        losses(ideal.residuals(ideal.track(known, x, states))).sum() + prior_penalty(known, x) for x in tried
    ]
    return np.asarray(tried[int(np.argmin(chi2))])


@dataclass(frozen=True)
class _Response:
    """Predictions (V, T, 6) of V windows, derivatives of the standardised ones by states (V, M, 6) and x
    (V, M, p), and which of these are within the limits (V, M).
    """

    base: Array
    by_state: Array
    by_x: Array
    seen: NDArray[np.bool_]


def _track(run_set: RunSet, one: Explanation, commands: Array) -> Array:
    """(W, T, 6) true motion from rest."""
    records = np.repeat(one.hypothesis.records(run_set.boat, one.x[None]), len(commands))
    start = initial_state(records, np.zeros((len(commands), 3)))
    start[:, ACTUATORS : ACTUATORS + commands.shape[2]] = commands[:, 0]
    seeds = np.zeros(len(commands), np.uint64)
    boat, dt = run_set.boat, run_set.dt
    track = simulate(records, tank(boat), start, commands[:, :-1], seeds, dt, substeps_of(dt, boat))
    return np.asarray(track[..., :6])


def _problem(question: Question, commands: Array) -> Shooting:
    """The trials (W, T, 2K) cut in equal middle windows, W by W, from where a diagnosis begins to compare."""
    trials, steps = commands.shape[:2]
    run_set = question.run_set
    names = tuple(map(str, range(trials)))
    sailed = names, commands, np.zeros((trials, steps, 6)), np.full(trials, steps)
    planned = RunSet(run_set.boat, run_set.dt, *sailed, gauss_markov=run_set.gauss_markov)
    weight = np.where(np.isfinite(question.sigmas), 1.0 / question.sigmas, 0.0)
    transient = steps_over(options().least_transient, run_set.dt)
    pieces = max(1, round((steps - transient) * run_set.dt / window_lengths(run_set.boat)[1]))
    length = (steps - transient) // pieces
    weights = np.tile(weight, (trials * pieces, length, 1))
    run = np.repeat(np.arange(trials), pieces)
    first = np.tile(transient + length * np.arange(pieces), trials)
    windows = Windows(run, first, np.full(len(run), length - 1), np.zeros_like(weights), weights, 0, length)
    problem = Shooting(planned, np.broadcast_to(weight, planned.measured.shape), np.inf, windows)
    problem.substeps = substeps_of(run_set.dt, run_set.boat)
    return problem


def _response(problem: Shooting, one: Explanation, states: Array, seen: NDArray[np.bool_]) -> _Response:
    """From the states (V, 6) at the windows' starts; what is not `seen` (V, T) has no derivative."""
    base = problem.track(one.hypothesis, one.x, states)
    by_state = state_jacobian(problem, one.hypothesis, one.x, states, base)
    by_x = parameter_jacobian(problem, one.hypothesis, one.x, states, base)
    channels = np.repeat(seen, base.shape[2], axis=1) & np.isfinite(by_state).all(axis=2)
    return _Response(base, by_state * channels[..., None], by_x * channels[..., None], channels)


def _distance(residual: Array, fitted: _Response, one: Explanation, trials: int) -> Array:
    """(W,) squared residuals (V, M) that remain once an explanation is fitted to each trial."""
    normal = normal_equations(fitted.by_state, fitted.by_x, residual)
    left = _by_trial(normal.profile_chi2, trials)
    if not one.hypothesis.size:
        return np.maximum(np.nan_to_num(left), 0.0)
    gradients = _by_trial(normal.gradient, trials)
    for trial, added in enumerate(_by_trial(normal.information, trials)):
        left[trial] -= gradients[trial] @ inverse(one.precision + added) @ gradients[trial]
    return np.maximum(np.nan_to_num(left), 0.0)


def _information(response: _Response, one: Explanation, column: int, trials: int) -> Array:
    """(W,) what the trials add to the information about a parameter, as a multiple of what is known."""
    none = np.zeros(response.seen.shape)
    added = _by_trial(normal_equations(response.by_state, response.by_x, none).information, trials)
    before = inverse(one.precision)[column, column]
    after = np.array([inverse(one.precision + own)[column, column] for own in added])
    return np.maximum(np.nan_to_num(before / after - 1.0), 0.0)


def _by_trial(values: Array, trials: int) -> Array:
    """(W, ...) sums over the windows of each trial of values (V, ...)."""
    return np.asarray(values.reshape(trials, -1, *values.shape[1:]).sum(axis=1))
