"""A pilot that drives from its ONNX file, by onnxruntime with one thread."""

import math
from collections.abc import Sequence
from functools import cache
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
from swamp_rl.pilots.arrays import Array, checked_count
from swamp_rl.pilots.description import Made
from swamp_rl.seal import sealed_file

LEVERS = "levers"
MADE = "made"
"Key of the metadata: package, boat, course and step that the pilot was made for, as in `pilot.json`."
LARGEST = 10**6  # numbers of all states of a boat
MOST_MEMORY = 2**30  # bytes that all graphs of a process take
FATAL = 4  # all else that onnxruntime has to say is in its exceptions
TYPES = {"tensor(double)": np.float64, "tensor(float)": np.float32, "tensor(int64)": np.int64}
LEVER_TYPES = ("tensor(double)", "tensor(float)")


class OnnxPilot:
    """The file's graph with its states kept between the steps; none of this project's pilots is used."""

    def __init__(self, path: Path | str) -> None:
        """UserError where the file is no pilot's, is damaged, or onnxruntime is not installed."""
        self._path, self._session = path, _session(path)
        known = self._session.get_modelmeta().custom_metadata_map
        inputs = {given.name: given for given in self._session.get_inputs()}
        self._states = [given for name, given in inputs.items() if name.startswith(STATE)]
        self._outputs = {given.name: given.type for given in self._session.get_outputs()}
        after = {_next(state.name): state.type for state in self._states}
        whole = {"kind", "senses"} <= set(known) and "observation" in inputs
        whole = whole and self._outputs.get(LEVERS) in LEVER_TYPES and after.items() <= self._outputs.items()
        if not whole or not _can_begin(self._states):
            raise UserError(f"{path}: is not the step of a pilot; name a file written by swamp-rl export")
        self.kind: str = known["kind"]
        try:
            senses = parsed_json(known["senses"])
        except ValueError:
            senses = None
        if not isinstance(senses, list) or not all(isinstance(name, str) for name in senses):
            raise UserError(f"{path}: does not name its observations; export the pilot again")
        self.senses = tuple(senses)
        self.made = _made(path, known.get(MADE))
        "None in a file of an earlier version, or of a pilot that does not tell."
        refuse_unnamed(self.senses, f"{path}: the pilot observes", "onnx:FILE")
        self.wants_first = FIRST_LEVERS in inputs
        "Whether the levers of whoever drives first are to be given."
        self.reset(0)

    def reset(self, n: int) -> None:
        """Begin with n boats, all states zero."""
        n = checked_count(n)
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
        levers, kept = out[LEVERS], {name: out[_next(name)] for name in self._kept}
        if levers.shape != (len(observation), 2) or not np.isfinite(levers).all():
            raise UserError(f"{self._path}: does not compute two levers of each boat; export the pilot again")
        if any(kept[name].shape != state.shape for name, state in self._kept.items()):
            raise UserError(f"{self._path}: its states do not keep their shapes; export the pilot again")
        self._kept = kept
        return levers


def _made(path: Path | str, text: str | None) -> Made | None:
    try:
        return None if text is None else Made.model_validate_json(text)
    except ValueError as error:
        raise UserError(f"{path}: does not name its boat and step; export the pilot again") from error


def _next(state: str) -> str:
    """The name of the output that is the state's next value."""
    return NEXT + state.removeprefix(STATE)


def _can_begin(states: Sequence[Any]) -> bool:
    """Whether zeros of the states' types and shapes can be made, but for the number of boats."""
    sizes = [state.shape[1:] for state in states]
    if not all(isinstance(n, int) for size in sizes for n in size):
        return False
    return all(state.type in TYPES for state in states) and sum(map(math.prod, sizes)) <= LARGEST


@cache
def _memory_bounded() -> None:
    """Have onnxruntime take no more than MOST_MEMORY in this process: a graph of 1 kB can ask for any."""
    from onnxruntime import (
        OrtAllocatorType,
        OrtArenaCfg,
        OrtMemoryInfo,
        OrtMemType,
        create_and_register_allocator,
    )

    memory = OrtMemoryInfo("Cpu", OrtAllocatorType.ORT_ARENA_ALLOCATOR, 0, OrtMemType.DEFAULT)
    create_and_register_allocator(memory, OrtArenaCfg({"max_mem": MOST_MEMORY}))


def _session(path: Path | str) -> Any:
    try:
        import onnxruntime
    except ImportError as error:
        raise missing("ONNX pilots need onnxruntime", "onnx") from error
    options = onnxruntime.SessionOptions()
    options.log_severity_level = FATAL
    options.add_session_config_entry("session.use_env_allocators", "1")
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    content = sealed_file(path, "export the pilot again")
    _memory_bounded()
    try:
        return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's own errors have no common base
        first = str(error).splitlines()[0]
        raise UserError(f"{path}: is not an ONNX model ({first}); export the pilot again") from error
