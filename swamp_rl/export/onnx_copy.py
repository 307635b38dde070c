"""An exported pilot, `pilot.onnx`, as one that is evaluated and stored as the others are."""

from pathlib import Path
from typing import Any, ClassVar

from swamp_rl.errors import UserError
from swamp_rl.export.onnx_pilot import OnnxPilot
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.own import model_file
from swamp_rl.pilots.settings import Settings

MODEL = "pilot.onnx"


class CopySettings(Settings):
    """The file, and its SHA-256 if it must be that very one."""

    file: str
    sha256: str | None = None


class OnnxCopy:
    """`OnnxPilot` with a copy of its file."""

    Settings = CopySettings
    from_runs: ClassVar[bool] = False

    def __init__(self, path: Path | str) -> None:
        self._pilot, self._content = OnnxPilot(path), Path(path).read_bytes()
        if self._pilot.wants_first:
            raise UserError(f"{path}: needs another pilot to drive first; export one without a takeover")
        self.senses = self._pilot.senses

    @classmethod
    def train(cls, training: Any) -> "OnnxCopy":
        """The pilot of `training.settings.file`."""
        return cls.read(training.settings)

    @classmethod
    def read(cls, settings: CopySettings) -> "OnnxCopy":
        """The pilot of `settings.file`."""
        model_file(settings.file, settings.sha256)
        return cls(settings.file)

    def save(self, folder: Path) -> None:
        """The file as it was read."""
        (folder / MODEL).write_bytes(self._content)

    @classmethod
    def load(cls, folder: Path, settings: Any) -> "OnnxCopy":
        """The stored copy."""
        return cls(folder / MODEL)

    def reset(self, n: int) -> None:
        """Begin with n boats."""
        self._pilot.reset(n)

    def reset_boats(self, mask: Array) -> None:
        """Forget what the boats of `mask` (n,) remember."""
        self._pilot.reset_boats(mask)

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d)."""
        return self._pilot.act(observation)
