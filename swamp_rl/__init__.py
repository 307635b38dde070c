"""A small-craft laboratory: the boat, what departs from it, and the pilots that learn to drive it.

Importing it registers the Gymnasium environments of `swamp_rl.envs`.
"""

from pathlib import Path

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
