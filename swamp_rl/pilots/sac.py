"""SAC (Haarnoja and others 2018) by stable-baselines3: an off-policy algorithm to compare PPO with."""

from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.checkpoint import (
    load_module_state,
    load_optimiser_state,
    module_state,
    optimiser_state,
)
from swamp_rl.pilots.legs import (
    Legs,
    ReinforcementSettings,
    drive_leg,
    load_running_statistics,
    running_statistics,
    scaling_of,
    train_in_legs,
)
from swamp_rl.pilots.network import REACH, NetworkPilot, layers_of
from swamp_rl.pilots.settings import Count, Many, Positive

BUFFER = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")
"Arrays of the replay buffer, a row for each action of all boats."


class SACSettings(ReinforcementSettings):
    """Settings of SAC."""

    boats: Many = 64
    decisions: Count = 200_000
    random: Count = 5_000
    "Initial actions that are drawn at random."
    updates: Many = 8
    "Gradient steps for each action of all boats."
    batch_size: Many = 256
    learning_rate: Positive = 1e-3
    leg: Count = 625
    "Actions of each boat in a leg, between two checkpoints."


def train_sac(
    boats: Any,
    settings: SACSettings | None = None,
    tick: Tick = lambda done: None,
    log: Log = lambda decisions, values: None,
    checkpoint: Path | None = None,
) -> NetworkPilot:
    """Train SAC in `boats`, a stable-baselines3 VecEnv as for `swamp_rl.pilots.ppo.train_ppo`.

    Returns the policy without exploration. `tick`, `log` and `checkpoint` as there; the checkpoint holds the
    replay buffer as well.
    """
    from stable_baselines3.common.vec_env import VecNormalize

    settings = settings or SACSettings()
    scaled = VecNormalize(boats, norm_reward=False, clip_obs=REACH)
    with one_thread(torch=True):
        learner = learner_of(scaled, settings)
        legs = _legs(learner, scaled, settings, tick)
        train_in_legs(legs, settings.model_dump(mode="json"), settings.decisions, log, checkpoint)
    return pilot_of(learner, scaled, settings)


def _legs(learner: Any, scaled: Any, settings: SACSettings, tick: Tick) -> Legs:
    """Return the training's functions; its state is weights, optimisers, entropy weight, scaling, buffer."""
    policy, buffer = learner.policy, learner.replay_buffer
    optimisers = {
        "actor": policy.actor.optimizer,
        "critic": policy.critic.optimizer,
        "entropy": learner.ent_coef_optimizer,
    }

    def tensors() -> dict[str, Array]:
        kept = module_state("policy", policy) | running_statistics("observation", scaled.obs_rms)
        kept["log_entropy"] = learner.log_ent_coef.detach().numpy()
        for name, optimiser in optimisers.items():
            kept |= optimiser_state(name, optimiser)
        return kept | {f"buffer.{name}": getattr(buffer, name)[: buffer.pos] for name in BUFFER}

    def restore(kept: dict[str, Array]) -> None:
        load_module_state("policy", policy, kept)
        load_running_statistics("observation", scaled.obs_rms, kept)
        learner.log_ent_coef.data[:] = float(kept["log_entropy"][0])
        for name, optimiser in optimisers.items():
            load_optimiser_state(name, optimiser, kept)
        buffer.pos = len(kept["buffer.rewards"])
        for name in BUFFER:
            getattr(buffer, name)[: buffer.pos] = kept[f"buffer.{name}"]

    def drive(leg: int) -> dict[str, float]:
        left = settings.decisions - learner.num_timesteps
        return drive_leg(learner, settings, leg, min(settings.leg * settings.boats, left), tick)

    return Legs(learner, drive, tensors, restore)


def learner_of(scaled: Any, settings: SACSettings) -> Any:
    """The untrained learner of stable-baselines3."""
    import torch
    from stable_baselines3 import SAC

    return SAC(
        "MlpPolicy",
        scaled,
        buffer_size=settings.decisions + 2 * settings.boats,  # never full
        learning_starts=settings.random,
        batch_size=settings.batch_size,
        gamma=settings.discount,
        gradient_steps=settings.updates,
        learning_rate=settings.learning_rate,
        policy_kwargs={"net_arch": list(settings.hidden), "activation_fn": torch.nn.Tanh},
        seed=settings.seed,
        device="cpu",
    )


def pilot_of(learner: Any, scaled: Any, settings: SACSettings) -> NetworkPilot:
    """Return the mean of the policy; its final tanh is one more layer before the scaling to the levers."""
    actor = learner.policy.actor
    layers = layers_of([*actor.latent_pi, actor.mu])
    last = len(layers) // 2
    layers[f"weight_{last}"] = np.diag(0.5 * (HIGHEST - LOWEST))
    layers[f"bias_{last}"] = 0.5 * (HIGHEST + LOWEST)
    return NetworkPilot("sac", settings.senses, {**scaling_of(scaled), **layers}, settings.hold)
