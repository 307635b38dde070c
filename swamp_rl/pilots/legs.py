"""Reinforcement learning in legs, with a checkpoint after each.

A leg resets all boats and seeds its random numbers from the training's seed and the leg's number alone. A
resumed training therefore needs no state of the boats and ends with the same bits as an uninterrupted one.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.errors import UserError
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.checkpoint import load_checkpoint, module_state, readable, save_checkpoint
from swamp_rl.pilots.demonstrations import MOTION, NEXT_GATE, POSE
from swamp_rl.pilots.divergence import refuse_diverged
from swamp_rl.pilots.settings import Count, Hold, Layers, Many, Seed, Settings, Share
from swamp_rl.pilots.tally import Tally

FIRST_EPISODE = 2**31
"Seeds of training episodes start here; those of evaluation are smaller."


class ReinforcementSettings(Settings):
    """Settings common to all algorithms of reinforcement learning."""

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = (*POSE, *MOTION, *NEXT_GATE)
    hidden: Layers = (64, 64)
    hold: Hold = 6
    "Environment steps for which an action is held, in training and in evaluation."
    boats: Many
    decisions: Count
    "Total number of actions, over all boats."
    discount: Share = 0.98
    "Discount factor per action."
    leg: Count
    """Length of a leg, between two checkpoints. Each leg resets all boats, so it must be longer than an
    episode."""
    seed: Seed = 0


@dataclass
class Progress:
    """State of a training. curve: the means of each leg with the `step` reached, in actions."""

    settings: dict[str, Any]
    legs: int = 0
    decisions: int = 0
    seconds: float = 0.0
    curve: list[dict[str, Any]] = field(default_factory=list)


@dataclass(frozen=True)
class Legs:
    """The functions of a training in legs. learner: of stable-baselines3, with `num_timesteps`."""

    learner: Any
    drive: Callable[[int], dict[str, float]]
    "Run the leg of that number; return its means, empty where no episode ended."
    tensors: Callable[[], Mapping[str, Array]]
    "Return the state that the next leg needs."
    restore: Callable[[dict[str, Array]], None]
    "Restore that state; KeyError, ValueError or RuntimeError where it does not fit."


def train_in_legs(
    legs: Legs, settings: dict[str, Any], decisions: int, log: Log, checkpoint: Path | None
) -> None:
    """Train leg by leg from the last checkpoint. What was logged before it is logged again.

    UserError for a damaged checkpoint or one of other settings.
    """
    progress = Progress(settings)
    if checkpoint is not None:
        _load(checkpoint, progress, legs)
    for row in progress.curve:
        log(row["step"], {name: value for name, value in row.items() if name != "step"})
    while legs.learner.num_timesteps < decisions:
        began = time.perf_counter()
        values = legs.drive(progress.legs)
        progress.legs += 1
        progress.decisions = legs.learner.num_timesteps
        progress.seconds += time.perf_counter() - began
        if values:
            values["seconds"] = round(progress.seconds, 2)
            progress.curve.append({"step": progress.decisions, **values})
        if checkpoint is not None:
            save_checkpoint(checkpoint, vars(progress), legs.tensors())
        if values:
            log(progress.decisions, values)


def drive_leg(
    learner: Any, settings: ReinforcementSettings, leg: int, decisions: int, tick: Tick
) -> dict[str, float]:
    """Train for `decisions` actions of all boats; return success, return and number of the episodes ended.

    Episodes and random numbers depend on the seed and the number of the leg alone. tick: called with the
    share done. SettingsError where the training diverges.
    """
    from stable_baselines3.common.callbacks import ConvertCallback
    from stable_baselines3.common.logger import Logger

    _begin_leg(learner, settings.seed, leg)
    tally = Tally(settings.boats)

    def record(known: dict[str, Any], _: dict[str, Any]) -> bool:
        tally.add(learner.env.get_original_reward(), known["dones"], known["infos"])
        tick(min(1.0, learner.num_timesteps / settings.decisions))
        return True

    learner.set_logger(Logger(None, []))  # its own makes a folder in the temporary directory
    try:
        learner.learn(decisions, ConvertCallback(record), reset_num_timesteps=False)
    except (UserError, ValueError):  # boats and distributions of torch refuse what is no number
        _refuse_diverged(learner)
        raise
    _refuse_diverged(learner)
    return tally.means()


def _refuse_diverged(learner: Any) -> None:
    refuse_diverged(
        module_state("policy", learner.policy).values(),
        "lower learning_rate, or the weights of the reward",
    )


def _begin_leg(learner: Any, seed: int, leg: int) -> None:
    """Seed random numbers and episodes from the training's seed and the number of the leg alone."""
    from stable_baselines3.common.utils import set_random_seed

    numbers, episodes = np.random.SeedSequence([seed, leg]).generate_state(2).tolist()
    set_random_seed(numbers)
    learner.action_space.seed(numbers)
    learner.env.seed(FIRST_EPISODE + episodes % FIRST_EPISODE)
    learner._last_obs = None  # `learn` then resets the boats


def scaling_of(scaled: Any) -> dict[str, Array]:
    """Return `mean` and `scale` (d,) of the observations from a VecNormalize."""
    return {"mean": scaled.obs_rms.mean, "scale": np.sqrt(scaled.obs_rms.var + scaled.epsilon)}


def running_statistics(owner: str, statistics: Any) -> dict[str, Array]:
    """Return a RunningMeanStd, by names that begin with `owner`."""
    arrays = {f"{owner}.mean": np.asarray(statistics.mean), f"{owner}.var": np.asarray(statistics.var)}
    return arrays | {f"{owner}.count": np.asarray(statistics.count, dtype=np.float64)}


def load_running_statistics(owner: str, statistics: Any, tensors: Mapping[str, Array]) -> None:
    """Load what `running_statistics` returned into a RunningMeanStd."""
    statistics.mean, statistics.var = tensors[f"{owner}.mean"], tensors[f"{owner}.var"]
    statistics.count = float(tensors[f"{owner}.count"])


def _load(path: Path, progress: Progress, legs: Legs) -> None:
    """Load the checkpoint `path`, if there is one, into `progress` and the learner."""
    kept = load_checkpoint(path)
    if kept is None:
        return
    description, tensors = kept
    with readable(path):
        made_with = description["settings"]
        if made_with == progress.settings:
            legs.restore(tensors)
            progress.legs, progress.seconds, progress.curve = (
                description["legs"],
                description["seconds"],
                description["curve"],
            )
            progress.decisions = legs.learner.num_timesteps = description["decisions"]
            return
        other = [key for key in progress.settings if made_with.get(key) != progress.settings[key]]
    raise UserError(
        f"{path}: was made with other settings ({', '.join(other) or 'of another version'}); "
        "train with those, or remove it to train again"
    )
