"""What an experiment on the thesis's claims says beforehand: pilot, levels, smallest effects that count."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Share = Annotated[float, Field(ge=0.0, le=1.0)]
Count = Annotated[int, Field(ge=2, le=1_000)]
Levels = Annotated[tuple[str, ...], Field(strict=False, min_length=1)]


class Least(BaseModel):
    """Smallest effects of interest: an interval wholly beyond one supports its hypothesis."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    success: Share = 0.9
    "Success rate to be exceeded with a few runs."
    loss: Share = 0.05
    "Tolerated loss of success: with fewer runs, or with disturbances."
    novelty: Annotated[float, Field(gt=0.0, le=1.0)] = 0.5
    "Distance of tracks relative to that among the runs of the data."
    success_elsewhere: Share = 0.5
    "Success rate from starts outside the training tracks."
    saving: Share = 0.1
    "Relative reduction of the command change and of the power."


class Claims(BaseModel):
    """The claims of thesis 7.3.3 about a pilot that learned from runs, as hypotheses.

    pilot: one of the experiment's, trained again on each of `draws` samples of its runs. runs: numbers of
    runs it learns from, of which `few` is what the claims are about and the highest what it is compared
    with. The others are names of levels that the experiment evaluates: `at` is like the data's, `calm` is
    without disturbance.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    pilot: str
    draws: Count = 10
    runs: Annotated[tuple[Count, ...], Field(strict=False, min_length=2)] = (5, 10, 20, 40)
    few: Count = 20
    at: str = "standard"
    calm: str = "calm"
    disturbed: Levels = ("gusts", "current", "kicks", "standard")
    elsewhere: Levels = ("elsewhere", "reversed")
    least: Least = Least()
