"""How much of the prediction error each cause accounts for: leave it out."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.cross_validation import judged_numbers
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.likelihood.prediction_error import QUANTITIES, blocks_of, change, errors_at
from swamp_rl.criticism.model.candidates import EffectInstance, Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Judged, Share, Wind
from swamp_rl.criticism.selection.backward_elimination import without
from swamp_rl.criticism.selection.continuation import Continuation

Array = NDArray[np.float64]
Predicted = tuple[Array, NDArray[np.int64]]  # errors (n, 6) and the block of each (n,)

JUDGED: tuple[Judged, ...] = ("position_rmse_m", "heading_rmse_rad")


@dataclass(frozen=True)
class Witness:
    """Runs that predictions are compared with. weight: (R, T, 6); others: whether they are other runs than
    those fitted to; where not, each run's numbers come from the others; measured_wind: whether the run set
    has the measured wind, left out of the fit: the boat's own effects alone are judged in it then.
    """

    run_set: RunSet
    weight: Array
    others: bool
    measured_wind: bool = False

    @property
    def wind(self) -> Wind:
        """The wind that its predictions are made in."""
        return "measured" if self.measured_wind else "fitted"

    def judges(self, instance: EffectInstance) -> bool:
        """Whether an effect instance is one that predictions here depend on: not what other runs had of their
        own.
        """
        if self.others and instance.groups:
            return False
        return not self.measured_wind or instance.effect.scope == "boat"

    def errors(self, continuation: Continuation, stage: int, of: Fit, horizon: float) -> Predicted:
        """Errors of predictions under a fit at a stage."""
        runs = len(self.run_set.lengths)
        problem = continuation.problem(stage, of.hypothesis)
        hypothesis, numbers = judged_numbers(problem, of, runs, self.others)
        kept = np.array(
            [self.judges(instance) for instance in hypothesis.instances for _ in instance.specs], dtype=bool
        )
        hypothesis = Hypothesis(tuple(one for one in hypothesis.instances if self.judges(one)))
        made = errors_at(self.run_set, self.weight, horizon, hypothesis, numbers[:, kept])
        return made.error, blocks_of(made, horizon)[0]


def witnesses(on: Witness, rng: np.random.Generator) -> list[Witness]:
    """Those runs, and again in the measured wind where `ignore` left it out of the fit. A wind without which
    the boat file predicts no worse is not taken: its sensor says nothing.
    """
    blown = on.run_set.in_ignored_wind
    if blown is None:
        return [on]
    horizon, none = options().judged_horizons[-1], np.zeros((len(blown.lengths), 0))
    calm, windy = (errors_at(one, on.weight, horizon, Hypothesis(), none) for one in (on.run_set, blown))
    positions = QUANTITIES[JUDGED[0]]
    paired = change(calm.error[:, positions], windy.error[:, positions], blocks_of(calm, horizon)[0], rng)
    helps = paired is not None and paired.ci95[0] > 0.0
    return [on, Witness(blown, on.weight, on.others, measured_wind=True)] if helps else [on]


def cause_shares(
    continuation: Continuation, of: Fit, stage: int, on: list[Witness], rng: np.random.Generator
) -> dict[str, list[Share]]:
    """Of each effect instance of a fit at a stage, by its label: errors without it and with it.

    Without it the others are fitted anew.
    """
    shares: dict[str, list[Share]] = {}
    whole = {
        (i, horizon): one.errors(continuation, stage, of, horizon)
        for i, one in enumerate(on)
        for horizon in options().judged_horizons
    }
    for instance in of.hypothesis.instances:
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
    return [
        Share(
            horizon_s=horizon,
            quantity=name,
            without=paired.before,
            with_cause=paired.after,
            ci95=paired.ci95,
            wind=wind,
        )
        for name in JUDGED
        if (paired := change(before[:, QUANTITIES[name]], after[:, QUANTITIES[name]], block, rng))
    ]


def is_minor(shares: list[Share], noise: Mapping[str, float]) -> bool:
    """Whether a cause changes every error by less than `minor` of it and by less than the sensor's noise.

    noise: standard deviation by channel (SI, rad). False where no error could be measured.
    """
    sizes = {
        "position_rmse_m": np.hypot(noise.get("north", 0.0), noise.get("east", 0.0)),
        "heading_rmse_rad": noise.get("heading", 0.0),
    }
    return bool(shares) and all(
        abs(one.without - one.with_cause) < min(options().minor * one.without, sizes[one.quantity])
        for one in shares
    )
