"""Independent work on one continuation, in threads."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.selection.continuation import Continuation
from swamp_rl.criticism.threads import each

T = TypeVar("T")
R = TypeVar("R")


def side_by_side(
    continuation: Continuation, work: Callable[[Continuation, T], R], items: Sequence[T]
) -> list[R]:
    """The results of work on each item, which knows the fits made before and may make others: these are kept
    in the items' order, whatever the number of threads, and their boat steps count.
    """
    every = [*continuation.problems, *continuation.whole.values()]
    every += [continuation.half] if continuation.half else []
    shared = {id(one): one for one in every}

    def apart(item: T) -> tuple[R, Continuation, dict[int, Shooting]]:
        own = {key: one.apart() for key, one in shared.items()}
        mine = replace(
            continuation,
            problems=[own[id(one)] for one in continuation.problems],
            fits=dict(continuation.fits),
            whole={key: own[id(one)] for key, one in continuation.whole.items()},
            reconstructed=dict(continuation.reconstructed),
            half=own[id(continuation.half)] if continuation.half else None,
        )
        return work(mine, item), mine, own

    before, results = dict(continuation.fits), []
    for made, mine, own in each(apart, items):
        originals = {id(one): shared[key] for key, one in own.items()}
        new = {key: one for key, one in mine.fits.items() if before.get(key) is not one}
        whole = {key: mine.whole[key] for key in new if key in mine.whole}
        continuation.fits |= new
        continuation.whole |= {key: originals.get(id(one), one) for key, one in whole.items()}
        continuation.reconstructed |= mine.reconstructed
        continuation.half = continuation.half or mine.half
        for key, one in own.items():
            shared[key].boat_steps[0] += one.boat_steps[0]
        results.append(made)
    return results
