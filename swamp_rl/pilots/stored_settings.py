"""What `pilot.json` may say of the settings of each kind of pilot."""

import json
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field, ValidationError

from swamp_rl.explain import explanations
from swamp_rl.pilots.line_of_sight import LineOfSightSettings
from swamp_rl.pilots.scripted import Habits
from swamp_rl.pilots.settings import Settings

Step = Annotated[float, Field(gt=0.0, le=60.0)]  # s


class Recurrent(Settings):
    """Of a reservoir and of a GRU."""

    senses: tuple[str, ...]


class Network(Settings):
    """Of a feed-forward network. hold: steps for which a decision stands; memory: observations before."""

    kind: Literal["cloning", "ppo", "sac"]
    senses: tuple[str, ...]
    hold: Annotated[int, Field(ge=1, le=1_000_000)]
    memory: Annotated[int, Field(ge=0, le=1_000)] = 0


class Scripted(Settings):
    """Of the scripted pilot; step [s]."""

    seed: Annotated[int, Field(ge=0, lt=2**63)]
    step: Step
    habits: Habits


class Part(Settings):
    """One of the two pilots of a takeover; its settings are those of its kind."""

    kind: str
    settings: dict[str, Any]


class Takeover(Settings):
    """Of a pilot that takes over from another after `seconds`; step [s]."""

    first: Part
    then: Part
    seconds: Annotated[float, Field(ge=0.0)]
    step: Step


SETTINGS: dict[str, type[BaseModel]] = {
    "scripted": Scripted,
    "line-of-sight": LineOfSightSettings,
    "reservoir": Recurrent,
    "gru": Recurrent,
    "takeover": Takeover,
    **dict.fromkeys(("cloning", "ppo", "sac"), Network),
}


def refuse_odd_settings(kind: str, settings: dict[str, Any]) -> None:
    """ValueError with the key for settings that no pilot of that kind has; any for a kind of one's own."""
    model = SETTINGS.get(kind)
    if model is None:
        return
    try:
        model.model_validate_json(json.dumps(settings), strict=True)
    except ValidationError as error:
        key, message = explanations(error, model)[0]
        raise ValueError(f"{': '.join(filter(None, ('settings', key)))}: {message}") from error
    if settings.get("kind", kind) != kind:
        raise ValueError(f"settings: kind: must be {kind}")
