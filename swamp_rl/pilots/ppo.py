"""PPO (Schulman and others 2017) by stable-baselines3, on a batch of boats that is handed in."""

import math
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array
from swamp_rl.pilots.demonstrations import MOTION, NEXT_GATE, POSE
from swamp_rl.pilots.network import REACH, NetworkPilot, layers_of
from swamp_rl.pilots.settings import Count, Positive, Seed, Settings, Share

SENSES = (*POSE, *MOTION, *NEXT_GATE)


class PPOSettings(Settings):
    """How long and how it learns.

    The learner decides every `hold` steps, for a lever that is moved ten times a second to and fro hardly
    moves the boat. It explores by state-dependent noise (gSDE, Raffin and others 2021) which is drawn anew
    every `keep` decisions.
    """

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = SENSES
    hidden: Annotated[tuple[Count, ...], Field(min_length=1)] = (64, 64)
    hold: Count = 6
    "Steps of the boat for which a decision is held, in training and after."
    boats: Count = 128
    decisions: Count = 1_200_000
    "Of all boats together."
    horizon: Count = 64
    "Decisions of each boat between two updates."
    batch_size: Count = 1024
    epochs: Count = 8
    discount: Share = 0.98
    "For each decision."
    learning_rate: Positive = 7e-4
    "At the start; it falls linearly to nought at the end, without which the success gained is lost again."
    keep: Count = 2
    exploration: Positive = 1.5
    """Standard deviation of the weights of the noise at the start. It is large, so that the levers first go
    from end to end: from 0.6 on, some seeds soon explored too little to find the gates."""
    seed: Seed = 0


def train_ppo(
    boats: Any, settings: PPOSettings | None = None, tick: Callable[[float], None] = lambda done: None
) -> NetworkPilot:
    """Learn by trying in `boats`, a stable-baselines3 VecEnv of `settings.boats` observing `settings.senses`.

    Its actions, from -1 to 1, are to reach over the whole way of each lever and to be held for
    `settings.hold` steps of the boats. What comes back is the mean of the policy, without its exploration.
    `tick` hears the share done.
    """
    import torch
    from stable_baselines3.common.callbacks import ConvertCallback
    from stable_baselines3.common.vec_env import VecNormalize

    settings = settings or PPOSettings()
    boats.seed(settings.seed)
    scaled = VecNormalize(boats, clip_obs=REACH, gamma=settings.discount)

    def hear(known: dict[str, Any], _: dict[str, Any]) -> bool:
        tick(min(1.0, known["self"].num_timesteps / settings.decisions))
        return True

    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # layers this small are slower when divided among threads
    try:
        learner = _learner(scaled, settings)
        learner.learn(settings.decisions, callback=ConvertCallback(hear))
    finally:
        torch.set_num_threads(threads)
    seen: Any = scaled.obs_rms
    scaling = {"mean": seen.mean, "scale": np.sqrt(seen.var + scaled.epsilon)}
    return NetworkPilot("ppo", settings.senses, {**scaling, **mean_layers(learner.policy)}, settings.hold)


def mean_layers(policy: Any) -> dict[str, Array]:
    """The mean of a policy with actions from -1 to 1, as the layers of a NetworkPilot, which moves levers."""
    layers = layers_of([*policy.mlp_extractor.policy_net, policy.action_net])
    last = len(layers) // 2 - 1
    reach = 0.5 * (HIGHEST - LOWEST)
    layers[f"weight_{last}"] *= reach
    layers[f"bias_{last}"] = 0.5 * (HIGHEST + LOWEST) + reach * layers[f"bias_{last}"]
    return layers


def _learner(scaled: Any, settings: PPOSettings) -> Any:
    """stable-baselines3's PPO; its learning rate falls in a straight line."""
    from stable_baselines3 import PPO

    return PPO(
        "MlpPolicy",
        scaled,
        n_steps=settings.horizon,
        batch_size=settings.batch_size,
        n_epochs=settings.epochs,
        gamma=settings.discount,
        learning_rate=lambda left: left * settings.learning_rate,
        use_sde=True,
        sde_sample_freq=settings.keep,
        policy_kwargs={"net_arch": list(settings.hidden), "log_std_init": math.log(settings.exploration)},
        seed=settings.seed,
        device="cpu",
    )
