"""The winner's numbers with their standard errors, in the effects' own terms."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.candidates import Atom, entries_of
from swamp_rl.criticism.fit import Fit
from swamp_rl.criticism.result import Cause, Estimate, Limit
from swamp_rl.criticism.rivals import sensitivities
from swamp_rl.criticism.shooting import Shooting

Array = NDArray[np.float64]

STRETCH = 8.0  # s of a run whose score counts as one
FEWEST = 8  # stretches from which their scatter is told
Z95 = 1.959964
AT_BOUND = 1e-3  # of a number's typical size, within which it is at its bound


def causes_of(problem: Shooting, at: Fit) -> list[Cause]:
    """Every atom of a fit as a cause."""
    covariance = honest_covariance(problem, at)
    causes = []
    start = 0
    for atom, own in at.hypothesis.parts(at.x):
        block = covariance[start : start + atom.size, start : start + atom.size]
        causes.append(_cause(atom, own, block))
        start += atom.size
    return causes


def honest_covariance(problem: Shooting, at: Fit) -> Array:
    """(p, p) of the numbers x: the information matrix's, made wider where the scores of stretches of the runs
    scatter more than white noise of the estimated size would let them (sandwich), and by Student's t for as
    many stretches as there are.
    """
    from scipy.special import stdtrit

    covariance = at.covariance
    if not at.hypothesis.size or not np.isfinite(covariance).all():
        return covariance
    win = problem.windows
    slopes = sensitivities(problem, at).reshape(win.count, win.rows, -1, at.hypothesis.size)
    scores = np.einsum("wtc,wtcp->wtp", at.residual.reshape(win.count, win.rows, -1), slopes)[:, win.pad :]
    rows = max(1, round(STRETCH / problem.dt)) if problem.lasting == 1.0 else win.rows
    starts = np.arange(0, scores.shape[1], rows)
    blocks = np.add.reduceat(scores, starts, axis=1).reshape(-1, at.hypothesis.size)
    blocks = blocks[(blocks != 0.0).any(axis=1)]
    if len(blocks) < FEWEST:
        return covariance
    away = blocks - blocks.mean(axis=0)
    spread = away.T @ away * len(blocks) / (len(blocks) - 1)
    ratio = np.diag(covariance @ spread @ covariance) / np.maximum(np.diag(covariance), 1e-300)
    wider = np.sqrt(np.maximum(ratio, 1.0)) * stdtrit(len(blocks) - 1, 0.975) / Z95
    return np.asarray(covariance * np.outer(wider, wider))


def _cause(atom: Atom, x: Array, covariance: Array) -> Cause:
    entry = entries_of(atom, x)[0]
    selector: Any = entry.thruster
    values = {name: float(value) for name, value in entry.values.items()}
    slopes = slopes_of(atom, x)
    sides = sides_of(atom, x)
    parameters = {
        name: Estimate(
            value=value,
            standard_error=float(np.sqrt(abs(slopes[name] @ covariance @ slopes[name]))),
            unit=atom.effect.parameter(name).unit,
            at_bound=bool((slopes[name] * sides).any()),
            limit=_limit(slopes[name] * sides),
        )
        for name, value in values.items()
    }
    thruster = list(selector) if isinstance(selector, tuple) else selector
    return Cause(effect=atom.effect.name, thruster=thruster, parameters=parameters)


def sides_of(atom: Atom, x: Array) -> Array:
    """(p,) -1 for each fitted number at the least that its fit may try, 1 at the most, 0 in between."""
    room = AT_BOUND * np.array([spec.scale for spec in atom.specs])
    low, high = np.array([s.low for s in atom.specs]), np.array([s.high for s in atom.specs])
    return np.asarray((x >= high - room).astype(float) - (x <= low + room))


def _limit(outwards: Array) -> Limit | None:
    """Which way a parameter would go on, from how it follows (p,) the numbers that are at their bounds."""
    ways = set(np.sign(outwards[outwards != 0.0]))
    return ("at_least" if ways == {1.0} else "at_most") if len(ways) == 1 else None


def slopes_of(atom: Atom, x: Array) -> dict[str, Array]:
    """Of each of the effect's parameters by the fitted numbers: the identity, save where they are a
    vector's.
    """
    values = {name: float(value) for name, value in entries_of(atom, x)[0].values.items()}
    slopes = {name: np.zeros(len(x)) for name in values}
    for i, spec in enumerate(atom.specs):
        moved = x.copy()
        moved[i] += 1e-6 * spec.scale
        for name, value in entries_of(atom, moved)[0].values.items():
            slopes[name][i] = (float(value) - values[name]) / (1e-6 * spec.scale)
    return slopes
