"""The search for effects, repeated with reconstructed commands while these fit clearly better."""

from collections.abc import Sequence
from dataclasses import replace

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import EffectInstance
from swamp_rl.criticism.options import options
from swamp_rl.criticism.selection.backward_elimination import Selection, conclude, fit_by_continuation
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.command_reconstruction import (
    Attempt,
    is_better,
    is_noise_on_whole_runs,
    is_refuted,
    other_commands,
    saved,
)
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE, Continuation, continuation_of

Searched = tuple[RunSet, Continuation, Selection]


def with_better_commands(
    run_set: RunSet,
    continuation: Continuation,
    found: Selection,
    logged: RunSet,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    tried: list[Continuation],
) -> Searched:
    """A search, repeated with reconstructed commands while they fit clearly better; adds to `tried`."""
    for _ in range(options().most_reconstructions):
        if found.adequate and found.stage >= LAST and not found.winner.hypothesis.instances:
            break
        spent = is_budget_spent(tried)
        for attempt in other_commands(continuation, found, logged, spent):
            other = replace(attempt[0], gaps=run_set.gaps)
            wider = continuation_of(other, continuation.problems[0].weight)
            tried.append(wider)
            again = _searched_again(attempt, continuation, found, wider, instances, hull, spent)
            if again is not None:
                run_set, continuation, found = other, wider, again
                break
        else:
            break
    return run_set, continuation, found


def _searched_again(
    attempt: Attempt,
    continuation: Continuation,
    found: Selection,
    wider: Continuation,
    instances: Sequence[EffectInstance],
    hull: EffectInstance | None,
    spent: bool,
) -> Selection | None:
    """The result with the commands of an attempt, those of `wider`, or None where that is not accepted. The
    effects beside which those were found are judged alone too where they are likelier, on windows that both
    reach, than what a search with those commands ends with: an effect more would absorb what these leave.
    """
    _, kept, accepts = attempt
    if accepts is is_better and is_refuted(continuation, found, wider):
        return None
    again = None
    if accepts is not is_noise_on_whole_runs:
        previous = [continuation.fit(stage, *kept) for stage in (0, MIDDLE)]
        budget = 0.0 if spent else options().step_budget_again  # no search, but the effects that are kept
        again = beam_search(wider, instances, hull, budget, None, previous)
        if accepts(continuation, found, wider, again):
            return again
        if accepts is is_better:
            return None
    every = [*instances, *([hull] if hull else [])]
    alone = conclude(wider, fit_by_continuation(wider, *kept), [], found.first, found.unidentifiable, every)
    if again is not None and saved(wider, again, wider, alone) <= 0.0:
        return None
    return alone if accepts(continuation, found, wider, alone) else None


def is_budget_spent(continuations: Sequence[Continuation]) -> bool:
    """Whether the simulated steps exceed the budget of all searches."""
    return sum(continuation.boat_steps for continuation in continuations) > options().total_budget
