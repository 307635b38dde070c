"""A pilot that drives from its ONNX file, by onnxruntime with one thread."""

from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.export.graph import NEXT, STATE
from swamp_rl.export.steps import FIRST_LEVERS
from swamp_rl.extras import missing
from swamp_rl.json_text import parsed_json
from swamp_rl.own_code import refuse_unnamed
from swamp_rl.pilots.arrays import Array
from swamp_rl.seal import sealed_file

TYPES = {"tensor(double)": np.float64, "tensor(float)": np.float32, "tensor(int64)": np.int64}


class OnnxPilot:
    """The file's graph with its states kept between the steps; none of this project's pilots is used."""

    def __init__(self, path: Path | str) -> None:
        """UserError where the file is no pilot's, is damaged, or onnxruntime is not installed."""
        self._path, self._session = path, _session(path)
        known = self._session.get_modelmeta().custom_metadata_map
        inputs = {given.name: given for given in self._session.get_inputs()}
        if not {"kind", "senses"} <= set(known) or "observation" not in inputs:
            raise UserError(f"{path}: is not the step of a pilot; name a file written by swamp-rl export")
        self.kind: str = known["kind"]
        try:
            self.senses = tuple(parsed_json(known["senses"]))
        except (TypeError, ValueError) as error:
            raise UserError(f"{path}: does not name its observations; export the pilot again") from error
        refuse_unnamed(self.senses, f"{path}: the pilot observes")
        self.wants_first = FIRST_LEVERS in inputs
        "Whether the levers of whoever drives first are to be given."
        self._states = [given for name, given in inputs.items() if name.startswith(STATE)]
        self._outputs = [given.name for given in self._session.get_outputs()]
        self.reset(0)

    def reset(self, n: int) -> None:
        """Begin with n boats, all states zero."""
        self._kept = {
            given.name: np.zeros((n, *given.shape[1:]), dtype=TYPES[given.type]) for given in self._states
        }

    def reset_boats(self, mask: Array) -> None:
        """Zero the states of the boats of `mask` (n,)."""
        for state in self._kept.values():
            state[np.asarray(mask, dtype=bool)] = 0

    def keep(self, boats: Array) -> None:
        """Go on with the boats of the places `boats` (m,) alone."""
        self._kept = {name: state[boats] for name, state in self._kept.items()}

    def act(self, observation: Array, first_levers: Array | None = None) -> Array:
        """Levers (n, 2) from the observation (n, d) and, where the file wants them, the first's levers."""
        given = {"observation": np.asarray(observation, dtype=np.float64), **self._kept}
        if self.wants_first:
            given[FIRST_LEVERS] = np.asarray(first_levers, dtype=np.float64)
        try:
            out = dict(zip(self._outputs, self._session.run(None, given), strict=True))
        except Exception as error:  # onnxruntime's own errors have no common base
            first = clipped(str(error).splitlines()[0], 300)
            raise UserError(f"{self._path}: cannot be computed ({first}); export the pilot again") from error
        self._kept = {name: out[NEXT + name.removeprefix(STATE)] for name in self._kept}
        return out["levers"]


def _session(path: Path | str) -> Any:
    try:
        import onnxruntime
    except ImportError as error:
        raise missing("ONNX pilots need onnxruntime", "onnx") from error
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    content = sealed_file(path, "export the pilot again")
    try:
        return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's own errors have no common base
        first = str(error).splitlines()[0]
        raise UserError(f"{path}: is not an ONNX model ({first}); export the pilot again") from error
