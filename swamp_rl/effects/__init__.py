"""Effects: named departures from the boat file, with numbers or drawn at random (disturbances)."""

from swamp_rl.effects import library as library
from swamp_rl.effects.apply import apply_effects
from swamp_rl.effects.declare import LIBRARY, Effect, Parameter, neutral_fields
from swamp_rl.effects.entries import EffectEntry, parse_effects
from swamp_rl.effects.levels import Level, load_disturbances
from swamp_rl.effects.search import Reference, Search

__all__ = [
    "LIBRARY",
    "Effect",
    "EffectEntry",
    "Level",
    "Parameter",
    "Reference",
    "Search",
    "apply_effects",
    "load_disturbances",
    "neutral_fields",
    "parse_effects",
]
