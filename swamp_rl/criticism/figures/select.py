"""Which effects explain printed figures: least squares for every candidate, and the marginal likelihood."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.candidates import NOT_CAUSES, Atom, Hypothesis, candidates, hull_nuisance
from swamp_rl.criticism.figures.predict import Fleet, misfits, predicted
from swamp_rl.criticism.figures.schema import Figure, Particular

Array = NDArray[np.float64]

WEATHER = ("current", "drifting_current", "wind", "waves", "external_force", "shallow_water")
NOT_STEADY = ("thruster_failure", "thrust_sag", "azimuth_lag", "pump_lag", "yaw_inertia")
STATED = ("mass",)  # every figure says its own
APART = 6.0  # of −2 log marginal likelihood: strong evidence (Kass and Raftery 1995)
LEVEL = 0.95  # of chi2, below which a model is adequate
MOVED = 0.01  # errors by which a candidate must move some figure to be seen in it
STARTS = 2
KEPT = 4  # sets that a further effect is tried beside
MOST_ADDED = 3  # effects in a stage
EVALUATIONS = 30
NOWHERE = np.zeros(0)

Priors = Mapping[tuple[str, str], Particular]


@dataclass(frozen=True)
class Fitted:
    """A hypothesis at its best: x (p,) and its covariance (p, p).

    chi2: of the figures alone; evidence: −2 log of the marginal likelihood, less that of the printed errors,
    with the charge for its choice; at_bound: (p,) numbers that ended at the edge of what is tried.
    """

    hypothesis: Hypothesis
    x: Array
    covariance: Array
    chi2: float
    evidence: float
    at_bound: NDArray[np.bool_]


@dataclass(frozen=True)
class Stage:
    """The search on one set of figures.

    fits: all, the most likely first; rivals: those that the figures and particulars do not tell from the
    first; plain: as fits, from the figures alone; unseen: labels of effects that no figure shows; adequate:
    whether chi2 of the first is what the printed errors make of a right model.
    """

    groups: tuple[str, ...]
    figures: tuple[Figure, ...]
    before: Fitted
    fits: tuple[Fitted, ...]
    rivals: tuple[Fitted, ...]
    plain: tuple[Fitted, ...]
    unseen: tuple[str, ...]
    adequate: bool

    @property
    def winner(self) -> Fitted:
        """The most likely."""
        return self.fits[0]


def atoms_of(boat: Boat) -> list[Atom]:
    """Effects of forces and actuators that are the boat's own and act on steady figures."""
    left_out = (*NOT_CAUSES, *WEATHER, *NOT_STEADY, *STATED)
    hull = hull_nuisance()
    every = [*candidates(boat, 1.0), *([hull] if hull else [])]
    return [
        atom
        for atom in every
        if atom.effect.acts_on in ("force", "actuator") and atom.specs and atom.effect.name not in left_out
    ]


def priors_of(particulars: Sequence[Particular]) -> Priors:
    """By effect and parameter."""
    return {(one.effect, one.parameter): one for one in particulars}


@dataclass(frozen=True)
class Problem:
    """Figures, the boat at their loads, and what is known of the effects' numbers."""

    fleet: Fleet
    figures: tuple[Figure, ...]
    priors: Priors

    def prior(self, hypothesis: Hypothesis) -> tuple[Array, Array]:
        """(p,) mean and (p,) standard deviation of every number, infinite where nothing is known."""
        mean, precision = hypothesis.prior()
        deviation = np.where(precision > 0.0, 1.0 / np.sqrt(np.maximum(precision, 1e-300)), math.inf)
        places = ((atom.effect.name, name) for atom in hypothesis.atoms for name in atom.names)
        for i, place in enumerate(places):
            if place in self.priors:
                mean[i], deviation[i] = self.priors[place].value, self.priors[place].error
        return mean, deviation

    def misfits(self, hypothesis: Hypothesis, x: Array) -> Array:
        """(n,) of the figures, in errors."""
        return misfits(self.figures, predicted(self.fleet, self.figures, hypothesis, x))

    def fit(self, hypothesis: Hypothesis, starts: Sequence[Array], charge: float = 0.0) -> Fitted:
        """The hypothesis at its most likely numbers, begun from each of `starts` (p,); charge: for its
        choice.
        """
        from scipy.optimize import least_squares

        if not hypothesis.size:
            chi2 = float((self.misfits(hypothesis, NOWHERE) ** 2).sum())
            return Fitted(hypothesis, NOWHERE, np.zeros((0, 0)), chi2, chi2 + charge, np.zeros(0, bool))
        low, high = hypothesis.bounds()
        mean, deviation = self.prior(hypothesis)
        scale = np.array([spec.scale for spec in hypothesis.specs])
        inside = 1e-6 * np.minimum(scale, high - low)

        def residuals(x: Array) -> Array:
            return np.concatenate([self.misfits(hypothesis, x), (x - mean) / deviation])

        best = None
        for start in starts:
            x = np.clip(start, low + inside, high - inside)
            found = least_squares(
                residuals,
                x,
                bounds=(low, high),
                x_scale=scale,
                diff_step=1e-4,
                max_nfev=EVALUATIONS,
            )
            if best is None or found.cost < best.cost:
                best = found
        assert best is not None
        information = best.jac.T @ best.jac
        chi2 = float((best.fun[: len(self.figures)] ** 2).sum())
        return Fitted(
            hypothesis,
            best.x,
            np.linalg.pinv(information),
            chi2,
            2.0 * float(best.cost) + occam(information, deviation, high - low) + charge,
            (best.x - low < 10.0 * inside) | (high - best.x < 10.0 * inside),
        )


def occam(information: Array, deviation: Array, width: Array) -> float:
    """What Laplace's approximation of −2 log ∫ L(x) p(x) dx adds to the minimum of −2 log (L p'), p' the
    Gaussian factors without their norm.

    log det(J'J / 2π) − 2 Σ log(1 / norm): a Gaussian prior of that deviation, or a uniform one over the width
    of the bounds. A direction that no figure shows costs nothing.
    """
    norm = np.where(np.isfinite(deviation), deviation * math.sqrt(2.0 * math.pi), width)
    scaled = information * np.outer(norm, norm) / (2.0 * math.pi)
    eigenvalues = np.linalg.eigvalsh(scaled)
    return float(np.log(np.maximum(eigenvalues, 1.0)).sum())


def stage_of(problem: Problem, groups: tuple[str, ...], base: Fitted, atoms: Sequence[Atom]) -> Stage:
    """The search on top of `base`: no further effect, one, and more where no one is adequate."""
    named = {atom.label for atom in base.hypothesis.atoms}
    free = [atom for atom in atoms if atom.label not in named]
    seen, unseen = seen_of(problem, base, free)
    before = problem.fit(base.hypothesis, [base.x])
    fits = searched(problem, before, seen)
    winner = fits[0]
    alone = Problem(problem.fleet, problem.figures, {})
    plain = searched(alone, alone.fit(base.hypothesis, [base.x]), seen)
    return Stage(
        groups,
        problem.figures,
        before,
        tuple(fits),
        tuple(rivals_of(fits)),
        tuple(plain),
        tuple(unseen),
        winner.chi2 <= enough(problem, winner),
    )


def seen_of(problem: Problem, base: Fitted, atoms: Sequence[Atom]) -> tuple[list[Atom], list[str]]:
    """The atoms that move a figure, beside what is in the base already, and the labels of the others."""
    plain, seen, unseen = problem.misfits(base.hypothesis, base.x), [], list[str]()
    for atom in atoms:
        together = base.hypothesis.with_atom(atom)
        moved = 0.0
        for start in begun(atom)[:1]:
            for step in (0.0, 0.5):
                own = start + step * np.array([spec.scale for spec in atom.specs])
                x = placed(together, base, {atom.label: own})
                moved = max(moved, float(np.abs(problem.misfits(together, x) - plain).max()))
        if moved > MOVED:
            seen.append(atom)
        else:
            unseen.append(atom.label)
    return seen, unseen


def searched(problem: Problem, before: Fitted, atoms: Sequence[Atom]) -> list[Fitted]:
    """`before` and what adds one of the atoms to it, the most likely first; further atoms beside the KEPT
    most likely sets, up to MOST_ADDED, until one is adequate.
    """
    fits, sets = [before], [before]
    for size in range(1, MOST_ADDED + 1):
        larger: dict[Hypothesis, Fitted] = {}
        for one in sets:
            for atom in atoms:
                hypothesis = one.hypothesis.with_atom(atom)
                if atom not in one.hypothesis.atoms and hypothesis not in larger:
                    larger[hypothesis] = added(problem, one, atom, size, len(atoms))
        fits += larger.values()
        if any(one.chi2 <= enough(problem, one) for one in fits):
            break
        sets = sorted(larger.values(), key=lambda one: one.evidence)[:KEPT]
    return sorted(fits, key=lambda one: one.evidence)


def added(problem: Problem, before: Fitted, atom: Atom, size: int, count: int) -> Fitted:
    """`before` with an atom beside it, all numbers fitted anew; charged as `size` chosen among `count` atoms
    (extended BIC).
    """
    hypothesis = before.hypothesis.with_atom(atom)
    starts = begun(atom)[: STARTS if size == 1 else 1]
    charge = 2.0 * math.log(math.comb(count, size))
    return problem.fit(hypothesis, [placed(hypothesis, before, {atom.label: own}) for own in starts], charge)


def begun(atom: Atom) -> list[Array]:
    """Where a fit of the atom begins, each (p,)."""
    return [np.array(start, float) for start in (atom.starts or atom.grid)]


def placed(hypothesis: Hypothesis, before: Fitted, own: Mapping[str, Array]) -> Array:
    """(p,) the numbers of `before` where they are, and those of the atoms that are new."""
    known = {atom.label: x for atom, x in before.hypothesis.parts(before.x)} | dict(own)
    return np.concatenate([NOWHERE, *(known[atom.label] for atom in hypothesis.atoms)])


def enough(problem: Problem, one: Fitted) -> float:
    """chi2 that a right model of that many free numbers stays below in LEVEL of all cases."""
    from scipy.stats import chi2

    free = int(np.isinf(problem.prior(one.hypothesis)[1]).sum())
    return float(chi2.ppf(LEVEL, max(len(problem.figures) - free, 1)))


def rivals_of(fits: Sequence[Fitted]) -> list[Fitted]:
    """Those beside the first, less what only adds to it, that are not APART from it."""
    first = fits[0]
    mine = set(first.hypothesis.atoms)
    return [
        one
        for one in fits[1:]
        if one.evidence - first.evidence < APART and not mine < set(one.hypothesis.atoms)
    ]
