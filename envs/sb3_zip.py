"""A model of stable-baselines3 as a pilot, read by the library's own loader, which unpickles it."""

import json
import zipfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from gymnasium import spaces
from swamp_rl.envs.observation import OBSERVATION, observation_bounds, observed
from swamp_rl.envs.spaces import joypad_space

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.ordinary import contents
from swamp_rl.own_code import refuse_unnamed
from swamp_rl.pilots.arrays import Array, levers_of
from swamp_rl.pilots.held import Held
from swamp_rl.pilots.own import is_known_model, model_file
from swamp_rl.pilots.settings import Hold, Settings

MARKS = {"clip_range": "PPO", "target_entropy": "SAC", "policy_delay": "TD3", "gae_lambda": "A2C"}
"What only the data of one algorithm hold (A2C's are among PPO's), in the order in which to look."
MODEL = "model.zip"


class ZipSettings(Settings):
    """The zip and its SHA-256 if it must be that very one.

    senses: the names that it observes, in order; hold: steps for which an action is held.
    """

    file: str
    sha256: str | None = None
    senses: tuple[str, ...] = OBSERVATION
    hold: Hold = 1


class SB3Zip:
    """The policy without its exploration, a decision every `hold` steps.

    Its actions are levers, or from -1 to 1 in both over their whole range as in
    `swamp_rl.envs.sb3.GatesVecEnv`.
    """

    Settings = ZipSettings
    from_runs: ClassVar[bool] = False

    def __init__(self, content: bytes, settings: ZipSettings, file: str) -> None:
        """file: what messages name. UserError where the content is no model that can steer."""
        self._content, self.senses, self._held = content, settings.senses, Held(settings.hold)
        self._model = _loaded(content, file)
        _refuse_observation(self._model.observation_space, self.senses, file)
        self._whole = _is_whole(self._model.action_space, file)

    @classmethod
    def train(cls, training: Any) -> "SB3Zip":
        """The model of `training.settings.file`."""
        return cls.read(training.settings)

    @classmethod
    def read(cls, settings: ZipSettings) -> "SB3Zip":
        """The model of `settings.file`, which the user has named and so trusts."""
        content = model_file(settings.file, settings.sha256)
        return cls(content, settings, settings.file)

    def save(self, folder: Path) -> None:
        """The zip as it was read."""
        (folder / MODEL).write_bytes(self._content)

    @classmethod
    def load(cls, folder: Path, settings: Any) -> "SB3Zip":
        """The stored copy; UserError where it is not one that the user has named in this process, and where
        a term that it observes is not."""
        refuse_unnamed(settings.senses, "the pilot observes")
        content = contents(folder / MODEL)
        if not is_known_model(content):
            raise UserError(
                "the pilot is a model of stable-baselines3, which can run code; if it is yours, name its "
                f"zip: sb3:{Path(settings.file).name}"
            )
        return cls(content, settings, str(folder / MODEL))

    def reset(self, n: int) -> None:
        """Begin with n boats, which decide at their next step."""
        self._held.begin(n)

    def reset_boats(self, mask: Array) -> None:
        """Let the boats of `mask` (n,) decide at their next step."""
        self._held.forget(mask)

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d)."""
        return self._held.step(lambda due: self._decide(observation[due]))

    def _decide(self, observation: Array) -> Array:
        actions, _ = self._model.predict(observation.astype(np.float32), deterministic=True)
        return levers_of(actions) if self._whole else np.asarray(actions)


def _refuse_observation(space: spaces.Space[Any], senses: tuple[str, ...], file: str) -> None:
    """UserError unless a model's observation is `senses`, unscaled; bounds of a course may be another's."""
    if space.shape != (len(senses),):
        raise UserError(
            f"sb3:{file}: the model observes the shape {space.shape}, not ({len(senses)},); name what it "
            "observes as the senses of a pilot of kind sb3 in an experiment (docs/own_pilot.md)"
        )
    wanted = observation_bounds(observed(senses))
    found = _bounds(space)
    other = ~(np.isnan(wanted) | (wanted == found)).all(axis=0)
    if other.any():
        i = int(np.argmax(other))
        raise UserError(
            f"sb3:{file}: the model observes {senses[i]} from {found[0, i]:g} to {found[1, i]:g}, which "
            "are not the environment's bounds; train without a wrapper that scales the observation, or name "
            "what it observes as senses (docs/own_pilot.md)"
        )


def _is_whole(space: spaces.Space[Any], file: str) -> bool:
    """Whether actions are from -1 to 1 over the whole range of both levers; UserError where they are neither
    this nor levers."""
    levers, found = _bounds(joypad_space()), _bounds(space)
    for wanted, whole in ((levers, False), (np.array([[-1.0, -1.0], [1.0, 1.0]]), True)):
        if np.array_equal(found, wanted):
            return whole
    raise UserError(
        f"sb3:{file}: the model's actions are {clipped(' '.join(str(space).split()), 200)}; those of the "
        "environment, Box([0, -1], [1, 1]), or Box(-1, 1, (2,)) are needed: train without a wrapper that "
        "changes them otherwise"
    )


def _bounds(space: spaces.Space[Any]) -> Array:
    """Least and greatest values (2, ...) of a box; NaN of another space."""
    if isinstance(space, spaces.Box):
        return np.array([space.low, space.high])
    return np.full((2, *(space.shape or ())), np.nan)


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
