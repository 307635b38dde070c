"""Model selection under white noise, then under Gauss-Markov position noise, then under model error."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import CHANNELS, POSITIONS, RunSet
from swamp_rl.criticism.likelihood.adequacy import adequacy, near
from swamp_rl.criticism.likelihood.gauss_markov import SIZE, fit_gauss_markov, white_noise
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.nuisance.process_noise import (
    log_determinant,
    measurement_noise_gain,
    process_noise_gain,
)
from swamp_rl.criticism.nuisance.smoothed_channels import smoothed_channels
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import (
    Nuisance,
    Selection,
    fit_by_continuation,
    without_unconfirmed,
)
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.better_commands import is_budget_spent, with_better_commands
from swamp_rl.criticism.selection.command_reconstruction import (
    sufficient_reconstruction,
    sufficiently_reconstructed,
)
from swamp_rl.criticism.selection.continuation import (
    LAST,
    MIDDLE,
    Continuation,
    continuation_of,
    states_carried,
)
from swamp_rl.criticism.selection.stepwise_selection import select_under_model_error

Array = NDArray[np.float64]
Source = Literal["measurement", "process"] | None

OTHERS = slice(2, 6)
POSITION_NAMES = frozenset(CHANNELS[POSITIONS])
TINY = 1e-9  # floor of sizes and times in logarithms


def select_model(
    run_set: RunSet, weight: Array, instances: Sequence[EffectInstance], hull: EffectInstance | None
) -> tuple[RunSet, Continuation, Selection]:
    """The runs with their estimated noise, the continuation and the selection.

    Correlated position errors alone are attributed to the sensor. Where other channels have them too, they
    are model error: they widen all comparisons and standard errors, and the selection is never adequate.
    """
    tried: list[Continuation] = []
    given, logged = (instances, hull, tried), run_set
    begun = continuation_of(run_set, weight)
    nothing = fit_by_continuation(begun, Hypothesis(), np.zeros(0))
    if _is_position_noise_sufficient(begun, nothing):
        # an effect of a search under white noise would only absorb that noise
        again = _with_position_noise(*given, begun, nothing, options().step_budget_again)
        if again is not None:
            return again
    run_set, continuation, found = _with_reconstruction(run_set, begun, *given, options().step_budget)
    if found.beside == "position noise":
        again = _with_position_noise(*given, continuation, found.winner, options().step_budget)
        if again is not None:
            return again
        budget = options().step_budget
        run_set, continuation, found = _with_reconstruction(logged, begun, *given, budget, deep=True)
    again = _with_its_noise(run_set, continuation, found, *given)
    if again is not None:
        return again
    under = select_under_model_error(run_set, weight, instances, hull, found.winner)
    named = under[2].winner
    closer = fit_by_continuation(continuation, named.hypothesis, named.x)
    if continuation.criterion(closer) < continuation.criterion(continuation.at(MIDDLE, found.winner)):
        # what white noise did not lead to may yet leave no more than that
        previous = [continuation.at(stage, closer) for stage in (0, MIDDLE)]
        found = beam_search(continuation, instances, hull, 0.0, None, previous)
        better = with_better_commands(run_set, continuation, found, logged, *given)
        again = _with_its_noise(*better, *given)
    return again if again is not None and again[2].adequate else under


def _with_its_noise(
    run_set: RunSet,
    continuation: Continuation,
    found: Selection,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    tried: list[Continuation],
) -> tuple[RunSet, Continuation, Selection] | None:
    """A selection under white noise, or anew under the position noise that it leaves; None where it leaves
    model error.
    """
    given = instances, hull, tried
    if found.adequate and found.stage < LAST and diverged(continuation, found.winner):
        if is_adequate_on_longer(continuation, found.winner):
            return run_set, continuation, found
        found = replace(found, adequate=False, stage=MIDDLE, rivals=[])
    winner, stage = found.winner, LAST if found.adequate else MIDDLE
    source, noise = _residual_noise(continuation, winner, stage)
    if source is None and stage == MIDDLE and correlated_noise(continuation, winner, LAST) == "measurement":
        source = "measurement"  # slower than the middle windows are long
    if source != "measurement" and not found.adequate:
        other = likeliest_beside_position_noise(continuation, winner, noise)
        winner, source = (other, "measurement") if other else (winner, source)
    if source == "measurement":
        again = _with_position_noise(*given, continuation, winner, options().step_budget_again)
        if again is not None:
            return again
    if found.adequate:
        return run_set, continuation, found
    if source == "process":
        return None
    every = [*instances, *([hull] if hull else [])]
    return run_set, continuation, without_unconfirmed(continuation, found, every)


def _with_reconstruction(
    run_set: RunSet,
    continuation: Continuation,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    tried: list[Continuation],
    step_budget: float,
    previous: Sequence[Fit] = (),
    deep: bool = False,
) -> tuple[RunSet, Continuation, Selection]:
    """The search, with reconstructed commands if they fit clearly better; adds to `tried`.

    continuation: of the runs as logged; deep: whether position noise beside a single effect is no reason to
    end the search.
    """
    logged, weight = run_set, continuation.problems[0].weight
    tried.append(continuation)
    other = sufficient_reconstruction(
        continuation, fit_by_continuation(continuation, Hypothesis(), np.zeros(0)), logged
    )
    if other is not None:
        moved = replace(other, gaps=run_set.gaps)
        beside = continuation_of(moved, weight)
        tried.append(beside)
        if beside.is_adequate(LAST, beside.boat_file(LAST)):
            run_set, continuation = moved, beside
    sufficient = partial(_sufficient_nuisance, logged=logged, deep=deep or run_set.gauss_markov is not None)
    given = logged, instances, hull, tried
    found = beam_search(continuation, instances, hull, step_budget, sufficient, previous)
    if found.beside == "position noise":
        return run_set, continuation, found
    better = with_better_commands(run_set, continuation, found, *given)
    if found.beside and better[1] is continuation:  # which another search did not confirm
        found = beam_search(continuation, instances, hull, step_budget, None, previous)
        better = with_better_commands(run_set, continuation, found, *given)
    return better


def likeliest_beside_position_noise(continuation: Continuation, winner: Fit, noise: Array) -> Fit | None:
    """The likeliest hypothesis whose residual on the middle windows is position noise alone, as it stands or
    with reconstructed commands, of the boat file, the likeliest single effect, the best of whole runs and the
    winner; or None. noise: (6, 3) beside the winner, which is not position noise alone.
    """
    every = [continuation.boat_file(MIDDLE), _likeliest_single(continuation)]
    every += [best_on_whole_runs(continuation, winner), winner]
    distinct = {one.hypothesis.label: one for one in every if one}.values()
    judged = [
        _criterion_beside_noise(continuation, one, noise if one is winner else None) for one in distinct
    ]
    least, likeliest = min(zip(judged, distinct, strict=True), key=lambda pair: pair[0])
    return likeliest if np.isfinite(least) else None


def _likeliest_single(continuation: Continuation) -> Fit | None:
    """The fit to the shortest windows of the single effect of least criterion there, if there is one."""
    every = [
        one
        for (stage, _), one in continuation.fits.items()
        if stage == 0 and len(one.hypothesis.instances) == 1
    ]
    return min(every, key=continuation.criterion, default=None)


def _criterion_beside_noise(continuation: Continuation, at: Fit, noise: Array | None) -> float:
    """Criterion of a hypothesis on the middle windows under the position noise beside it, with the
    determinant of that noise and the cost of reconstructed commands; infinite if its residual is more than
    position noise, and not white beside that with reconstructed commands either.

    noise: (6, 3) beside it, where that is known and not of positions alone.
    """
    source, beside = _residual_noise(continuation, at, MIDDLE) if noise is None else ("process", noise)
    slow = _only_positions(beside)
    if not (slow[:, SIZE] > 0).any():
        return np.inf
    noisy = replace(continuation.run_set, gauss_markov=slow)
    again = continuation_of(noisy, continuation.problems[0].weight)
    made, cost = fit_by_continuation(again, at.hypothesis, at.x), 0.0
    if source != "measurement":
        other = sufficiently_reconstructed(again, made, noisy)
        if other is None:
            return np.inf
        made, cost = other[1], other[0].instants_cost
    return again.criterion(made) + cost + log_determinant(again.problems[MIDDLE])


def _of_positions_alone(noise: Array) -> bool:
    """Whether Gauss-Markov noise (6, 3) is in positions and in no other channel."""
    return bool((noise[POSITIONS, 0] > 0).any() and not (noise[OTHERS, 0] > 0).any())


def _sufficient_nuisance(
    continuation: Continuation, at: Fit, logged: RunSet, deep: bool
) -> tuple[Nuisance, Fit] | None:
    """The nuisance that suffices beside the boat file or the likeliest single effect, a fit to the middle
    windows, and which of them; deep: other than position noise.
    """
    if not deep:
        nothing, problem = continuation.boat_file(MIDDLE), continuation.problems[MIDDLE]
        if _position_noise_beside(problem, nothing)[1] > nothing.chi2 - at.chi2:
            return "position noise", nothing
        _, gain, is_white = _position_noise_beside(problem, at)
        if gain > 0.0 and is_white:
            return "position noise", at
    return ("commands", at) if sufficient_reconstruction(continuation, at, logged) else None


def _is_position_noise_sufficient(continuation: Continuation, at: Fit) -> bool:
    """Whether a fit to the middle windows leaves little more than noise, and that is correlated in the
    positions alone.
    """
    if not near(continuation.problems[MIDDLE], at):
        return False
    return correlated_noise(continuation, at, MIDDLE) == "measurement"


def _with_position_noise(
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    tried: list[Continuation],
    continuation: Continuation,
    winner: Fit,
    step_budget: float,
) -> tuple[RunSet, Continuation, Selection] | None:
    """The selection under Gauss-Markov position noise, until that changes little; None if inadequate.

    step_budget: boat steps of the first search.
    """
    slow = slowest_noise(continuation, winner)
    run_set = continuation.run_set
    for _ in range(options().most_repeats):
        fit_by_continuation(continuation, winner.hypothesis, winner.x)
        previous = [continuation.at(stage, winner) for stage in (0, MIDDLE)]
        noisy, given = replace(run_set, gauss_markov=slow), (instances, hull, tried)
        begun = continuation_of(noisy, continuation.problems[0].weight)
        _, continuation, found = _with_reconstruction(noisy, begun, *given, step_budget, previous)
        step_budget = options().step_budget_again
        if not found.adequate:
            return None
        winner, noise, slow = found.winner, slow, slowest_noise(continuation, found.winner)
        if is_budget_spent(tried) or nearly_equal(noise, slow):
            break
    return continuation.run_set, continuation, found


def slowest_noise(continuation: Continuation, winner: Fit) -> Array:
    """(6, 3) Gauss-Markov position noise beside a hypothesis, from whole runs unless these leave more beside
    it, as of a boat that is unstable on course.
    """
    whole = continuation.at(LAST, winner)
    noise, aware, at = _fit_with_noise(continuation.problem(LAST, whole.hypothesis), whole)
    if not near(aware, at):
        middle = continuation.at(MIDDLE, winner)
        noise, _, _ = _fit_with_noise(continuation.problem(MIDDLE, middle.hypothesis), middle)
    return _only_positions(noise)


def diverged(continuation: Continuation, winner: Fit) -> bool:
    """Whether whole runs leave far more than their windows do, as of a boat that is unstable on course."""
    middle = fit_by_continuation(continuation, winner.hypothesis, winner.x)
    whole = continuation.at(LAST, winner)
    left = [one.chi2 / continuation.problems[stage].samples for stage, one in enumerate((middle, whole), 1)]
    return left[1] > options().model_error_chi2 * left[0]


def best_on_whole_runs(continuation: Continuation, winner: Fit) -> Fit:
    """The fit to whole runs of least criterion among the hypotheses that were fitted to them: beside position
    noise, middle windows may prefer another one.
    """
    every = [one for (stage, _), one in continuation.fits.items() if stage == LAST]
    return min([continuation.at(LAST, winner), *every], key=continuation.criterion)


def is_adequate_on_longer(continuation: Continuation, winner: Fit) -> bool:
    """Whether the residual is noise on windows twice as long as the middle ones too: as of a boat that is
    unstable on course, but not of a wrong model, whose error accumulates.
    """
    middle = continuation.at(MIDDLE, winner)
    shorter = continuation.problem(MIDDLE, middle.hypothesis)
    longer = Shooting(shorter.run_set, shorter.weight, 2.0 * shorter.seconds)
    states = states_carried(shorter, middle.states, longer, longer.initial_states())
    made = fit(longer, middle.hypothesis, middle.x, states, options().stage_steps[MIDDLE])
    return adequacy(longer, made).adequate


def nearly_equal(one: Array, other: Array) -> bool:
    """Whether two Gauss-Markov processes (6, 3) differ by no more than the grid of their estimates."""
    size, time, _ = np.abs(np.log(np.maximum(one, TINY) / np.maximum(other, TINY))).T
    return bool((size < options().noise_unchanged[0]).all() and (time < options().noise_unchanged[1]).all())


def correlated_noise(continuation: Continuation, winner: Fit, stage: int) -> Source:
    """Source of the correlated residual of the winner at a stage: measurement (positions alone) or process;
    None where the residual is white.
    """
    return _residual_noise(continuation, winner, stage)[0]


def _residual_noise(continuation: Continuation, winner: Fit, stage: int) -> tuple[Source, Array]:
    """The source as of `correlated_noise`, and the Gauss-Markov noise (6, 3).

    The noise is estimated again beside a fit that includes it. Process noise also correlates positions: the
    larger likelihood decides.
    """
    at = continuation.at(stage, winner)
    problem = continuation.problem(stage, at.hypothesis)
    first = _gauss_markov_noise(problem, at)
    if not (first[:, 0] > 0).any():
        return None, first
    noise, gain, _ = _position_noise_beside(problem, at, first)
    return ("measurement" if gain > 0.0 else "process"), noise


def _position_noise_beside(
    problem: Shooting, at: Fit, first: Array | None = None
) -> tuple[Array, float, bool]:
    """Gauss-Markov noise (6, 3) beside a fit, the gain in 2 log likelihood by that of the positions, none
    where other channels have noise or process noise is the more likely, and whether a fit with it leaves
    little more than white noise. first: the noise of the fit, where it is known.
    """
    noise, aware, made = _fit_with_noise(problem, at, first)
    gain = measurement_noise_gain(at, aware, made)
    alone = _of_positions_alone(noise) and gain > process_noise_gain(problem, at)
    return noise, gain if alone else 0.0, near(aware, made)


def _fit_with_noise(problem: Shooting, white: Fit, first: Array | None = None) -> tuple[Array, Shooting, Fit]:
    """(6, 3) Gauss-Markov noise beside a fit that includes its position part, the windows with that part and
    the fit to them. first: the noise beside the fit as it is, where it is known.
    """
    aware, at, noise = problem, white, _gauss_markov_noise(problem, white) if first is None else first
    for _ in range(options().wander_rounds):
        if not (noise[POSITIONS, 0] > 0).any():
            break
        run_set = replace(problem.run_set, gauss_markov=_only_positions(noise))
        aware = Shooting(run_set, problem.weight, problem.seconds, problem.windows)
        at = fit(aware, at.hypothesis, at.x, at.states, options().again_steps)
        noise = _gauss_markov_noise(aware, at)
    return noise, aware, at


def _only_positions(noise: Array) -> Array:
    return np.where(np.arange(len(noise))[:, None] < POSITIONS.stop, noise, white_noise())


def _gauss_markov_noise(problem: Shooting, at: Fit) -> Array:
    base = problem.track(at.hypothesis, at.x, at.states)
    difference = problem.difference(base) * problem.windows.weight
    smoothed = POSITION_NAMES & smoothed_channels(problem.run_set).keys()  # whose weight is no white noise's
    least_white = 1.0 if smoothed else options().wander_white
    return fit_gauss_markov(problem.windows, difference, problem.dt, least_white)
