"""PPO (Schulman and others 2017) by stable-baselines3, on a batch of boats that is handed in."""

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.pilots.network import REACH, NetworkPilot, layers_of
from swamp_rl.pilots.settings import Count, Positive, Seed, Settings, Share

SENSES = (
    "north",
    "east",
    "cos_heading",
    "sin_heading",
    "surge",
    "sway",
    "yaw_rate",
    "gate_ahead",
    "gate_starboard",
    "gate_cos",
    "gate_sin",
    "gates_passed",
)


class PPOSettings(Settings):
    """How long and how it learns.

    Exploration is state-dependent and held for `hold` steps (gSDE, Raffin and others 2021): noise drawn anew
    ten times a second would move the levers but hardly the boat.
    """

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = SENSES
    hidden: Annotated[tuple[Count, ...], Field(min_length=1)] = (64, 64)
    boats: Count = 64
    steps: Count = 2_200_000
    "Of all boats together."
    horizon: Count = 256
    "Steps of each boat between two updates."
    batch_size: Count = 512
    epochs: Count = 8
    discount: Share = 0.995
    "For each step."
    learning_rate: Positive = 3e-4
    "At the start; it falls linearly to nought at the end, without which the success gained is lost again."
    hold: Count = 8
    seed: Seed = 0


def train_ppo(
    boats: Any, settings: PPOSettings | None = None, tick: Callable[[float], None] = lambda done: None
) -> NetworkPilot:
    """Learn by trying in `boats`, a stable-baselines3 VecEnv of `settings.boats` observing `settings.senses`.

    What comes back is the mean of the policy, without its exploration. `tick` hears the share done.
    """
    import torch
    from stable_baselines3.common.callbacks import ConvertCallback
    from stable_baselines3.common.vec_env import VecNormalize

    settings = settings or PPOSettings()
    boats.seed(settings.seed)
    scaled = VecNormalize(boats, clip_obs=REACH, gamma=settings.discount)

    def hear(known: dict[str, Any], _: dict[str, Any]) -> bool:
        tick(min(1.0, known["self"].num_timesteps / settings.steps))
        return True

    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # layers this small are slower when divided among threads
    try:
        learner = _learner(scaled, settings)
        learner.learn(settings.steps, callback=ConvertCallback(hear))
    finally:
        torch.set_num_threads(threads)
    layers = layers_of([*learner.policy.mlp_extractor.policy_net, learner.policy.action_net])
    seen: Any = scaled.obs_rms
    return NetworkPilot(
        "ppo", settings.senses, {"mean": seen.mean, "scale": np.sqrt(seen.var + scaled.epsilon), **layers}
    )


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
        sde_sample_freq=settings.hold,
        policy_kwargs={"net_arch": list(settings.hidden), "log_std_init": -0.5},
        seed=settings.seed,
        device="cpu",
    )
