"""Selection of effects from printed figures, by least squares and the marginal likelihood."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis, candidates, hull_nuisance, joined
from swamp_rl.criticism.options import options
from swamp_rl.printed_figures.predict import Fleet, misfits, predicted
from swamp_rl.printed_figures.schema import Figure, Particular

Array = NDArray[np.float64]

STATED = ("mass",)  # given with every figure
NOWHERE = np.zeros(0)

Priors = Mapping[tuple[str, str], Particular]


@dataclass(frozen=True)
class Fitted:
    """A fitted hypothesis: x (p,) and its covariance (p, p).

    chi2: of the figures alone; evidence: −2 log of the marginal likelihood, less that of the printed errors,
    plus the penalty for the choice.
    """

    hypothesis: Hypothesis
    x: Array
    covariance: Array
    chi2: float
    evidence: float

    def beside(self, instance: EffectInstance, own: Array) -> tuple[Hypothesis, Array]:
        """These effects and one more with parameters `own` (q,): the hypothesis and all parameters."""
        return joined([*self.hypothesis.parts(self.x), (instance, own)])


@dataclass(frozen=True)
class Stage:
    """The search on one set of figures.

    fits: all, the most likely first; rivals: those that figures and particulars do not separate from the
    first; plain: as fits, from the figures alone; unseen: labels of effects that change no figure; adequate:
    whether chi2 of the first is below its quantile LEVEL.
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


def instances_of(boat: Boat) -> list[EffectInstance]:
    """The boat's own effects of forces and actuators that act on steady figures."""
    hull = hull_nuisance(boat)
    every = [*candidates(boat, 1.0), *([hull] if hull else [])]
    return [
        instance
        for instance in every
        if instance.effect.acts_on in ("force", "actuator")
        and instance.specs
        and not instance.effect.weather
        and instance.effect.steady
        and instance.effect.name not in STATED
    ]


def priors_of(particulars: Sequence[Particular]) -> Priors:
    """By effect and parameter."""
    return {(one.effect, one.parameter): one for one in particulars}


@dataclass(frozen=True)
class Problem:
    """Figures, the boat at their loads, and the priors of the effects' parameters."""

    fleet: Fleet
    figures: tuple[Figure, ...]
    priors: Priors

    def prior(self, hypothesis: Hypothesis) -> tuple[Array, Array]:
        """(p,) mean and (p,) standard deviation, infinite where there is no Gaussian prior."""
        mean, precision = hypothesis.prior()
        deviation = np.where(precision > 0.0, 1.0 / np.sqrt(np.maximum(precision, 1e-300)), math.inf)
        places = (
            (instance.effect.name, name)
            for instance in hypothesis.instances
            for name in instance.effect.parameter_names
        )
        for i, place in enumerate(places):
            if place in self.priors:
                mean[i], deviation[i] = self.priors[place].value, self.priors[place].error
        return mean, deviation

    def misfits(self, hypothesis: Hypothesis, x: Array) -> Array:
        """(n,) of the figures, in errors."""
        return misfits(self.figures, predicted(self.fleet, self.figures, hypothesis, x))

    def fit(self, hypothesis: Hypothesis, starts: Sequence[Array], charge: float = 0.0) -> Fitted:
        """The maximum posterior, begun from each of `starts` (p,); charge: for the choice of the effects."""
        from scipy.optimize import least_squares

        if not hypothesis.size:
            chi2 = float((self.misfits(hypothesis, NOWHERE) ** 2).sum())
            return Fitted(hypothesis, NOWHERE, np.zeros((0, 0)), chi2, chi2 + charge)
        low, high = hypothesis.bounds()
        mean, deviation = self.prior(hypothesis)
        scale = hypothesis.scales
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
                diff_step=options().figure_step,
                max_nfev=options().figure_evaluations,
                ftol=options().figure_tolerance,
                xtol=options().figure_tolerance,
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
            2.0 * float(best.cost) + laplace_term(information, deviation, high - low) + charge,
        )


def laplace_term(information: Array, deviation: Array, width: Array) -> float:
    """Laplace's approximation of −2 log ∫ L(x) p(x) dx, less the minimum of −2 log (L p'), p' the Gaussian
    factors without their norm.

    log det(J'J / 2π) − 2 Σ log(1 / norm): a Gaussian prior of that deviation, or a uniform one over the width
    of the bounds. A direction without information contributes nothing.
    """
    norm = np.where(np.isfinite(deviation), deviation * math.sqrt(2.0 * math.pi), width)
    scaled = information * np.outer(norm, norm) / (2.0 * math.pi)
    eigenvalues = np.linalg.eigvalsh(scaled)
    return float(np.log(np.maximum(eigenvalues, 1.0)).sum())


def stage_of(
    problem: Problem, groups: tuple[str, ...], base: Fitted, instances: Sequence[EffectInstance]
) -> Stage:
    """The search on top of `base`: no further effect, one, and more where no one is adequate."""
    named = {instance.label for instance in base.hypothesis.instances}
    free = [instance for instance in instances if instance.label not in named]
    seen, unseen = identifiable_in(problem, base, free)
    before = problem.fit(base.hypothesis, [base.x])
    fits = fits_by_evidence(problem, before, seen)
    winner = fits[0]
    plain = fits
    if problem.priors:
        alone = Problem(problem.fleet, problem.figures, {})
        plain = fits_by_evidence(alone, alone.fit(base.hypothesis, [base.x]), seen)
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


def identifiable_in(
    problem: Problem, base: Fitted, instances: Sequence[EffectInstance]
) -> tuple[list[EffectInstance], list[str]]:
    """The instances that change a figure, beside those of the base, and the labels of the others."""
    plain, seen, unseen = problem.misfits(base.hypothesis, base.x), [], list[str]()
    for instance in instances:
        moved = 0.0
        for start in starts_of(instance)[:1]:
            for step in (0.0, 0.5):
                together = base.beside(instance, start + step * instance.scales)
                moved = max(moved, float(np.abs(problem.misfits(*together) - plain).max()))
        if moved > options().least_change:
            seen.append(instance)
        else:
            unseen.append(instance.label)
    return seen, unseen


def fits_by_evidence(problem: Problem, before: Fitted, instances: Sequence[EffectInstance]) -> list[Fitted]:
    """`before` and its extensions by one of the instances, the most likely first; further instances beside
    the `figure_sets` most likely sets, up to `figure_effects`, until one is adequate.
    """
    fits, sets = [before], [before]
    for size in range(1, options().figure_effects + 1):
        larger: dict[Hypothesis, Fitted] = {}
        for one in sets:
            for instance in instances:
                hypothesis = one.hypothesis.with_instance(instance)
                if instance not in one.hypothesis.instances and hypothesis not in larger:
                    larger[hypothesis] = added(problem, one, instance, size, len(instances))
        fits += larger.values()
        if any(one.chi2 <= enough(problem, one) for one in fits):
            break
        sets = sorted(larger.values(), key=lambda one: one.evidence)[: options().figure_sets]
    return sorted(fits, key=lambda one: one.evidence)


def added(problem: Problem, before: Fitted, instance: EffectInstance, size: int, count: int) -> Fitted:
    """`before` and one more instance, all fitted; charged as `size` chosen among `count` (extended BIC)."""
    starts = starts_of(instance)[: options().figure_starts if size == 1 else 1]
    begun = [before.beside(instance, own) for own in starts]
    charge = 2.0 * math.log(math.comb(count, size))
    return problem.fit(begun[0][0], [x for _, x in begun], charge)


def starts_of(instance: EffectInstance) -> list[Array]:
    """Starting points of an instance's fit, each (p,)."""
    return [np.array(start, float) for start in (instance.starts or instance.grid)]


def enough(problem: Problem, one: Fitted) -> float:
    """Quantile `figures_level` of chi2 with the degrees of freedom that this fit leaves."""
    from scipy.stats import chi2

    free = int(np.isinf(problem.prior(one.hypothesis)[1]).sum())
    return float(chi2.ppf(options().figures_level, max(len(problem.figures) - free, 1)))


def rivals_of(fits: Sequence[Fitted]) -> list[Fitted]:
    """Fits within `strong_evidence` of the first, except extensions of it."""
    first = fits[0]
    mine = set(first.hypothesis.instances)
    return [
        one
        for one in fits[1:]
        if one.evidence - first.evidence < options().strong_evidence
        and not mine < set(one.hypothesis.instances)
    ]
