"""PPO (Schulman and others 2017) by stable-baselines3 on a given batch of boats."""

import math
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

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
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.ppo_warm import freeze_policy, warm_start
from swamp_rl.pilots.settings import Count, Many, NotNegative, Positive


class PPOSettings(ReinforcementSettings):
    """Settings of PPO.

    An action is held for `hold` steps, since levers that alternate ten times a second hardly move the boat.
    Exploration is state-dependent (gSDE, Raffin and others 2021), resampled every `keep` actions.
    """

    memory: Annotated[int, Field(ge=0, le=20)] = 0
    "Number of earlier observations and actions that are part of the observation."
    caution: NotNegative = 0.0
    """Penalty for touching a buoy or leaving the bounds, in addition to the environment's. Without it the
    policy trades a higher risk of failure for a shorter time."""
    boats: Many = 128
    decisions: Count = 1_200_000
    horizon: Many = 64
    "Actions of each boat between two updates."
    batch_size: Annotated[int, Field(ge=2, le=100_000)] = 1024
    "At least 2, as advantages are divided by their standard deviation over a batch."
    epochs: Many = 8
    learning_rate: Positive = 7e-4
    "Initial value, decreased linearly to zero; with a constant rate the success falls again."
    leg: Count = 8
    "Updates in a leg, between two checkpoints."
    start: str | None = None
    "Name of the cloning pilot of the experiment whose weights initialise the policy; same `hidden`."
    settle: Annotated[int, Field(ge=0, le=10**6)] = 2
    "Initial legs in which a policy initialised by a clone is frozen and only the value function is fitted."
    keep: Count = 2
    exploration: Positive = 1.5
    """Initial standard deviation of the exploration noise's weights. It is large, so that the levers cover
    their range: with 0.6 some seeds explored too little to find the gates."""

    @model_validator(mode="after")
    def _more_than_one_action(self) -> Self:
        if self.horizon * self.boats < 2:
            raise ValueError("horizon: 1 action of 1 boat is no batch to learn from; raise horizon or boats")
        return self


def train_ppo(
    boats: Any,
    settings: PPOSettings | None = None,
    tick: Tick = lambda done: None,
    log: Log = lambda decisions, values: None,
    checkpoint: Path | None = None,
    start: Pilot | None = None,
) -> NetworkPilot:
    """Train PPO in `boats`, a stable-baselines3 VecEnv of `settings.boats` that observes `settings.senses`.

    Its actions in [-1, 1] must map to the whole range of each lever and be held for `settings.hold` steps.
    Returns the mean of the policy, without exploration. `tick` is called with the share done, `log` with
    success, return, episodes and seconds after each leg in which episodes ended. With a file `checkpoint`, a
    killed training resumes from its last leg and ends with the same bits as an uninterrupted one. start: the
    pilot that `settings.start` names. UserError for a damaged checkpoint or one of other settings, and for a
    `start` that does not fit.
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
        scaled.training = start is None  # keep a clone's own scaling
        legs = _legs(learner, scaled, settings, tick, warm=start is not None)
        train_in_legs(legs, settings.model_dump(mode="json"), settings.decisions, log, checkpoint)
    learned = {**scaling_of(scaled), **mean_layers(learner.policy)}
    return NetworkPilot("ppo", settings.senses, learned, settings.hold, settings.memory)


def mean_layers(policy: Any) -> dict[str, Array]:
    """Return the mean of a policy with actions in [-1, 1] as layers of a NetworkPilot (outputs: levers)."""
    layers = layers_of([*policy.mlp_extractor.policy_net, policy.action_net])
    last = len(layers) // 2 - 1
    reach = 0.5 * (HIGHEST - LOWEST)
    layers[f"weight_{last}"] *= reach
    layers[f"bias_{last}"] = 0.5 * (HIGHEST + LOWEST) + reach * layers[f"bias_{last}"]
    return layers


def _legs(learner: Any, scaled: Any, settings: PPOSettings, tick: Tick, warm: bool) -> Legs:
    """Return the training's functions; its state is weights, optimiser state and running statistics."""

    def drive(leg: int) -> dict[str, float]:
        freeze_policy(learner, frozen=warm and leg < settings.settle)
        update = settings.boats * settings.horizon
        left = -(-(settings.decisions - learner.num_timesteps) // update)
        return drive_leg(learner, settings, leg, min(settings.leg, left) * update, tick)

    def tensors() -> dict[str, Array]:
        kept = module_state("policy", learner.policy) | optimiser_state("optimiser", learner.policy.optimizer)
        return (
            kept
            | running_statistics("observation", scaled.obs_rms)
            | running_statistics("return", scaled.ret_rms)
        )

    def restore(kept: dict[str, Array]) -> None:
        load_module_state("policy", learner.policy, kept)
        load_optimiser_state("optimiser", learner.policy.optimizer, kept)
        load_running_statistics("observation", scaled.obs_rms, kept)
        load_running_statistics("return", scaled.ret_rms, kept)

    return Legs(learner, drive, tensors, restore)


def _learner(scaled: Any, settings: PPOSettings) -> Any:
    """Return stable-baselines3's PPO with a learning rate that decreases linearly over the whole training."""
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
