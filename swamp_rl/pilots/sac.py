"""SAC (Haarnoja and others 2018) by stable-baselines3: another way of learning by trying, as a check."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array
from swamp_rl.pilots.legs import (
    Legs,
    Log,
    begin_leg,
    moments,
    put_moments,
    put_seen,
    put_weights,
    seen,
    train_in_legs,
    weights,
)
from swamp_rl.pilots.network import REACH, NetworkPilot, layers_of
from swamp_rl.pilots.ppo import SENSES, scaling_of
from swamp_rl.pilots.settings import Count, Layers, Many, Positive, Seed, Settings, Share
from swamp_rl.pilots.tally import Tally

BUFFER = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")
"Arrays of the replay buffer, a row for each decision of all boats."


class SACSettings(Settings):
    """How long and how it learns."""

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = SENSES
    hidden: Layers = (64, 64)
    hold: Many = 6
    "Steps of the boat for which a decision is held, in training and after."
    boats: Many = 64
    decisions: Count = 200_000
    "Of all boats together."
    random: Count = 5_000
    "Decisions at the start that are drawn at random."
    updates: Many = 8
    "Gradient steps each time all boats have decided once."
    batch_size: Many = 256
    discount: Share = 0.98
    "For each decision."
    learning_rate: Positive = 1e-3
    leg: Count = 625
    """Decisions of each boat between two checkpoints. Each leg starts all boats anew, with random numbers of
    its own, so it must last longer than episodes do."""
    seed: Seed = 0


def train_sac(
    boats: Any,
    settings: SACSettings | None = None,
    tick: Callable[[float], None] = lambda done: None,
    log: Log = lambda decisions, values: None,
    checkpoint: Path | None = None,
) -> NetworkPilot:
    """Learn by trying in `boats`, a stable-baselines3 VecEnv as for `swamp_rl.pilots.ppo.train_ppo`.

    What comes back is the policy without its exploration. `tick`, `log` and `checkpoint`, which holds the
    replay buffer too, as there.
    """
    from stable_baselines3.common.vec_env import VecNormalize

    settings = settings or SACSettings()
    scaled = VecNormalize(boats, norm_reward=False, clip_obs=REACH)
    with one_thread(torch=True):
        learner = _learner(scaled, settings)
        legs = _legs(learner, scaled, settings, tick)
        train_in_legs(legs, settings.model_dump(mode="json"), settings.decisions, log, checkpoint)
    return _pilot(learner, scaled, settings)


def _legs(learner: Any, scaled: Any, settings: SACSettings, tick: Callable[[float], None]) -> Legs:
    """What is done in each leg, and kept of it: weights, moments, the entropy's weight, scaling, buffer."""
    policy, buffer = learner.policy, learner.replay_buffer
    optimisers = {
        "actor": policy.actor.optimizer,
        "critic": policy.critic.optimizer,
        "entropy": learner.ent_coef_optimizer,
    }

    def tensors() -> dict[str, Array]:
        kept = weights(policy) | seen("observation", scaled.obs_rms)
        kept["log_entropy"] = learner.log_ent_coef.detach().numpy()
        for name, optimiser in optimisers.items():
            kept |= moments(name, optimiser)
        return kept | {f"buffer.{name}": getattr(buffer, name)[: buffer.pos] for name in BUFFER}

    def restore(kept: dict[str, Array]) -> None:
        put_weights(policy, kept)
        put_seen("observation", scaled.obs_rms, kept)
        learner.log_ent_coef.data[:] = float(kept["log_entropy"][0])
        for name, optimiser in optimisers.items():
            put_moments(name, optimiser, kept)
        buffer.pos = len(kept["buffer.rewards"])
        for name in BUFFER:
            getattr(buffer, name)[: buffer.pos] = kept[f"buffer.{name}"]

    return Legs(learner, lambda leg: _leg(learner, settings, leg, tick), tensors, restore)


def _leg(learner: Any, settings: SACSettings, leg: int, tick: Callable[[float], None]) -> dict[str, float]:
    """Some decisions; their boats and random numbers depend on the seed and the number of the leg alone."""
    from stable_baselines3.common.callbacks import ConvertCallback

    begin_leg(learner, settings.seed, leg)
    tally = Tally(settings.boats)

    def hear(known: dict[str, Any], _: dict[str, Any]) -> bool:
        tally.add(learner.env.get_original_reward(), known["dones"], known["infos"])
        tick(min(1.0, learner.num_timesteps / settings.decisions))
        return True

    left = settings.decisions - learner.num_timesteps
    asked = min(settings.leg * settings.boats, left)
    learner.learn(asked, callback=ConvertCallback(hear), reset_num_timesteps=False)
    return tally.means()


def _learner(scaled: Any, settings: SACSettings) -> Any:
    import torch
    from stable_baselines3 import SAC

    return SAC(
        "MlpPolicy",
        scaled,
        buffer_size=settings.decisions + 2 * settings.boats,  # so that it is never full
        learning_starts=settings.random,
        batch_size=settings.batch_size,
        gamma=settings.discount,
        gradient_steps=settings.updates,
        learning_rate=settings.learning_rate,
        policy_kwargs={"net_arch": list(settings.hidden), "activation_fn": torch.nn.Tanh},
        seed=settings.seed,
        device="cpu",
    )


def _pilot(learner: Any, scaled: Any, settings: SACSettings) -> NetworkPilot:
    """The mean of the policy, whose tanh at the end is one more layer before the levers' ways."""
    actor = learner.policy.actor
    layers = layers_of([*actor.latent_pi, actor.mu])
    last = len(layers) // 2
    layers[f"weight_{last}"] = np.diag(0.5 * (HIGHEST - LOWEST))
    layers[f"bias_{last}"] = 0.5 * (HIGHEST + LOWEST)
    return NetworkPilot("sac", settings.senses, {**scaling_of(scaled), **layers}, settings.hold)
