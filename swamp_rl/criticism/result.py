"""What `diagnosis.json` holds; `Diagnosis.model_json_schema()` is its published schema."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

GainOn = Literal["each_run_in_turn", "other_runs", "same_run"]
Limit = Literal["at_least", "at_most"]
Verdict = Literal["nothing_wrong", "cause", "indistinguishable", "unexplained"]


class Part(BaseModel):
    """A section without unknown keys."""

    model_config = ConfigDict(extra="forbid")


class Estimate(Part):
    """A fitted number. standard_error: one standard deviation, in `unit`; at_bound: whether it ended at the
    edge of what the fit may try, where the standard error says nothing; limit: how it is to be read there.
    """

    value: float
    standard_error: float
    unit: str
    at_bound: bool = False
    limit: Limit | None = None


class HeldOut(Part):
    """What a cause saves on runs that its numbers were not fitted to, as saturated chi2.

    low: lower end of the gain's interval, which covers `level`, once all candidates are accounted for.
    """

    gain: float
    low: float
    level: float


class Cause(Part):
    """An effect that explains the misfit. thruster: a name, `all`, or two names; none where it has no
    selector. held_out: the confirmation, none of the hull's derivatives beside a cause.
    """

    effect: str
    thruster: str | list[str] | None = None
    parameters: dict[str, Estimate]
    held_out: HeldOut | None = None


class Candidate(Part):
    """A set of effects that was tried, on the shortest windows.

    held_out_score: chi2 a sample on runs held out; gain: how much lower than with nothing added, in chi2.
    """

    effect: str
    held_out_score: float
    gain: float
    gain_ci: tuple[float, float]


class Contrast(Part):
    """How alike two explanations act. angle: between their sensitivity directions [rad], nuisances
    projected out; rival: the second one's causes with their numbers.
    """

    effects: list[str]
    angle: float
    evidence: float
    mutual_refit: float
    rival: list[Cause] = []


class Trial(Part):
    """The manoeuvre that would tell rivals apart, and by how many standard errors."""

    manoeuvre: str
    separation: float
    duration_s: float


class Point(Part):
    """A function's value: at [SI, rad] of the variable, force and its standard error [N, N m]."""

    at: float
    force: float
    standard_error: float


class Leftover(Part):
    """A residual force, and the variable that it is a function of.

    force: surge, sway, yaw, north, east, or `thrust of` a thruster; explained: share of its variance
    that the function explains on held-out runs; curve: the function estimated from all runs, linear between
    its points; beside: the causes that the boat file was extended by for this estimate.
    """

    force: str
    variable: str
    explained: float
    curve: list[Point] = []
    beside: list[str] = []


class Paired(Part):
    """Root mean square error before and after; ci95: of before less after, paired."""

    before: float
    after: float
    ci95: tuple[float, float]


class Gain(Part):
    """Errors at the end of a horizon on held-out runs; a quantity that was not measured is absent (null).

    restarts: how many predictions; blocks: what the intervals resample, since neighbours are not independent.
    """

    horizon_s: float
    restarts: int
    blocks: str
    position_rmse_m: Paired | None = None
    heading_rmse_rad: Paired | None = None
    surge_rmse_m_s: Paired | None = None
    sway_rmse_m_s: Paired | None = None
    yaw_rate_rmse_rad_s: Paired | None = None


class Wandering(Part):
    """The part of a channel's errors that lasts. standard_deviation: in the channel's SI unit."""

    standard_deviation: float
    time_constant_s: float


class Diagnosis(Part):
    """The answer. nuisance: the hull's linear derivatives where they had to be fitted beside a cause;
    correlation: of the errors of the numbers of `causes`, then of `nuisance`, in their order; noise:
    standard deviation by channel (SI, rad); unseen: candidates that these data cannot show; missing_motion:
    what to record so that they would show more; gain_on: the runs that the gain is measured on: each in turn,
    its numbers from the others, other runs that were given, or the very run that the numbers are from.
    """

    verdict: Verdict
    causes: list[Cause]
    nuisance: list[Cause] = []
    correlation: list[list[float]] = []
    indistinguishable: list[list[str]]
    contrasts: list[Contrast]
    separating_trial: Trial | None
    leftover: list[Leftover]
    candidates: list[Candidate]
    unseen: list[str]
    missing_motion: list[str] = []
    gain: list[Gain]
    gain_on: GainOn = "each_run_in_turn"
    noise: dict[str, float]
    wandering: dict[str, Wandering] = {}
    adequacy: dict[str, Any]
    elapsed_s: float
