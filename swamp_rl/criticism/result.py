"""The models of `diagnosis.json`; `schema_text(Diagnosis, TITLE)` is its published schema.

python -m swamp_rl.criticism.result docs/diagnosis.schema.json
"""

import sys
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from swamp_rl.files import write_text
from swamp_rl.json_text import schema_text

TITLE = "diagnosis.json of swamp-rl diagnose"

GainOn = Literal["each_run_in_turn", "other_runs", "same_run"]
Judged = Literal["position_rmse_m", "heading_rmse_rad"]
Limit = Literal["at_least", "at_most"]
Wind = Literal["fitted", "measured"]
Verdict = Literal["nothing_wrong", "cause", "indistinguishable", "unexplained"]


class Part(BaseModel):
    """A section without unknown keys."""

    model_config = ConfigDict(extra="forbid")


class Estimate(Part):
    """A fitted parameter. standard_error: one standard deviation, in `unit`; at_bound: whether it ended at a
    bound of the fit, where the standard error is meaningless; limit: the side of that bound; identifiable:
    whether the runs determine it: where they say nothing of it, `value` is the one that changes nothing.
    """

    value: float
    standard_error: float
    unit: str
    at_bound: bool = False
    limit: Limit | None = None
    identifiable: bool = True


class Spread(Part):
    """Standard deviation of a parameter between days or runs, in `unit`, and its 95 % interval."""

    value: float
    low: float
    high: float
    unit: str


class HeldOut(Part):
    """Reduction of the saturated chi2 by a cause on runs that its parameters were not fitted to.

    low: lower end of the gain's interval at `level`, corrected for the number of candidates.
    """

    gain: float
    low: float
    level: float


class Share(Part):
    """Root mean square error [m, rad] of predictions at a horizon on held-out runs, without a cause, the
    others fitted anew, and with it; ci95: of the difference, without less with; moved: root mean square
    distance between the two predictions, None in a diagnosis made before this was recorded. wind: whether the
    effects of weather that were fitted act, or the measured wind that was left out of the fit.
    """

    horizon_s: float
    quantity: Judged
    without: float
    with_cause: float
    ci95: tuple[float, float]
    moved: float | None = None
    wind: Wind = "fitted"


class Predictors(Part):
    """Root mean square position error [m] at a horizon: of the boat file, and of a boat that stays where it
    is, goes straight on at its velocity, or is the boat file's without thrust.
    """

    horizon_s: float
    boat_file: float
    at_rest: float
    constant_velocity: float
    no_thrust: float


class Cause(Part):
    """An effect that explains the misfit.

    thruster: a name, `all`, or two names; none where it has no selector. scope: whether all runs share the
    parameters, or every day or run has its own, in `groups` by its name; these are drawn from a normal
    distribution with the mean `parameters` and the standard deviation `spread`, of a vector by component.
    held_out: its confirmation, none for the hull's derivatives beside a cause. share: what it accounts for of
    the prediction error. carries_over: False where a position error on held-out runs is larger with it beyond
    chance, in the fitted wind or in the measured one; it is not written then. within_boat_errors: whether
    errors of the boat file's fitted numbers, as large as its `covariance` allows, may stand for it.
    """

    effect: str
    thruster: str | list[str] | None = None
    parameters: dict[str, Estimate]
    scope: Literal["boat", "day", "run"] = "boat"
    groups: dict[str, dict[str, Estimate]] = {}
    spread: dict[str, Spread] = {}
    held_out: HeldOut | None = None
    share: list[Share] = []
    carries_over: bool = True
    within_boat_errors: bool = False

    @property
    def label(self) -> str:
        """Effect, thrusters and what it differs by, as of the effect instance that was fitted."""
        on = [self.thruster] if isinstance(self.thruster, str) else list(self.thruster or ())
        return " ".join([self.effect, *on, *([f"by_{self.scope}"] if self.groups else [])])


class Candidate(Part):
    """A set of effects that was fitted, on the shortest windows.

    held_out_score: chi2 an independent sample on held-out runs; gain: reduction of chi2 against the boat
    file.
    """

    effect: str
    held_out_score: float
    gain: float
    gain_ci: tuple[float, float]


class Contrast(Part):
    """Similarity of two hypotheses. angle: between their sensitivities [rad], initial states projected out;
    evidence: information criterion of the second above the first's; mutual_refit: chi2 that remains when one
    is fitted to noise-free data of the other; rival: the second one's causes.
    """

    effects: list[str]
    angle: float
    evidence: float
    mutual_refit: float
    rival: list[Cause] = []


class Manoeuvre(Part):
    """The manoeuvre that separates the rivals. separation: in standard errors."""

    manoeuvre: str
    separation: float
    duration_s: float


class RatedManoeuvre(Part):
    """A manoeuvre within the limits of the next trial, which ends where it exceeds one. evidence: as that of
    the next trial.
    """

    manoeuvre: str
    evidence: float
    duration_s: float


class Separated(Part):
    """Two hypotheses and their expected distance in the next trial, in standard errors, the less of the two
    ways round.
    """

    effects: list[str]
    separation: float


class Narrowed(Part):
    """The parameter whose standard error is the greatest of its typical size, now and as expected after the
    next trial, in `unit`; scatter: variance of its estimates between runs beyond the noise, in squares of
    `before`; identifiable: whether the runs determine it now.
    """

    effect: str
    parameter: str
    unit: str
    before: float
    after: float
    scatter: float = 0.0
    identifiable: bool = True


class NextTrial(Part):
    """The trial of greatest expected evidence within limits, whose commands are the file beside this one.

    evidence: twice the expected difference of log likelihood between the two hypotheses that it separates
    least; about a parameter, the information that it adds as a multiple of what the runs gave. hold_s: the
    shortest time that a command is held; area_m: sides to the north and east; start_m: north and east of the
    start, at rest, bow to the north, from the area's south-west corner; top_speed: greatest over ground [m/s]
    under any hypothesis; of_list: the fixed manoeuvres within the same limits, the best first.
    """

    file: str
    duration_s: float
    hold_s: float
    area_m: tuple[float, float]
    start_m: tuple[float, float]
    top_speed: float
    evidence: float
    separates: list[Separated] = []
    narrows: Narrowed | None = None
    of_list: list[RatedManoeuvre]


class CurvePoint(Part):
    """A function's value: at [SI, rad] of the variable, force and its standard error [N, N m]."""

    at: float
    force: float
    standard_error: float


class ResidualForce(Part):
    """A residual force, and the variable that it is a function of.

    force: surge, sway, yaw, north, east, or `thrust of` a thruster; explained: share of its variance that the
    function explains on held-out runs; gain: fall of chi2 there; curve: the
    function estimated from all runs, linear between its points; beside: the causes that the boat file was
    extended by for this estimate.
    """

    force: str
    variable: str
    explained: float
    gain: float = 0.0
    curve: list[CurvePoint] = []
    beside: list[str] = []


class ForceCurve(Part):
    """A force as a function of a variable, as an effect `force_curve` holds it. standard_errors: of `values`,
    whose units are `units`.
    """

    component: str
    covariate: str
    thruster: str | None = None
    formula: str | None = None
    knots: list[float]
    values: list[float]
    standard_errors: list[float]
    units: list[str]


class Extension(Part):
    """The force that no named effect explains, as effects of the extended boat. beside: the effects that were
    fitted together with it; held_out: its confirmation; share: what it accounts for of the prediction error,
    beside these; written: whether it is in extended_boat.yaml, which takes an interval above zero.
    """

    curves: list[ForceCurve]
    beside: list[Cause] = []
    held_out: HeldOut
    share: list[Share] = []
    written: bool


class Paired(Part):
    """Root mean square error before and after; ci95: 95 % interval of before less after, paired."""

    before: float
    after: float
    ci95: tuple[float, float]


class Gain(Part):
    """Errors at the end of a horizon on held-out runs; a quantity that was not measured is absent (null).

    restarts: number of predictions; blocks: what the bootstrap resamples, since neighbouring predictions are
    correlated.
    """

    horizon_s: float
    restarts: int
    blocks: str
    position_rmse_m: Paired | None = None
    heading_rmse_rad: Paired | None = None
    surge_rmse_m_s: Paired | None = None
    sway_rmse_m_s: Paired | None = None
    yaw_rate_rmse_rad_s: Paired | None = None


class GaussMarkovNoise(Part):
    """Gauss-Markov part of a channel's noise. standard_deviation: in the channel's SI unit."""

    standard_deviation: float
    time_constant_s: float


class SmoothedNoise(Part):
    """Noise of a channel that a filter smoothed before it was logged (SI, rad): at the sample rate, and the
    larger one that the channel is weighted by, as in `noise`; time_constant_s: of the filter.
    """

    sample_noise: float
    standard_deviation: float
    time_constant_s: float


class SelfTrial(Part):
    """How often the diagnosis finds its own answer in twins: runs simulated from the answer, with the same
    commands, lengths, sampling and noise, diagnosed from the boat file again.

    named: twins of which the same causes were the best explanation, minor ones aside; of: how many twins
    there were; confused_with: how often which other answer was given; method: whether each twin had the
    whole search, or the linearised criterion of the answer and its competitors; omitted: why there are no
    twins.
    """

    named: int
    of: int
    confused_with: dict[str, int] = {}
    method: Literal["linearised", "search"] = "linearised"
    omitted: str | None = None


class Diagnosis(Part):
    """The diagnosis.

    predictors: the boat file against trivial predictors. causes: by their share of the prediction error, the
    largest first. minor: causes whose share is below 2 %, or may be chance, and below the sensors' noise, or
    that are within the boat file's errors, which the verdict leaves out. hypotheses: how many sets of effects
    were fitted; discrete: those of them that have no number, as a swap of channels. nuisance: the hull's
    linear derivatives, and the wind's coefficients, where they had to be fitted beside a cause; correlation:
    of the errors of the parameters of `causes`, then of `nuisance`, in their order; extension: the force that
    no named effect explains; next_steps: what to do where the verdict is `unexplained`; self_trial: how often
    the diagnosis finds its own answer again, none where it was not asked; noise: standard deviation by
    channel (SI, rad); wandering: Gauss-Markov part of the noise by channel; smoothed: channels that a filter
    smoothed; unseen: effects that are not identifiable from the data; hidden: those that are, but not beside
    the model's own error; missing_motion: what to record so that they would be; gain_on: the runs that the
    gain is measured on: each in turn, its parameters from the others, other runs that were given, or the very
    run that the parameters are from.
    """

    verdict: Verdict
    predictors: list[Predictors] = []
    causes: list[Cause]
    minor: list[Cause] = []
    hypotheses: int = 0
    discrete: list[str] = []
    nuisance: list[Cause] = []
    correlation: list[list[float]] = []
    indistinguishable: list[list[str]]
    contrasts: list[Contrast]
    separating_trial: Manoeuvre | None
    next_trial: NextTrial | None = None
    leftover: list[ResidualForce]
    extension: Extension | None = None
    next_steps: list[str] = []
    candidates: list[Candidate]
    unseen: list[str]
    hidden: list[str] = []
    missing_motion: list[str] = []
    self_trial: SelfTrial | None = None
    gain: list[Gain]
    gain_on: GainOn = "each_run_in_turn"
    noise: dict[str, float]
    wandering: dict[str, GaussMarkovNoise] = {}
    smoothed: dict[str, SmoothedNoise] = {}
    adequacy: dict[str, Any]
    elapsed_s: float

    @property
    def standing(self) -> list[Cause]:
        """The causes, but those that a missing force in the extended boat was fitted in place of."""
        if self.extension is None or not self.extension.written:
            return self.causes
        beside = {one.label for one in self.extension.beside}
        return [one for one in self.causes if one.label in beside]


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    write_text(Path(sys.argv[1]), schema_text(Diagnosis, TITLE))
