"""Which causes go into files: those that make no prediction of held-out runs worse beyond chance."""

import math
from collections.abc import Sequence

import numpy as np

from swamp_rl.criticism.inference.cause_share import Witness, cause_shares
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.likelihood.prediction_error import QUANTITIES, change
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Share
from swamp_rl.criticism.selection.backward_elimination import without
from swamp_rl.criticism.selection.continuation import Continuation

POSITIONS = QUANTITIES["position_rmse_m"]


def written_fit(
    continuation: Continuation, winner: Fit, stage: int, on: list[Witness], rng: np.random.Generator
) -> tuple[Fit, dict[str, list[Share]], list[str]]:
    """The winner less what does not carry over, fitted anew; the shares of every effect instance by its
    label, of one that was left out those that it failed by; and the labels of those.

    The worst is left out first, since the others may carry over without it; and so on while all together
    predict worse than the boat file.
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
    nothing = continuation.fit(stage, Hypothesis(), np.zeros(0))
    for one in on:
        for horizon in options().judged_horizons:
            before, _ = one.errors(continuation, stage, nothing, horizon)
            after, block = one.errors(continuation, stage, written, horizon)
            paired = change(before[:, POSITIONS], after[:, POSITIONS], block, rng)
            if paired is not None and paired.ci95[1] < 0.0:
                return True
    return False
