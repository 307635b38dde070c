"""The score test: what each further candidate would explain, told from one Jacobian without refitting."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.candidates import FAILURE, WAVES, Atom, Hypothesis
from swamp_rl.criticism.fit import Fit, bounded_step, inverse, normal_equations
from swamp_rl.criticism.harmonic import wave_starts
from swamp_rl.criticism.settle import settle
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]

INSTANTS = 17  # looked at about the best one
BATCH = 24  # points of a grid rolled out at once
GROSS = 2.0  # chi2 a sample beyond which a cause is large: if it has no number, starts are settled for it
ROUNDS = 3  # steps that these are given
BESIDE = 1e-3  # typical sizes beside a value that changes nothing, where some slopes do not exist


@dataclass(frozen=True)
class Prospect:
    """An atom beside a hypothesis: the joint start (p,) and (W, 6), the chi2 it promises, and how well it
    can be seen.

    seen: (p_atom,) information about each of the atom's numbers alone, times its typical size squared: below
    about 10 the data cannot show it.
    """

    hypothesis: Hypothesis
    atom: Atom
    x: Array
    states: Array
    promised: float
    seen: float


def prospects(problem: Shooting, at: Fit, atoms: Sequence[Atom]) -> list[Prospect]:
    """Prospects of every atom beside `at`, the most promising first; those that the data cannot see are
    last.
    """
    own = {atom.label for atom in at.hypothesis.atoms}
    by_x = problem.parameter_jacobian(
        at.hypothesis, at.x, at.states, problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    )
    found = [_prospect(problem, at, atom, by_x) for atom in atoms if atom.label not in own]
    return sorted(found, key=lambda one: one.promised)


def _prospect(problem: Shooting, at: Fit, atom: Atom, by_x: Array) -> Prospect:
    hypothesis = at.hypothesis.with_atom(atom)
    place = _columns_of(hypothesis, atom)
    starts: list[tuple[float, ...]] = [*atom.starts]
    if atom.effect.name == WAVES:
        starts = [tuple(start) for start in wave_starts(problem, at, by_x)]
    elif atom.effect.name == FAILURE:
        starts = failure_starts(problem, at, hypothesis, atom, by_x)
    elif atom.size > 0:
        if atom.grid:
            starts.append(atom.grid[_best_of_grid(problem, at, atom, hypothesis, place, by_x)])
        if at.chi2 < GROSS * problem.samples:  # what is left is small, and so is its cause
            starts += beside_nothing(atom, problem.boat).starts
    promises = [_newton(problem, at, atom, hypothesis, place, by_x, np.array(one)) for one in starts]
    if atom.size > 0 and not any(np.isfinite(one.promised) for one in promises):  # for it ran away there
        (neutral,) = beside_nothing(atom, problem.boat).starts
        if neutral not in starts:
            promises.append(_newton(problem, at, atom, hypothesis, place, by_x, np.array(neutral)))
    seen = max(one.seen for one in promises)  # the data can show a cause that they show at one of its sizes
    return replace(min(promises, key=lambda one: one.promised), seen=seen)


def beside_nothing(atom: Atom, boat: Boat) -> Atom:
    """The atom begun from what changes nothing, or hardly anything: the boat file's own numbers."""
    record = parameters(boat)
    neutral = [
        float(np.mean(record[p.field])) if p.neutral is None else p.neutral for p in atom.effect.parameters
    ]
    if atom.effect.name == "wind":  # as components
        neutral = [BESIDE * spec.scale for spec in atom.specs]
    start = tuple(float(np.clip(x, s.low, s.high)) for x, s in zip(neutral, atom.specs, strict=True))
    return replace(atom, starts=(start,), grid=())


def _columns_of(hypothesis: Hypothesis, atom: Atom) -> NDArray[np.bool_]:
    """(p,) which numbers are the atom's."""
    return np.array([one.label == atom.label for one in hypothesis.atoms for _ in one.specs], dtype=bool)


def _joint(place: NDArray[np.bool_], old: Array, new: Array) -> Array:
    """(V, p) from the old numbers (p_old,) and the atom's (V, p_atom)."""
    x = np.empty((len(new), len(place)))
    x[:, ~place] = old
    x[:, place] = new
    return x


def failure_starts(
    problem: Shooting, at: Fit, hypothesis: Hypothesis, atom: Atom, by_x: Array
) -> list[tuple[float, ...]]:
    """The best instant for a failure among the windows' starts, from one rollout: windows that begin before
    it are as if nothing had happened, the others as if the thruster had never worked.
    """
    place = _columns_of(hypothesis, atom)
    dead = problem.residuals(
        problem.predict(hypothesis, _joint(place, at.x, np.zeros((1, 1))), at.states[None])[0]
    )
    both = [normal_equations(at.states_jacobian, by_x, r) for r in (at.residual, dead)]
    times = problem.windows.first * problem.dt
    best, found = np.inf, 0.0
    for time in np.unique(times):
        failed = times >= time
        loss = float(np.where(failed, both[1].free, both[0].free).sum())
        if at.hypothesis.size:
            g = np.where(failed[:, None], both[1].gradient, both[0].gradient).sum(axis=0)
            loss -= float(g @ inverse(both[0].information.sum(axis=0)) @ g)
        if loss < best:
            best, found = loss, float(time)
    return [(_finer(problem, at, hypothesis, place, found),)]


def _finer(
    problem: Shooting,
    at: Fit,
    hypothesis: Hypothesis,
    place: NDArray[np.bool_],
    found: float,
) -> float:
    """The best instant about `found` [s], from rollouts of the windows about it alone."""
    win = problem.windows
    length = win.rows * problem.dt
    begins, ends = win.first * problem.dt, (win.first + win.steps) * problem.dt
    times = np.maximum(found + np.linspace(-length, length, INSTANTS), 0.0)
    near = (begins < times[-1]) & (ends > times[0])
    x = _joint(place, at.x, times[:, None])
    states = np.broadcast_to(at.states[near], (len(x), near.sum(), 6))
    left = problem.part(near).residuals(problem.part(near).predict(hypothesis, x, states))
    none = np.zeros((*at.residual[near].shape, 0))
    losses = [float(normal_equations(at.states_jacobian[near], none, r).free.sum()) for r in left]
    return float(times[int(np.argmin(losses))])


def _best_of_grid(
    problem: Shooting, at: Fit, atom: Atom, hypothesis: Hypothesis, place: NDArray[np.bool_], by_x: Array
) -> int:
    points = np.array(atom.grid)
    losses = []
    for start in range(0, len(points), BATCH):
        x = _joint(place, at.x, points[start : start + BATCH])
        states = np.broadcast_to(at.states, (len(x), *at.states.shape))
        left = problem.residuals(problem.predict(hypothesis, x, states))
        losses += [_loss_after(at, by_x, residual) for residual in left]
    return int(np.argmin(losses))


def _loss_after(at: Fit, by_x: Array, residual: Array) -> float:
    normal = normal_equations(at.states_jacobian, by_x, residual)
    loss = float(normal.free.sum())
    if not np.isfinite(loss):
        return np.inf
    if at.hypothesis.size:
        H, g = normal.information.sum(axis=0), normal.gradient.sum(axis=0)
        loss -= float(g @ np.linalg.lstsq(H, g, rcond=1e-10)[0])
    return loss


def _newton(
    problem: Shooting,
    at: Fit,
    atom: Atom,
    hypothesis: Hypothesis,
    place: NDArray[np.bool_],
    by_x: Array,
    start: Array,
) -> Prospect:
    step = np.array([spec.difference for spec in atom.specs])
    high = np.array([spec.high for spec in atom.specs])
    step = np.where(start + step > high, -step, step)
    new = np.vstack([start[None], start + np.diag(step)]) if len(step) else start[None]
    x = _joint(place, at.x, new)
    prediction = problem.predict(hypothesis, x, np.broadcast_to(at.states, (len(x), *at.states.shape)))
    states, residual = at.states, problem.residuals(prediction[0])
    if not len(step) and at.chi2 > GROSS * problem.samples:  # as large as what it should explain
        states, _, residual = settle(problem, hypothesis, x[0], at.states, ROUNDS)
    slopes = np.zeros((*residual.shape, len(place)))
    slopes[..., ~place] = by_x
    if len(step):
        change = problem.weighed((prediction[1:] - prediction[0]) / step[:, None, None, None])
        slopes[..., place] = np.moveaxis(change, 0, -1)
    normal = normal_equations(at.states_jacobian, slopes, residual)
    mean, precision = hypothesis.prior()
    H = normal.information.sum(axis=0) + np.diag(precision)
    g = normal.gradient.sum(axis=0) - precision * (x[0] - mean)
    moved = bounded_step(H, g, x[0], *hypothesis.bounds())
    loss = float(normal.free.sum() + precision @ (x[0] - mean) ** 2 - 2 * g @ moved + moved @ H @ moved)
    scale = np.array([spec.scale for spec in atom.specs])
    own = np.diag(normal.information.sum(axis=0))[place] * scale**2
    changed = float(((problem.residuals(prediction[0]) - at.residual) ** 2).sum())
    seen = float(own.max()) if len(own) else changed
    loss = loss if np.isfinite(loss) else np.inf
    seen = seen if np.isfinite(seen) else 0.0
    changed = changed if np.isfinite(changed) else 0.0
    return Prospect(hypothesis, atom, x[0], states, loss, max(seen, changed))
