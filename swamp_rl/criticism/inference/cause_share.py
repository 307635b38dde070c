"""How much of the prediction error each cause accounts for: leave it out."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.cross_validation import judged_numbers
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.likelihood.prediction_error import QUANTITIES, blocks_of, change, errors_at
from swamp_rl.criticism.result import Judged, Share
from swamp_rl.criticism.selection.backward_elimination import Selection, without
from swamp_rl.criticism.selection.continuation import Continuation

Array = NDArray[np.float64]

HORIZONS = (10.0, 30.0)  # s
JUDGED: tuple[Judged, ...] = ("position_rmse_m", "heading_rmse_rad")
MINOR = 0.02  # of the error without the cause, below which it is minor if it is below the sensor's noise too


def cause_shares(
    continuation: Continuation,
    found: Selection,
    judged: tuple[RunSet, Array, bool],
    rng: np.random.Generator,
) -> dict[str, list[Share]]:
    """Of each effect instance of the winner, by its label: errors without it and with it.

    Without it the others are fitted anew. judged: the runs that the errors are of, their weight (R, T, 6),
    and whether they are other runs than those fitted to; where not, each run's numbers come from the others.
    """
    winner = found.winner
    run_set, weight, others = judged

    def errors(of: Fit, horizon: float) -> tuple[Array, NDArray[np.int64]]:
        problem = continuation.problem(found.stage, of.hypothesis)
        hypothesis, numbers = judged_numbers(problem, of, len(run_set.lengths), others)
        made = errors_at(run_set, weight, horizon, hypothesis, numbers)
        return made.error, blocks_of(made, horizon)[0]

    whole = {horizon: errors(winner, horizon) for horizon in HORIZONS}
    shares: dict[str, list[Share]] = {}
    for instance in winner.hypothesis.instances:
        less = without(continuation, winner, instance.label, found.stage)
        before = {horizon: errors(less, horizon)[0] for horizon in HORIZONS}
        shares[instance.label] = [
            Share(
                horizon_s=horizon,
                quantity=name,
                without=paired.before,
                with_cause=paired.after,
                ci95=paired.ci95,
            )
            for horizon, (after, block) in whole.items()
            for name in JUDGED
            if (paired := change(*_columns(name, before[horizon], after), block, rng))
        ]
    return shares


def _columns(name: str, before: Array, after: Array) -> tuple[Array, Array]:
    columns = QUANTITIES[name]
    return before[:, columns], after[:, columns]


def is_minor(shares: list[Share], noise: Mapping[str, float]) -> bool:
    """Whether a cause changes every error by less than MINOR of it and by less than the sensor's noise.

    noise: standard deviation by channel (SI, rad). False where no error could be measured.
    """
    sizes = {
        "position_rmse_m": np.hypot(noise.get("north", 0.0), noise.get("east", 0.0)),
        "heading_rmse_rad": noise.get("heading", 0.0),
    }
    return bool(shares) and all(
        abs(one.without - one.with_cause) < min(MINOR * one.without, sizes[one.quantity]) for one in shares
    )


def carries_over(shares: list[Share]) -> bool:
    """Whether no position error at any horizon is larger with the cause beyond chance."""
    return all(one.ci95[1] >= 0.0 for one in shares if one.quantity == "position_rmse_m")
