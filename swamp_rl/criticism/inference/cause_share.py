"""What each cause accounts for: its share of the prediction error, whether it carries over, and the list."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import POSITIONS, RunSet
from swamp_rl.criticism.inference.estimate import causes_of
from swamp_rl.criticism.likelihood.cross_validation import judged_numbers
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.likelihood.prediction_error import (
    QUANTITIES,
    blocks_of,
    boat_file_errors,
    change,
    errors_at,
)
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Cause, HeldOut, Judged, Share, Wind
from swamp_rl.criticism.selection.backward_elimination import Selection, without
from swamp_rl.criticism.selection.continuation import Continuation
from swamp_rl.effects import LIBRARY

Array = NDArray[np.float64]
Predicted = tuple[Array, NDArray[np.int64]]  # errors (n, 6) and the block of each (n,)

JUDGED: tuple[Judged, ...] = ("position_rmse_m", "heading_rmse_rad")


@dataclass(frozen=True)
class Witness:
    """Runs that predictions are compared with. weight: (R, T, 6); others: whether they are other runs than
    those fitted to; where not, each run's numbers come from the others; wind: where the run set has the
    measured one, left out of the fit, the boat's own effects alone are judged in it; apart: whether other
    runs are of another day, whose weather is not that of the runs fitted to.
    """

    run_set: RunSet
    weight: Array
    others: bool
    wind: Wind = "fitted"
    apart: bool = False

    @property
    def runs(self) -> int:
        """R."""
        return len(self.run_set.lengths)

    def judges(self, instance: EffectInstance) -> bool:
        """Whether predictions here depend on an instance: not on what other runs had of their own."""
        if self.others and instance.groups:
            return False
        return not instance.effect.weather or (self.wind == "fitted" and not (self.others and self.apart))

    def numbers(self, problem: Shooting, of: Fit) -> tuple[Hypothesis, Array]:
        """What predictions under a fit depend on here, and its parameters (R, p)."""
        hypothesis, numbers = judged_numbers(problem, of, self.runs, self.others)
        kept = np.array([self.judges(one) for one in hypothesis.instances for _ in one.specs], dtype=bool)
        hypothesis = Hypothesis(tuple(one for one in hypothesis.instances if self.judges(one)))
        return hypothesis, numbers[:, kept]

    def errors(self, continuation: Continuation, stage: int, of: Fit, horizon: float) -> Predicted:
        """Errors of predictions under a fit at a stage."""
        problem = continuation.problem(stage, of.hypothesis)
        made = errors_at(self.run_set, self.weight, horizon, *self.numbers(problem, of))
        return made.error, blocks_of(made, horizon)[0]


def in_its_weather(on: Witness, continuation: Continuation, of: Fit, stage: int) -> Witness:
    """The witness, `apart` if the weather of the runs fitted to, as a fit at a stage has it, does not reduce
    the position error of other runs, at the longest horizon that these allow.
    """
    calm = replace(on, apart=True)
    if all(on.judges(one) == calm.judges(one) for one in of.hypothesis.instances):
        return on
    for horizon in reversed(options().judged_horizons):
        fitted, without_it = (
            float(np.nansum(one.errors(continuation, stage, of, horizon)[0][:, POSITIONS] ** 2))
            for one in (on, calm)
        )
        if fitted != without_it:
            return on if fitted < without_it else calm
    return on


def witnesses(on: Witness, rng: np.random.Generator) -> list[Witness]:
    """Those runs, and again in the measured wind where `ignore` left it out of the fit. A wind without which
    the boat file predicts no worse is not taken: its sensor says nothing.
    """
    blown = on.run_set.in_ignored_wind
    if blown is None:
        return [on]
    horizon = options().judged_horizons[-1]
    calm, windy = (boat_file_errors(one, on.weight, horizon) for one in (on.run_set, blown))
    paired = change(calm.error[:, POSITIONS], windy.error[:, POSITIONS], blocks_of(calm, horizon)[0], rng)
    helps = paired is not None and paired.ci95[0] > 0.0
    return [on, replace(on, run_set=blown, wind="measured")] if helps else [on]


def cause_shares(
    continuation: Continuation,
    of: Fit,
    stage: int,
    on: list[Witness],
    rng: np.random.Generator,
    instances: Sequence[EffectInstance] | None = None,
) -> dict[str, list[Share]]:
    """By effect instance of a fit at a stage, or of some of them: errors with it, and without it, the others
    fitted anew.
    """
    shares: dict[str, list[Share]] = {}
    whole = {
        (i, horizon): one.errors(continuation, stage, of, horizon)
        for i, one in enumerate(on)
        for horizon in options().judged_horizons
    }
    for instance in of.hypothesis.instances if instances is None else instances:
        less = without(continuation, of, instance.label, stage)
        shares[instance.label] = [
            share
            for (i, horizon), after in whole.items()
            if on[i].judges(instance)
            for share in shares_of(
                on[i].errors(continuation, stage, less, horizon)[0], *after, horizon, rng, on[i].wind
            )
        ]
    return shares


def shares_of(
    before: Array,
    after: Array,
    block: NDArray[np.int64],
    horizon: float,
    rng: np.random.Generator,
    wind: Wind = "fitted",
) -> list[Share]:
    """The shares of one cause at one horizon, from errors (n, 6) without it and with it in blocks (n,)."""
    found = []
    for name in JUDGED:
        less, whole = (errors[:, QUANTITIES[name]] for errors in (before, after))
        one = change(less, whole, block, rng)
        if one is not None:
            found.append(
                Share(
                    horizon_s=horizon,
                    quantity=name,
                    without=one.before,
                    with_cause=one.after,
                    ci95=one.ci95,
                    moved=float(np.sqrt(np.nanmean(((less - whole) ** 2).sum(axis=1)))),
                    wind=wind,
                )
            )
    return found


def is_minor(shares: list[Share], noise: Mapping[str, float]) -> bool:
    """Whether a cause's share of every error is below `minor`, or negative, or may be chance, and it moves
    every prediction by less than the sensor's noise. Independent errors add in squares: their difference says
    little of a cause beside a larger error.

    noise: standard deviation by channel (SI, rad). False where no error could be measured.
    """
    small = (
        one.without - one.with_cause < options().minor * one.without or one.ci95[0] < 0.0 for one in shares
    )
    return all(small) and moves_less_than_noise(shares, noise)


def moves_less_than_noise(shares: Sequence[Share], noise: Mapping[str, float]) -> bool:
    """Whether a cause moves every prediction by less than the sensor's noise; `noise` as for `is_minor`."""
    position = np.hypot(noise.get("north", 0.0), noise.get("east", 0.0))
    sizes = dict(zip(JUDGED, (position, noise.get("heading", 0.0)), strict=True))
    return bool(shares) and all(one.moved is not None and one.moved < sizes[one.quantity] for one in shares)


def written_fit(
    continuation: Continuation, winner: Fit, stage: int, on: list[Witness], rng: np.random.Generator
) -> tuple[Fit, dict[str, list[Share]], list[str]]:
    """The winner less what does not carry over, fitted anew; the shares of every effect instance by its
    label, of one that was left out those that it failed by; and the labels of those.

    The worst is left out first, and so on while all together predict worse than the boat file.
    """
    found = cause_shares(continuation, winner, stage, on, rng)
    written, now, left_out = winner, found, list[str]()
    while now:
        failed = [label for label, shares in now.items() if not carries_over(shares)]
        if not failed and not is_worse(continuation, written, stage, on, rng):
            break
        worst = min(failed or now, key=lambda label: least_gain(now[label]))
        found = found | {worst: now[worst]}
        left_out.append(worst)
        written = without(continuation, written, worst, stage)
        now = cause_shares(continuation, written, stage, on, rng)
    return written, found, left_out


def carries_over(shares: Sequence[Share]) -> bool:
    """Whether no position error at any horizon is larger with the cause beyond chance."""
    return least_gain(shares) >= 0.0


def least_gain(shares: Sequence[Share]) -> float:
    """Upper end of the interval [m] of the position errors' gains, the least of all; infinite for none."""
    return min((one.ci95[1] for one in shares if one.quantity == "position_rmse_m"), default=math.inf)


def is_worse(
    continuation: Continuation, written: Fit, stage: int, on: Sequence[Witness], rng: np.random.Generator
) -> bool:
    """Whether a position error at any horizon is larger than the boat file's beyond chance."""
    nothing = continuation.boat_file(stage)
    for one in on:
        for horizon in options().judged_horizons:
            before, _ = one.errors(continuation, stage, nothing, horizon)
            after, block = one.errors(continuation, stage, written, horizon)
            paired = change(before[:, POSITIONS], after[:, POSITIONS], block, rng)
            if paired is not None and paired.ci95[1] < 0.0:
                return True
    return False


@dataclass(frozen=True)
class CauseList:
    """causes: by their share of the prediction error, the largest first; minor: those that do not matter;
    nuisance: the hull's derivatives beside a cause; sound: whether every number and standard error is finite.
    """

    causes: list[Cause]
    minor: list[Cause]
    nuisance: list[Cause]
    sound: bool


def list_causes(
    problem: Shooting,
    found: Selection,
    shares: Mapping[str, Sequence[Share]],
    left_out: Sequence[str],
    noise: Mapping[str, float],
    within: Collection[str] = (),
) -> CauseList:
    """Every effect instance of the winner as a cause, a nuisance or a minor cause.

    shares, left_out: of `written_fit`; noise: standard deviation by channel (SI, rad); within: labels of
    effects within the boat file's errors.
    """
    every = causes_of(problem, found.winner)
    for cause in every:
        cause.share = list(shares.get(cause.label, []))
        cause.carries_over = cause.label not in left_out
        cause.within_boat_errors = cause.label in within
        if one := found.confirmed.get(cause.label):
            cause.held_out = HeldOut(gain=one.gain, low=one.low, level=one.level)
    claimed = [
        cause
        for cause in every
        if all(math.isfinite(one.value + one.standard_error) for one in cause.parameters.values())
    ]

    def minor(cause: Cause) -> bool:
        return cause.within_boat_errors or is_minor(cause.share, noise)

    alone = all(LIBRARY[cause.effect].nuisance for cause in claimed)
    named = [cause for cause in claimed if LIBRARY[cause.effect].nuisance == alone]
    return CauseList(
        causes=sorted((one for one in named if not minor(one)), key=_size, reverse=True),
        minor=[one for one in named if minor(one)],
        nuisance=[cause for cause in claimed if LIBRARY[cause.effect].nuisance and not alone],
        sound=len(claimed) == len(every),
    )


def without_equal_rivals(
    continuation: Continuation,
    found: Selection,
    listed: CauseList,
    on: list[Witness],
    noise: Mapping[str, float],
    rng: np.random.Generator,
) -> Selection:
    """The selection less the rivals that have all its causes that matter and predict the same: what they
    add to these moves no prediction by more than the sensors' noise.
    """
    matter = {cause.label for cause in listed.causes}

    def differs(rival: Fit) -> bool:
        every = {one.label: one for one in rival.hypothesis.instances if not one.effect.nuisance}
        if not (matter and matter <= every.keys()):
            return True
        added = [one for label, one in every.items() if label not in matter]
        shares = cause_shares(continuation, rival, found.stage, on, rng, added)
        return not all(moves_less_than_noise(own, noise) for own in shares.values())

    return replace(found, rivals=[one for one in found.rivals if differs(one)])


def _size(cause: Cause) -> float:
    """The largest part of an error that a cause accounts for [1]."""
    fitted = [one for one in cause.share if one.wind == "fitted"]
    return max(((one.without - one.with_cause) / one.without for one in fitted), default=0.0)
