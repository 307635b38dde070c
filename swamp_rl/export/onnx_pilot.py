"""A pilot that drives from its ONNX file, by onnxruntime with one thread."""

import math
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

LEVERS = "levers"
LARGEST = 10**6  # numbers of a state
FATAL = 4  # all else that onnxruntime has to say is in its exceptions
TYPES = {"tensor(double)": np.float64, "tensor(float)": np.float32, "tensor(int64)": np.int64}


class OnnxPilot:
    """The file's graph with its states kept between the steps; none of this project's pilots is used."""

    def __init__(self, path: Path | str) -> None:
        """UserError where the file is no pilot's, is damaged, or onnxruntime is not installed."""
        self._path, self._session = path, _session(path)
        known = self._session.get_modelmeta().custom_metadata_map
        inputs = {given.name: given for given in self._session.get_inputs()}
        self._states = [given for name, given in inputs.items() if name.startswith(STATE)]
        self._outputs = [given.name for given in self._session.get_outputs()]
        after = {LEVERS, *(_next(state.name) for state in self._states)}
        whole = {"kind", "senses"} <= set(known) and "observation" in inputs and after <= set(self._outputs)
        if not whole or not all(map(_can_begin, self._states)):
            raise UserError(f"{path}: is not the step of a pilot; name a file written by swamp-rl export")
        self.kind: str = known["kind"]
        try:
            senses = parsed_json(known["senses"])
        except ValueError:
            senses = None
        if not isinstance(senses, list) or not all(isinstance(name, str) for name in senses):
            raise UserError(f"{path}: does not name its observations; export the pilot again")
        self.senses = tuple(senses)
        refuse_unnamed(self.senses, f"{path}: the pilot observes")
        self.wants_first = FIRST_LEVERS in inputs
        "Whether the levers of whoever drives first are to be given."
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
        self._kept = {name: out[_next(name)] for name in self._kept}
        levers = out[LEVERS]
        if np.shape(levers) != (len(observation), 2) or not np.isfinite(levers).all():
            raise UserError(f"{self._path}: does not compute two levers of each boat; export the pilot again")
        return levers


def _next(state: str) -> str:
    """The name of the output that is the state's next value."""
    return NEXT + state.removeprefix(STATE)


def _can_begin(state: Any) -> bool:
    """Whether zeros of the state's type and shape can be made, but for the number of boats."""
    sizes = state.shape[1:]
    return state.type in TYPES and all(isinstance(n, int) for n in sizes) and math.prod(sizes) <= LARGEST


def _session(path: Path | str) -> Any:
    try:
        import onnxruntime
    except ImportError as error:
        raise missing("ONNX pilots need onnxruntime", "onnx") from error
    options = onnxruntime.SessionOptions()
    options.log_severity_level = FATAL
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    content = sealed_file(path, "export the pilot again")
    try:
        return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's own errors have no common base
        first = str(error).splitlines()[0]
        raise UserError(f"{path}: is not an ONNX model ({first}); export the pilot again") from error
