"""What every section of a boat file is made of: the strict model, and the limits that its numbers share."""

import math
from typing import Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from swamp_rl.clipped import clipped
from swamp_rl.constants import HEAVIEST_WATER, LIGHTEST_WATER


def _filled(given: tuple[Any, ...]) -> tuple[Any, ...]:
    # A least length declared as such would be missed, too, by a list whose items are at fault.
    if not given:
        raise ValueError("is empty; give at least one")
    return given


FILLED = AfterValidator(_filled)
POSITIVE, NOT_NEGATIVE, NOT_POSITIVE = Field(gt=0), Field(ge=0), Field(le=0)
WATER = Field(ge=LIGHTEST_WATER, le=HEAVIEST_WATER)
FRACTION, BELOW_ONE = Field(ge=0, le=1), Field(lt=1)
ANGLE = Field(ge=-2 * math.pi, le=2 * math.pi)
FROM_LIST = Field(strict=False)  # YAML has lists, a frozen model holds tuples
NAME = Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")


def _on_one_line(name: str) -> str:
    if not name.isprintable():
        raise ValueError(f"{clipped(name)!r} must print on one line")
    return name


PRINTED = AfterValidator(_on_one_line)


def _known_kind(kind: Any) -> Any:
    # The models of two of them would not name the third.
    if kind not in ("azimuth", "fixed", "propeller_rudder"):
        known = {"expected": "'azimuth', 'fixed' or 'propeller_rudder'"}
        raise PydanticCustomError("literal_error", "{expected}", known)
    return kind


KIND = BeforeValidator(_known_kind)


class Part(BaseModel):
    """A strict, frozen section of a boat file."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, use_attribute_docstrings=True
    )
