"""Predictions with the gain of the thrust estimated from a run's recent past, and whether it helps."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.fit import SHORT, soft_weights, window_length
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit, fit_states
from swamp_rl.criticism.likelihood.prediction_error import (
    Restarts,
    errors_of,
    position_rmse,
)
from swamp_rl.criticism.model.candidates import Hypothesis, instances_of
from swamp_rl.criticism.options import options
from swamp_rl.effects import LIBRARY

Array = NDArray[np.float64]

STRETCH = 5.0  # s between two estimates
PAST = 2.5  # lengths of the fit's last windows, that an estimate is made from at most
SPREAD = 0.3  # standard deviation [1] of the gains' prior: that of the thrust coefficients of a boat file
STATE_ROUNDS, STEPS = 8, 4


Gains = Literal["none", "common", "each"]
"""No gain, one gain of all thrusters, one gain of each."""
CHOICES: tuple[Gains, ...] = ("none", "common", "each")


@dataclass(frozen=True)
class RecentErrors:
    """Root mean square position error [m] at a horizon, of a boat file with the recent gains."""

    horizon_s: float
    position: float


def chosen_gains(training: RunSet, boat: Boat) -> tuple[Gains, dict[Gains, list[RecentErrors]]]:
    """The gains with the least prediction error on the training runs, and the errors of each choice.

    Compared is the mean of the log errors at the horizons that the runs hold. The file is fitted to these
    runs and the gains of a prediction are not, so the comparison favours none. A choice that diverges at a
    horizon is left out.
    """
    several = len(thruster_gains(boat, "each").instances) > 1
    errors = _errors(training, boat, CHOICES if several else CHOICES[:2])
    longest = max(len(one) for one in errors.values())
    logs = {
        choice: float(np.mean(np.log([max(one.position, 1e-12) for one in own])))
        for choice, own in errors.items()
        if own and len(own) == longest
    }
    return min(logs, key=lambda choice: logs[choice]) if logs else "none", errors


def recent_errors(run_set: RunSet, boat: Boat, gains: Gains) -> list[RecentErrors]:
    """Errors of a boat file with recent gains at every horizon that the runs hold."""
    return _errors(run_set, boat, [gains])[gains]


@np.errstate(over="ignore", invalid="ignore")  # where the boat diverges
def _errors(run_set: RunSet, boat: Boat, choices: Sequence[Gains]) -> dict[Gains, list[RecentErrors]]:
    """Errors of a boat file with each of several choices of gains, as `recent_errors`."""
    run_set = replace(run_set, boat=boat)
    weight = weights(run_set, noise_levels(run_set))
    hypotheses = [thruster_gains(boat, one) for one in choices]
    found: dict[Gains, list[RecentErrors]] = {}
    every = _gains_of_each(run_set, soft_weights(weight, boat), hypotheses)
    for choice, hypothesis, gains in zip(choices, hypotheses, every, strict=True):
        found[choice] = errors_with(run_set, weight, hypothesis, gains)
    return found


def errors_with(
    run_set: RunSet, weight: Array, hypothesis: Hypothesis, numbers: Sequence[Array]
) -> list[RecentErrors]:
    """Errors with the numbers (S, p) of each run's stretches, as `predictor` has them."""
    ends = predictor(run_set, numbers, hypothesis)
    errors = [(horizon, errors_of(run_set, weight, horizon, ends)) for horizon in options().horizons]
    return [
        RecentErrors(horizon, position_rmse(one))
        for horizon, one in errors
        if np.isfinite(one.error[:, :2]).all(axis=1).any()
    ]


def thruster_gains(boat: Boat, gains: Gains, spread: float = SPREAD) -> Hypothesis:
    """The gains [1], each with a normal prior about 1 of that standard deviation."""
    if gains == "none":
        return Hypothesis()
    of_all = instances_of(LIBRARY["thrust_scale"], boat)
    if gains == "each":
        own = [one for one in instances_of(LIBRARY["thruster_gain"], boat) if one.selectors != ("all",)]
        of_all = sorted(own, key=lambda one: one.label) or of_all
    return Hypothesis(
        tuple(replace(one, specs=tuple(replace(spec, prior=spread) for spec in one.specs)) for one in of_all)
    )


def past_seconds(boat: Boat) -> float:
    """Seconds of a run that gains are estimated from, at most."""
    return PAST * window_length(boat)


def recent_gains(run_set: RunSet, weight: Array, hypothesis: Hypothesis) -> list[Array]:
    """(S, p) gains for each stretch of STRETCH of each run, from `past_seconds` before it; 1 for the first.

    weight: (R, T, 6), of independent samples.
    """
    return _gains_of_each(run_set, weight, [hypothesis])[0]


def _gains_of_each(run_set: RunSet, weight: Array, hypotheses: Sequence[Hypothesis]) -> list[list[Array]]:
    """The gains of each hypothesis, as `recent_gains`."""
    rows, past = (round(one / run_set.dt) for one in (STRETCH, past_seconds(run_set.boat)))
    found: list[list[Array]] = [[] for _ in hypotheses]
    for run, length in enumerate(run_set.lengths):
        gains = [np.ones((-(-int(length) // rows), one.size)) for one in hypotheses]
        for k in range(1, len(gains[0])):
            first = max([0, k * rows - past, *_gap_ends(run_set, run, k * rows)])
            fitted = _fitted(run_set, weight, run, first, k * rows, hypotheses)
            for own, x in zip(gains, fitted, strict=True):
                own[k] = x
        for before, own in zip(found, gains, strict=True):
            before.append(own)
    return found


def _gap_ends(run_set: RunSet, run: int, end: int) -> list[int]:
    """Rows at which gaps of a run end that begin before the row `end`."""
    return [min(gap.row + gap.rows, end) for gap in run_set.gaps if gap.run == run and gap.row < end]


def _fitted(
    run_set: RunSet, weight: Array, run: int, first: int, end: int, hypotheses: Sequence[Hypothesis]
) -> list[Array]:
    """(p,) gains of those rows by each hypothesis; 1 where they are too few or the boat diverges."""
    none = [one.prior()[0] for one in hypotheses]
    if end - first < 2 or not any(one.size for one in hypotheses):
        return none
    part, own = rows_of(run_set, run, first, end), weight[run : run + 1, first:end]
    compared = max(int(part.first_compared[0]), round(options().pad / part.dt))
    if np.count_nonzero(own[0, compared:, 0]) * part.dt < options().shortest_window:
        return none
    problem = Shooting(part, own, SHORT)
    start = problem.initial_states()  # under gains of 1 the fit of the states is that of each hypothesis
    states = fit_states(problem, Hypothesis(), np.zeros(0), start, STATE_ROUNDS)[0]
    fitted = [
        fit(problem, hypothesis, x, states, STEPS).x if hypothesis.size else x
        for hypothesis, x in zip(hypotheses, none, strict=True)
    ]
    return [x if np.isfinite(x).all() else one for x, one in zip(fitted, none, strict=True)]


def rows_of(run_set: RunSet, run: int, first: int, end: int) -> RunSet:
    """Rows of one run, without gap."""
    one = run_set.subset([run])
    return replace(
        one,
        commands=one.commands[:, first:end],
        measured=one.measured[:, first:end],
        weather=one.weather[:, first:end] if len(one.weather) else one.weather,
        ignored=one.ignored[:, first:end] if len(one.ignored) else one.ignored,
        lengths=np.array([end - first]),
        gaps=(),
        origin=(),
    )


def predictor(
    run_set: RunSet, gains: Sequence[Array], hypothesis: Hypothesis
) -> Callable[[int, Restarts], Array]:
    """(n, 6) predictions of a run's restarts with the numbers of their stretches of STRETCH, of which the
    last has what is beyond.
    """
    rows = round(STRETCH / run_set.dt)

    def ends(run: int, start: Restarts) -> Array:
        stretch = np.minimum(start.first // rows, len(gains[run]) - 1)
        found = np.empty((len(stretch), 6))
        for k in np.unique(stretch):
            mine = stretch == k
            found[mine] = start.part(mine).predict(hypothesis, gains[run][k])[:, -1]
        return found

    return ends
