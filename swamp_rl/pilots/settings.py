"""How the settings of pilots are read: strictly, so that a misspelt option is told and not ignored."""

from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field

from swamp_rl.files import validated

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Count = Annotated[int, Field(ge=1)]
Seed = Annotated[int, Field(ge=0, lt=2**32)]
Range = tuple[NotNegative, NotNegative]


class Settings(BaseModel):
    """Base of every pilot's settings: frozen, with unknown keys and infinite numbers refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True)


AnySettings = TypeVar("AnySettings", bound=Settings)


def settings_from(where: str, kind: type[AnySettings], options: dict[str, Any]) -> AnySettings:
    """Settings of a kind from options read in `where` (a file); UserError names the first wrong key."""
    return validated(where, kind, options)
