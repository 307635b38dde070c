"""Explanations that the data cannot tell apart: how alike they are, and what would separate them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.fit import Fit, fit, inverse, normal_equations
from swamp_rl.criticism.manoeuvres import LENGTH, manoeuvres
from swamp_rl.criticism.result import Contrast, Trial
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]


def contrast(problem: Shooting, winner: Fit, rival: Fit, evidence: float) -> Contrast:
    """Of two fits on the same windows; evidence: penalised chi2 by which the rival is worse."""
    return Contrast(
        effects=[winner.hypothesis.label, rival.hypothesis.label],
        angle=angle_between(problem, winner, rival),
        evidence=evidence,
        mutual_refit=max(refit(problem, winner, rival), refit(problem, rival, winner)),
    )


def sensitivities(problem: Shooting, at: Fit) -> Array:
    """(W M, p) of the predictions by the numbers, less what initial states could do as well."""
    base = problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    slopes = problem.parameter_jacobian(at.hypothesis, at.x, at.states, base)
    transposed = np.swapaxes(at.states_jacobian, 1, 2)
    A = at.normal.states_information
    off = slopes - at.states_jacobian @ np.linalg.solve(A, transposed @ slopes)
    return off.reshape(-1, at.hypothesis.size)


def angle_between(problem: Shooting, one: Fit, other: Fit) -> float:
    """Smallest principal angle [rad] between what the two can change; a right one where one has no number."""
    if not one.hypothesis.size or not other.hypothesis.size:
        return float(np.pi / 2)
    bases = [np.linalg.qr(sensitivities(problem, at))[0] for at in (one, other)]
    cosines = np.linalg.svd(bases[0].T @ bases[1], compute_uv=False)
    return float(np.arccos(np.clip(cosines.max(), -1.0, 1.0)))


def refit(problem: Shooting, truth: Fit, other: Fit) -> float:
    """Chi2 that `other`, fitted to the noise-free track of `truth`, cannot explain: what data of this
    kind can tell.
    """
    track = problem.predict(truth.hypothesis, truth.x[None], truth.states[None])[0]
    synthetic = Shooting(
        problem.trials, problem.weight, problem.seconds, replace(problem.windows, measured=track)
    )
    return float(fit(synthetic, other.hypothesis, other.x, other.states, 4).loss.sum())


def separating_trial(trials: Trials, sigmas: Array, winner: Fit, rivals: list[Fit]) -> Trial:
    """The manoeuvre whose track tells the winner from its nearest rival best, in standard errors."""
    names, commands = zip(*manoeuvres(trials.boat, trials.dt).items(), strict=True)
    steps = len(commands[0])
    planned = Trials(
        trials.boat,
        trials.dt,
        names,
        np.array(commands),
        np.zeros((len(names), steps, 6)),
        np.full(len(names), steps),
        slow=trials.slow,
    )
    weight = np.broadcast_to(np.where(np.isfinite(sigmas), 1.0 / sigmas, 0.0), planned.measured.shape)
    problem = Shooting(planned, weight, np.inf)
    at_rest = np.zeros((len(names), 6))
    truth = problem.predict(winner.hypothesis, winner.x[None], at_rest[None])[0]
    problem.windows = replace(problem.windows, measured=truth)
    apart = np.min([_separations(problem, rival, at_rest) for rival in rivals], axis=0)
    best = int(apart.argmax())
    return Trial(manoeuvre=names[best], separation=float(apart[best]), duration_s=LENGTH)


def _separations(problem: Shooting, rival: Fit, states: Array) -> Array:
    """(W,) standard errors between the truth and a rival that may still move as far as the old data let
    it.
    """
    base = problem.predict(rival.hypothesis, rival.x[None], states[None])[0]
    residual = problem.residuals(base)
    by_state = problem.state_jacobian(rival.hypothesis, rival.x, states, base)
    by_x = problem.parameter_jacobian(rival.hypothesis, rival.x, states, base)
    normal = normal_equations(by_state, by_x, residual)
    known = inverse(rival.covariance) if rival.hypothesis.size else np.zeros((0, 0))
    left = normal.free.copy()
    for w in range(len(left)):
        if rival.hypothesis.size:
            g = normal.gradient[w]
            left[w] -= float(g @ inverse(known + normal.information[w]) @ g)
    return np.sqrt(np.maximum(left, 0.0))
