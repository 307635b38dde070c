"""Reinforcement learning in legs, with a checkpoint after each: a safetensors file with JSON in its header.

A leg resets all boats and seeds its random numbers from the training's seed and the leg's number alone. A
resumed training therefore needs no state of the boats and ends with the same bits as an uninterrupted one.
"""

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from swamp_rl.errors import UserError
from swamp_rl.files import write_beside
from swamp_rl.json_text import parsed_json
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.demonstrations import MOTION, NEXT_GATE, POSE
from swamp_rl.pilots.settings import Count, Layers, Many, Seed, Settings, Share
from swamp_rl.pilots.tally import Tally
from swamp_rl.seal import BLANK, KEY, sealed, sealed_file
from swamp_rl.tensors_file import tensors_in

FORMAT = "1"
FIRST_EPISODE = 2**31
"Seeds of training episodes start here; those of evaluation are smaller."


class ReinforcementSettings(Settings):
    """Settings common to all algorithms of reinforcement learning."""

    senses: Annotated[tuple[str, ...], Field(min_length=1)] = (*POSE, *MOTION, *NEXT_GATE)
    hidden: Layers = (64, 64)
    hold: Many = 6
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
            _save(checkpoint, progress, legs.tensors())
        if values:
            log(progress.decisions, values)


def drive_leg(
    learner: Any, settings: ReinforcementSettings, leg: int, decisions: int, tick: Tick
) -> dict[str, float]:
    """Train for `decisions` actions of all boats; return success, return and number of the episodes ended.

    Episodes and random numbers depend on the seed and the number of the leg alone. tick: called with the
    share done.
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
    learner.learn(decisions, ConvertCallback(record), reset_num_timesteps=False)
    return tally.means()


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


def optimiser_state(owner: str, optimiser: Any) -> dict[str, Array]:
    """Return the state of a torch optimiser, by names that begin with `owner`."""
    return {
        f"{owner}.{i}.{name}": value.numpy()
        for i, known in optimiser.state_dict()["state"].items()
        for name, value in known.items()
    }


def load_optimiser_state(owner: str, optimiser: Any, tensors: Mapping[str, Array]) -> None:
    """Load the state that `optimiser_state` returned into a torch optimiser."""
    import torch

    state: dict[int, dict[str, Any]] = {}
    for name, value in tensors.items():
        if name.startswith(f"{owner}."):
            i, moment = name.removeprefix(f"{owner}.").split(".")
            state.setdefault(int(i), {})[moment] = torch.from_numpy(value)
    optimiser.load_state_dict({**optimiser.state_dict(), "state": state})


def policy_state(policy: Any) -> dict[str, Array]:
    """Return the weights of a policy of stable-baselines3, by names that begin with `policy`."""
    return {f"policy.{name}": value.numpy() for name, value in policy.state_dict().items()}


def load_policy_state(policy: Any, tensors: Mapping[str, Array]) -> None:
    """Load the weights that `policy_state` returned into a policy."""
    import torch

    policy.load_state_dict(
        {name: torch.from_numpy(tensors[f"policy.{name}"]) for name in policy.state_dict()}
    )


def running_statistics(owner: str, statistics: Any) -> dict[str, Array]:
    """Return a RunningMeanStd, by names that begin with `owner`."""
    arrays = {f"{owner}.mean": np.asarray(statistics.mean), f"{owner}.var": np.asarray(statistics.var)}
    return arrays | {f"{owner}.count": np.asarray(statistics.count, dtype=np.float64)}


def load_running_statistics(owner: str, statistics: Any, tensors: Mapping[str, Array]) -> None:
    """Load what `running_statistics` returned into a RunningMeanStd."""
    statistics.mean, statistics.var = tensors[f"{owner}.mean"], tensors[f"{owner}.var"]
    statistics.count = float(tensors[f"{owner}.count"])


def _save(path: Path, progress: Progress, tensors: Mapping[str, Array]) -> None:
    """Replace the checkpoint `path` atomically; UserError where it cannot be written."""
    from safetensors.numpy import save

    header = {
        "format": FORMAT,
        "settings": json.dumps(progress.settings),
        "legs": str(progress.legs),
        "seconds": repr(progress.seconds),
        "curve": json.dumps(progress.curve),
        "decisions": str(progress.decisions),
        KEY: BLANK,
    }
    with write_beside(path) as part:
        whole = {name: np.array(value, order="C") for name, value in tensors.items()}
        part.write_bytes(sealed(save(whole, metadata=header)))


def _load(path: Path, progress: Progress, legs: Legs) -> None:
    """Load the checkpoint `path`, if there is one, into `progress` and the learner."""
    if not path.exists():
        return
    header, tensors = _read(path)
    try:
        made_with = parsed_json(header["settings"])
        if header["format"] == FORMAT and made_with == progress.settings:
            legs.restore(tensors)
            progress.decisions = legs.learner.num_timesteps = int(header["decisions"])
            progress.legs, progress.seconds = int(header["legs"]), float(header["seconds"])
            progress.curve = parsed_json(header["curve"])
            return
    except (KeyError, ValueError, RuntimeError) as error:
        raise UserError(f"{path}: is no complete checkpoint ({error}); remove it to train again") from error
    other = [key for key in progress.settings if made_with.get(key) != progress.settings[key]]
    raise UserError(
        f"{path}: was made with other settings ({', '.join(other) or 'of another version'}); "
        "train with those, or remove it to train again"
    )


def _read(path: Path) -> tuple[dict[str, str], dict[str, Array]]:
    from safetensors.numpy import load

    data = sealed_file(path, "remove it to train again")
    try:
        return tensors_in(data, load)
    except ValueError as error:
        raise UserError(f"{path}: is damaged ({error}); remove it to train again") from error
