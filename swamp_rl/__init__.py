"""A small-craft laboratory: the boat, what departs from it, and the pilots that learn to drive it.

Importing it registers the Gymnasium environments of `swamp_rl.envs`. The public names are imported when they
are first used; `__init__.pyi` tells type checkers what they are.
"""

import importlib
from pathlib import Path
from typing import Any

from gymnasium.envs.registration import register, registry

__version__ = "0.2.0"

_checkout = Path(__file__).resolve().parents[1]
if not (
    Path(__file__).parent / "envs"
).is_dir():  # a checkout keeps `envs` and `experiments` beside this folder
    __path__.append(str(_checkout))

# Default boats by environment: v0 keeps flying the thesis's model, so that results on it stay reproducible.
ENVIRONMENTS = {"swamp/Gates-v0": "swamp-thesis", "swamp/Gates-v1": "swamp"}

for _id, _boat in ENVIRONMENTS.items():
    if _id not in registry:
        register(
            id=_id,
            entry_point="swamp_rl.envs.single:GatesEnv",
            vector_entry_point="swamp_rl.envs.batched:GatesVectorEnv",
            kwargs={"boat": _boat},
        )

PUBLIC = {  # name -> module and what it is there; no colon: the package itself
    "course": "swamp_rl.course",
    "diagnose": "swamp_rl.criticism.diagnose:diagnose",
    "effects": "swamp_rl.effects",
    "evaluate": "swamp_rl.experiments.studies.stored:evaluate_folders",
    "identify": "swamp_rl.api:identify",
    "identify_boat": "swamp_rl.boat_fit.identify:identify_boat",
    "load_boat": "swamp_rl.boat:load_boat",
    "load_pilot": "swamp_rl.pilots:load_pilot",
    "read_runs": "swamp_rl.runs:read_dataset",
    "run_experiment": "swamp_rl.experiments.studies.run:run_experiment",
    "simulate": "swamp_rl.api:simulate",
    "train": "swamp_rl.experiments.studies.run:train_experiment",
    "trial": "swamp_rl.api:trial",
}
__all__ = list(PUBLIC)  # `help(swamp_rl)` documents them


def __getattr__(name: str) -> Any:
    if name not in PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, _, inside = PUBLIC[name].partition(":")
    found = importlib.import_module(module)
    globals()[name] = getattr(found, inside) if inside else found
    return globals()[name]


def __dir__() -> list[str]:
    return sorted({*globals(), *PUBLIC})
