"""SAC (Haarnoja and others 2018) by stable-baselines3: another way of learning by trying, as a check."""

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.pilots.arrays import HIGHEST, LOWEST
from swamp_rl.pilots.network import REACH, NetworkPilot, layers_of
from swamp_rl.pilots.ppo import FIRST_EPISODE, SENSES, Log, one_thread, scaling_of
from swamp_rl.pilots.settings import Count, Positive, Seed, Settings, Share
from swamp_rl.pilots.tally import Tally

TOLD = 20
"Times that the log hears of a training."


class SACSettings(Settings):
    """How long and how it learns. A training that is broken off begins again."""

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = SENSES
    hidden: Annotated[tuple[Count, ...], Field(min_length=1)] = (64, 64)
    hold: Count = 6
    "Steps of the boat for which a decision is held, in training and after."
    boats: Count = 64
    decisions: Count = 200_000
    "Of all boats together."
    random: Count = 5_000
    "Decisions at the start that are drawn at random."
    updates: Count = 8
    "Gradient steps each time all boats have decided once."
    batch_size: Count = 256
    discount: Share = 0.98
    "For each decision."
    learning_rate: Positive = 1e-3
    seed: Seed = 0


def train_sac(
    boats: Any,
    settings: SACSettings | None = None,
    tick: Callable[[float], None] = lambda done: None,
    log: Log = lambda decisions, values: None,
) -> NetworkPilot:
    """Learn by trying in `boats`, a stable-baselines3 VecEnv as for `swamp_rl.pilots.ppo.train_ppo`.

    What comes back is the policy without its exploration. `tick` hears the share done, `log` now and then
    success and mean return of the episodes since.
    """
    from stable_baselines3.common.callbacks import ConvertCallback
    from stable_baselines3.common.vec_env import VecNormalize

    settings = settings or SACSettings()
    boats.seed(FIRST_EPISODE + settings.seed % FIRST_EPISODE)
    scaled = VecNormalize(boats, norm_reward=False, clip_obs=REACH)
    tally, told = Tally(settings.boats), 0

    def hear(known: dict[str, Any], _: dict[str, Any]) -> bool:
        nonlocal tally, told
        tally.add(scaled.get_original_reward(), known["dones"], known["infos"])
        done = min(1.0, known["self"].num_timesteps / settings.decisions)
        tick(done)
        if done * TOLD >= told + 1 and (values := tally.means()):
            log(known["self"].num_timesteps, values)
            tally, told = Tally(settings.boats), int(done * TOLD)
        return True

    with one_thread():
        learner = _learner(scaled, settings)
        learner.learn(settings.decisions, callback=ConvertCallback(hear))
    return _pilot(learner, scaled, settings)


def _learner(scaled: Any, settings: SACSettings) -> Any:
    import torch
    from stable_baselines3 import SAC

    return SAC(
        "MlpPolicy",
        scaled,
        buffer_size=settings.decisions,
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
