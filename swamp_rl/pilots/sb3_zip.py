"""A model of stable-baselines3 as a pilot, read by the library's own loader, which unpickles it."""

import json
import zipfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.ordinary import contents
from swamp_rl.pilots.arrays import Array, levers_of
from swamp_rl.pilots.demonstrations import MOTION, NEXT_GATE, POSE
from swamp_rl.pilots.own import is_known_model, model_file
from swamp_rl.pilots.settings import Settings

MARKS = {"clip_range": "PPO", "target_entropy": "SAC", "policy_delay": "TD3", "gae_lambda": "A2C"}
"What only the data of one algorithm hold (A2C's are among PPO's), in the order in which to look."
MODEL = "model.zip"
SENSES = (*POSE, *MOTION, *NEXT_GATE)
"What `swamp/Gates-v1` observes where nothing else is asked of it."


class ZipSettings(Settings):
    """The zip, its SHA-256 if it must be that very one, and the names that it observes, in order."""

    file: str
    sha256: str | None = None
    senses: tuple[str, ...] = SENSES


class SB3Zip:
    """The policy without its exploration; it remembers nothing.

    Actions of a space from -1 to 1 in both are those of `swamp_rl.envs.sb3.GatesVecEnv`, others are levers.
    """

    Settings = ZipSettings
    from_runs: ClassVar[bool] = False

    def __init__(self, content: bytes, senses: tuple[str, ...], file: str) -> None:
        """file: what messages name. UserError where the content is no model that can steer."""
        self._content, self.senses = content, senses
        self._model = _loaded(content, file)
        seen, action = self._model.observation_space.shape, self._model.action_space
        if seen != (len(senses),):
            raise UserError(
                f"sb3:{file}: the model observes the shape {seen}, not ({len(senses)},); name what it "
                "observes as the senses of a pilot of kind sb3 in an experiment (docs/own_pilot.md)"
            )
        if action.shape != (2,):
            raise UserError(f"sb3:{file}: the model's actions have the shape {action.shape}, (2,) is needed")
        self._whole = float(action.low[0]) < 0.0

    @classmethod
    def train(cls, training: Any) -> "SB3Zip":
        """The model of `training.settings.file`."""
        return cls.read(training.settings)

    @classmethod
    def read(cls, settings: ZipSettings) -> "SB3Zip":
        """The model of `settings.file`, which the user has named and so trusts."""
        content = model_file(settings.file, settings.sha256)
        return cls(content, settings.senses, settings.file)

    def save(self, folder: Path) -> None:
        """The zip as it was read."""
        (folder / MODEL).write_bytes(self._content)

    @classmethod
    def load(cls, folder: Path, settings: Any) -> "SB3Zip":
        """The stored copy; UserError where it is not one that the user has named in this process."""
        content = contents(folder / MODEL)
        if not is_known_model(content):
            raise UserError(
                "the pilot is a model of stable-baselines3, which can run code; if it is yours, name its "
                f"zip: sb3:{Path(settings.file).name}"
            )
        return cls(content, settings.senses, str(folder / MODEL))

    def reset(self, n: int) -> None:
        """Nothing is remembered."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d)."""
        actions, _ = self._model.predict(observation.astype(np.float32), deterministic=True)
        return levers_of(actions) if self._whole else np.asarray(actions)


def _loaded(content: bytes, file: str) -> Any:
    import stable_baselines3

    named = f"sb3:{clipped(file, 200)}"
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            data = json.loads(archive.read("data"))
    except (zipfile.BadZipFile, KeyError, ValueError, RecursionError) as error:
        raise UserError(
            f"{named}: is not a model of stable-baselines3 ({error}); name the zip it saved"
        ) from error
    names = [MARKS[mark] for mark in MARKS if isinstance(data, Mapping) and mark in data]
    if not names:
        raise UserError(f"{named}: is a model of none of {', '.join(MARKS.values())}; train one of these")
    try:
        return getattr(stable_baselines3, names[0]).load(BytesIO(content), device="cpu")
    except Exception as error:  # whatever the pickles of a damaged or foreign file raise
        message = f"{type(error).__name__}: {error}".splitlines()[0]
        raise UserError(
            f"{named}: could not be read by this stable-baselines3 ({message}); save it again"
        ) from error
