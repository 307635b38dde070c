"""PPO (Schulman and others 2017) by stable-baselines3, on a batch of boats that is handed in."""

import math
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.legs import (
    Legs,
    ReinforcementSettings,
    drive_leg,
    moments,
    put_moments,
    put_seen,
    put_weights,
    scaling_of,
    seen,
    train_in_legs,
    weights,
)
from swamp_rl.pilots.network import REACH, NetworkPilot, layers_of
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.ppo_warm import freeze_policy, warm_start
from swamp_rl.pilots.settings import Count, Many, Positive


class PPOSettings(ReinforcementSettings):
    """How long and how it learns.

    The learner decides every `hold` steps, for a lever that is moved ten times a second to and fro hardly
    moves the boat. It explores by state-dependent noise (gSDE, Raffin and others 2021) which is drawn anew
    every `keep` decisions.
    """

    memory: Annotated[int, Field(ge=0, le=20)] = 0
    "Earlier decisions that it knows of: what it then saw and chose."
    caution: Annotated[float, Field(ge=0)] = 0.0
    """Taken from the reward for a buoy touched or the bounds left, beyond what the environment takes. Without
    it some time saved is worth a rare loss, and buoys are passed closer than by who wants to arrive."""
    boats: Many = 128
    decisions: Count = 1_200_000
    horizon: Many = 64
    "Decisions of each boat between two updates."
    batch_size: Many = 1024
    epochs: Many = 8
    learning_rate: Positive = 7e-4
    "At the start; it falls linearly to nought at the end, without which the success gained is lost again."
    leg: Count = 8
    "Updates between two checkpoints."
    start: str | None = None
    "The clone, by its name in the experiment, that the policy begins as; its `hidden` must be the same."
    settle: Annotated[int, Field(ge=0, le=10**6)] = 2
    "Legs at the start in which a learner that begins as a clone fits its value function only."
    keep: Count = 2
    exploration: Positive = 1.5
    """Standard deviation of the weights of the noise at the start. It is large, so that the levers first go
    from end to end: from 0.6 on, some seeds soon explored too little to find the gates."""


def train_ppo(
    boats: Any,
    settings: PPOSettings | None = None,
    tick: Tick = lambda done: None,
    log: Log = lambda decisions, values: None,
    checkpoint: Path | None = None,
    start: Pilot | None = None,
) -> NetworkPilot:
    """Learn by trying in `boats`, a stable-baselines3 VecEnv of `settings.boats` observing `settings.senses`.

    Its actions, from -1 to 1, are to reach over the whole way of each lever and to be held for
    `settings.hold` steps of the boats. What comes back is the mean of the policy, without its exploration.
    `tick` hears the share done; `log` hears success, return, episodes and seconds after each leg in which
    episodes ended. With a file `checkpoint`, a training that was killed goes on from its last leg and ends
    with the same bits as one that was not. start: the pilot that `settings.start` names. UserError for a
    checkpoint that is damaged or of other settings, and for a `start` that does not fit.
    """
    from stable_baselines3.common.vec_env import VecNormalize

    from swamp_rl.pilots.cautious import CautiousBoats
    from swamp_rl.pilots.remembering import RememberingBoats

    settings = settings or PPOSettings()
    remembering = RememberingBoats(CautiousBoats(boats, settings.caution), settings.memory)
    scaled = VecNormalize(remembering, clip_obs=REACH, gamma=settings.discount)
    with one_thread(torch=True):
        learner = _learner(scaled, settings)
        if start is not None:
            warm_start(learner, scaled, start, settings.senses)
        scaled.training = start is None  # a clone's own scaling stays
        legs = _legs(learner, scaled, settings, tick, warm=start is not None)
        train_in_legs(legs, settings.model_dump(mode="json"), settings.decisions, log, checkpoint)
    learned = {**scaling_of(scaled), **mean_layers(learner.policy)}
    return NetworkPilot("ppo", settings.senses, learned, settings.hold, settings.memory)


def mean_layers(policy: Any) -> dict[str, Array]:
    """The mean of a policy with actions from -1 to 1, as the layers of a NetworkPilot, which moves levers."""
    layers = layers_of([*policy.mlp_extractor.policy_net, policy.action_net])
    last = len(layers) // 2 - 1
    reach = 0.5 * (HIGHEST - LOWEST)
    layers[f"weight_{last}"] *= reach
    layers[f"bias_{last}"] = 0.5 * (HIGHEST + LOWEST) + reach * layers[f"bias_{last}"]
    return layers


def _legs(learner: Any, scaled: Any, settings: PPOSettings, tick: Tick, warm: bool) -> Legs:
    """What is done in each leg and kept of it: weights, the optimiser's moments and what scales."""

    def drive(leg: int) -> dict[str, float]:
        freeze_policy(learner, frozen=warm and leg < settings.settle)
        update = settings.boats * settings.horizon
        left = -(-(settings.decisions - learner.num_timesteps) // update)
        return drive_leg(learner, settings, leg, min(settings.leg, left) * update, tick)

    def tensors() -> dict[str, Array]:
        kept = weights(learner.policy) | moments("optimiser", learner.policy.optimizer)
        return kept | seen("observation", scaled.obs_rms) | seen("return", scaled.ret_rms)

    def restore(kept: dict[str, Array]) -> None:
        put_weights(learner.policy, kept)
        put_moments("optimiser", learner.policy.optimizer, kept)
        put_seen("observation", scaled.obs_rms, kept)
        put_seen("return", scaled.ret_rms, kept)

    return Legs(learner, drive, tensors, restore)


def _learner(scaled: Any, settings: PPOSettings) -> Any:
    """stable-baselines3's PPO; its learning rate falls in a straight line over the whole training."""
    from stable_baselines3 import PPO

    def rate(_: float) -> float:
        done = learner.num_timesteps / settings.decisions if learner is not None else 0.0
        return settings.learning_rate * max(0.0, 1.0 - done)

    learner: Any = None
    learner = PPO(
        "MlpPolicy",
        scaled,
        n_steps=settings.horizon,
        batch_size=settings.batch_size,
        n_epochs=settings.epochs,
        gamma=settings.discount,
        learning_rate=rate,
        use_sde=True,
        sde_sample_freq=settings.keep,
        policy_kwargs={"net_arch": list(settings.hidden), "log_std_init": math.log(settings.exploration)},
        seed=settings.seed,
        device="cpu",
    )
    return learner
