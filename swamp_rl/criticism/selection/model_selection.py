"""Model selection under white noise, then under Gauss-Markov position noise, then under model error."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.gauss_markov import fit_gauss_markov
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.nuisance.process_noise import measurement_noise_gain, process_noise_gain
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import (
    Selection,
    fit_by_continuation,
    without_unconfirmed,
)
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.command_reconstruction import (
    better_reconstruction,
    is_better,
    is_simpler,
    reconstruction_without_timing,
    sufficient_reconstruction,
)
from swamp_rl.criticism.selection.continuation import (
    LAST,
    MIDDLE,
    Continuation,
    continuation_of,
)
from swamp_rl.criticism.selection.stepwise_selection import select_under_model_error

Array = NDArray[np.float64]

POSITIONS = slice(0, 2)
OTHERS = slice(2, 6)
TINY = 1e-9  # floor of sizes and times in logarithms


def select_model(
    run_set: RunSet, weight: Array, instances: Sequence[EffectInstance], hull: EffectInstance | None
) -> tuple[RunSet, Continuation, Selection]:
    """The runs with their estimated noise, the continuation and the selection.

    Correlated position errors alone are attributed to the sensor. Where other channels have them too, they
    are model error: they widen all comparisons and standard errors, and the selection is never adequate.
    """
    tried: list[Continuation] = []
    run_set, continuation, found = _with_reconstruction(
        run_set, weight, instances, hull, tried, options().step_budget
    )
    if found.adequate and found.stage >= LAST:
        return run_set, continuation, found
    winner, stage = found.winner, LAST if found.adequate else MIDDLE
    if found.adequate and diverged(continuation, winner):
        return run_set, continuation, found
    source = correlated_noise(continuation, winner, stage)
    if source != "measurement" and winner.hypothesis.instances and not found.adequate:
        nothing = continuation.fit(MIDDLE, Hypothesis(), np.zeros(0))
        if correlated_noise(continuation, nothing, stage) == "measurement":
            winner, source = nothing, "measurement"
    if source == "measurement":
        again = _with_position_noise(weight, instances, hull, tried, continuation, winner)
        if again is not None:
            return again
    if found.adequate:
        return run_set, continuation, found
    if source == "process":
        return select_under_model_error(run_set, weight, instances, hull, found.winner)
    return (
        run_set,
        continuation,
        without_unconfirmed(continuation, found, [*instances, *([hull] if hull else [])]),
    )


def _with_reconstruction(
    run_set: RunSet,
    weight: Array,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    tried: list[Continuation],
    step_budget: float,
    previous: Sequence[Fit] = (),
) -> tuple[RunSet, Continuation, Selection]:
    """The search, repeated with reconstructed commands where these fit clearly better; every continuation is
    added to `tried`.
    """
    logged, continuation = run_set, continuation_of(run_set, weight)
    tried.append(continuation)
    other = sufficient_reconstruction(
        continuation, fit_by_continuation(continuation, Hypothesis(), np.zeros(0)), logged
    )
    if other is not None:
        run_set = replace(other, gaps=run_set.gaps)
        continuation = continuation_of(run_set, weight)
        tried.append(continuation)
    if run_set.gauss_markov is None and _is_position_noise_suspected(continuation):
        step_budget = min(step_budget, options().step_budget_suspected)
    found = beam_search(
        continuation,
        instances,
        hull,
        step_budget,
        partial(sufficient_reconstruction, logged=logged),
        previous,
    )
    for _ in range(options().most_reconstructions):
        if (found.adequate and not found.winner.hypothesis.instances) or is_budget_spent(tried):
            break
        at = continuation.fit(MIDDLE, found.winner.hypothesis, found.winner.x)
        other, accepts = better_reconstruction(continuation, at, logged), is_better
        if other is None and found.adequate:
            other, accepts = reconstruction_without_timing(continuation, at, logged), is_simpler
        if other is None:
            break
        other = replace(other, gaps=run_set.gaps)
        wider = continuation_of(other, weight)
        tried.append(wider)
        again = beam_search(wider, instances, hull, options().step_budget_again)
        if not accepts(continuation, found, wider, again):
            break
        run_set, continuation, found = other, wider, again
    return run_set, continuation, found


def _is_position_noise_suspected(continuation: Continuation) -> bool:
    """Whether positions alone have a Gauss-Markov residual on the shortest windows."""
    noise = _gauss_markov_noise(continuation.problems[0], continuation.fit(0, Hypothesis(), np.zeros(0)))
    return bool((noise[POSITIONS, 0] > 0).any() and not (noise[OTHERS, 0] > 0).any())


def is_budget_spent(continuations: Sequence[Continuation]) -> bool:
    """Whether the simulated steps exceed the budget of all searches."""
    return sum(continuation.boat_steps for continuation in continuations) > options().total_budget


def _with_position_noise(
    weight: Array,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    tried: list[Continuation],
    continuation: Continuation,
    winner: Fit,
) -> tuple[RunSet, Continuation, Selection] | None:
    """The selection under Gauss-Markov position noise, the noise and the selection being repeated until the
    noise changes little; None where the residual exceeds it.
    """
    run_set, slow = continuation.problems[0].run_set, slowest_noise(continuation, winner)
    for _ in range(options().most_repeats):
        fit_by_continuation(continuation, winner.hypothesis, winner.x)
        previous = [continuation.fit(stage, winner.hypothesis, winner.x) for stage in (0, MIDDLE)]
        _, continuation, found = _with_reconstruction(
            replace(run_set, gauss_markov=slow),
            weight,
            instances,
            hull,
            tried,
            options().step_budget_again,
            previous,
        )
        if not found.adequate:
            return None
        winner, noise, slow = found.winner, slow, slowest_noise(continuation, found.winner)
        if is_budget_spent(tried) or nearly_equal(noise, slow):
            break
    return continuation.problems[0].run_set, continuation, found


def slowest_noise(continuation: Continuation, winner: Fit) -> Array:
    """(6, 2) Gauss-Markov position noise beside a hypothesis, from whole runs unless these diverged: the
    longest time constants are identifiable there only.
    """
    stage = MIDDLE if diverged(continuation, winner) else LAST
    at = continuation.fit(stage, winner.hypothesis, winner.x)
    return _only_positions(_position_noise(continuation.problem(stage, at.hypothesis), at).noise)


def diverged(continuation: Continuation, winner: Fit) -> bool:
    """Whether whole runs leave far more than their windows do, as of a boat that is unstable on course."""
    middle = fit_by_continuation(continuation, winner.hypothesis, winner.x)
    whole = continuation.fit(LAST, winner.hypothesis, winner.x)
    left = [
        one.chi2 / continuation.problems[stage].samples for stage, one in ((MIDDLE, middle), (LAST, whole))
    ]
    return left[1] > options().model_error_chi2 * left[0]


def nearly_equal(one: Array, other: Array) -> bool:
    """Whether two Gauss-Markov processes (6, 2) differ by no more than the grid that they are estimated
    on.
    """
    size, time = np.abs(np.log(np.maximum(one, TINY) / np.maximum(other, TINY))).T
    return bool((size < options().noise_unchanged[0]).all() and (time < options().noise_unchanged[1]).all())


def correlated_noise(
    continuation: Continuation, winner: Fit, stage: int
) -> Literal["measurement", "process"] | None:
    """Source of the correlated residual of the winner at a stage: measurement (positions alone) or process;
    None where the residual is white, or small.

    The noise is estimated again beside a fit that includes it. Process noise also correlates positions: the
    larger likelihood decides.
    """
    at = continuation.fit(stage, winner.hypothesis, winner.x)
    problem = continuation.problem(stage, at.hypothesis)
    first = _gauss_markov_noise(problem, at)
    if not (first[:, 0] > 0).any():
        return None
    position_noise = _position_noise(problem, at)
    only = (position_noise.noise[POSITIONS, 0] > 0).any() and not (position_noise.noise[OTHERS, 0] > 0).any()
    if only and position_noise.gain > process_noise_gain(problem, at):
        return "measurement"
    return "process"


@dataclass(frozen=True)
class PositionNoise:
    """noise: (6, 2) Gauss-Markov noise beside a fit that includes its position part; gain: 2 log likelihood
    ratio of that part.
    """

    noise: Array
    gain: float


def _position_noise(problem: Shooting, white: Fit) -> PositionNoise:
    at, noise, gain = white, _gauss_markov_noise(problem, white), 0.0
    for _ in range(options().wander_rounds):
        slow = _only_positions(noise)
        aware = Shooting(
            replace(problem.run_set, gauss_markov=slow), problem.weight, problem.seconds, problem.windows
        )
        at = fit(aware, at.hypothesis, at.x, at.states, options().wander_steps)
        noise, gain = _gauss_markov_noise(aware, at), measurement_noise_gain(white, aware, at)
    return PositionNoise(noise, gain)


def _only_positions(noise: Array) -> Array:
    return np.where(np.arange(len(noise))[:, None] < POSITIONS.stop, noise, 0.0)


def _gauss_markov_noise(problem: Shooting, at: Fit) -> Array:
    base = problem.predict(at.hypothesis, at.x[None], at.states[None])[0]
    return fit_gauss_markov(problem.windows, problem.difference(base) * problem.windows.weight, problem.dt)
