"""What a page may say to the recorder, and nothing else."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from swamp_rl.clipped import clipped, printable
from swamp_rl.errors import UserError
from swamp_rl.explain import explanations

LARGEST = 1024  # bytes of a message; the longest that a page sends has under 200
NICKNAME_LENGTH = 24
LONGEST_FAULT = 160

Share = Annotated[float, Field(ge=0.0, le=1.0)]
Signed = Annotated[float, Field(ge=-1.0, le=1.0)]
Turns = Annotated[float, Field(ge=-2.0, le=2.0)]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Command(_Message):
    """Where the levers stand; the stern's azimuth is in quarter turns clockwise from the bow.

    live: False when the page has lost the person's attention, which stops the thrusters at once.
    """

    type: Literal["command"]
    throttle: Share
    angle: Signed
    stern_throttle: Share = 0.0
    stern_azimuth: Turns = 0.0
    live: bool = True


class Act(_Message):
    """A button: what to do with the run, or with the helm and the seat."""

    type: Literal["act"]
    act: Literal["accept", "discard", "retry", "helm", "seat"]


class Choose(_Message):
    """Who drives what, in which weather: names that the recorder offers, but the nickname is free."""

    type: Literal["choose"]
    nickname: Annotated[str, Field(max_length=NICKNAME_LENGTH)] | None = None
    boat: Annotated[str, Field(max_length=100)] | None = None
    level: Annotated[str, Field(max_length=100)] | None = None
    pilot: Annotated[str, Field(max_length=100)] | None = None


Message = Command | Act | Choose
_ANY: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="type")])


def parse(text: str | bytes) -> Message:
    """The message in `text`; UserError, in one printable line, if it is none."""
    if len(text) > LARGEST:
        raise UserError(f"a message of {len(text)} bytes, at most {LARGEST} are read; load the page again")
    try:
        return _ANY.validate_json(text)
    except ValidationError as error:
        place, message = explanations(error, None)[0]
        fault = clipped(f"{place}: {message}" if place else message, LONGEST_FAULT)
        raise UserError(f"malformed message ({fault}); load the page again") from error


def clean_nickname(name: str) -> str:
    """The printable part of a nickname, single-spaced; `anonymous` if nothing is left."""
    return " ".join(printable(name).split())[:NICKNAME_LENGTH].strip() or "anonymous"
