"""Settings of pilots: strict models that refuse unknown keys."""

from collections.abc import Sequence
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from swamp_rl.runs import Run

LARGEST = 1e15
"Its square is finite in single precision."
Positive = Annotated[float, Field(gt=0.0, le=LARGEST)]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Seconds = Annotated[float, Field(ge=0.0, le=60.0)]
"Of a reaction."
Count = Annotated[int, Field(ge=1, le=10**9)]
"Of what is done one after another, and only takes time."
Many = Annotated[int, Field(ge=1, le=100_000)]
"Of what is held in memory at once: boats, rows of a batch, runs."
Hold = Annotated[int, Field(ge=1, le=10_000)]
"Steps for which an action is held: 10 s of the shortest step."
Width = Annotated[int, Field(ge=1, le=4096)]
"Units of a layer: a reservoir's joints are the square of it."
Layers = Annotated[tuple[Width, ...], Field(min_length=1, max_length=16)]
Seed = Annotated[int, Field(ge=0, lt=2**32)]


def _in_order(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] > ends[1]:
        raise ValueError("the first number is above the second; exchange them")
    return ends


IN_ORDER = AfterValidator(_in_order)
Range = Annotated[tuple[NotNegative, NotNegative], IN_ORDER]


class Settings(BaseModel):
    """Base of every pilot's settings: frozen, with unknown keys and infinite numbers refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True)

    def check_count(self, count: int) -> None:
        """Raise SettingsError where a training needs more than `count` runs."""

    def check_runs(self, runs: Sequence[Run]) -> None:
        """Raise SettingsError where these runs do not suffice for a training, before any work."""
        self.check_count(len(runs))
