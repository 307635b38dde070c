"""ONNX files of few bytes whose graphs take much memory, or compute something else than a pilot's step."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

onnx = pytest.importorskip("onnx", reason="onnx is not installed")

from onnx import helper, numpy_helper  # noqa: E402

from benchmarks.attack.samples import make_onnx  # noqa: E402
from swamp_rl.errors import UserError  # noqa: E402
from swamp_rl.export.onnx_pilot import LARGEST, LEVERS, MOST_MEMORY, OnnxPilot  # noqa: E402
from swamp_rl.seal import BLANK, KEY, sealed  # noqa: E402

DOUBLE = onnx.TensorProto.DOUBLE


def expanded(graph: Any) -> None:
    """The levers and the greatest of a matrix of more than MOST_MEMORY."""
    side = int(np.sqrt(MOST_MEMORY / 8)) + 100
    last = next(node for node in graph.node if LEVERS in node.output)
    graph.initializer.append(numpy_helper.from_array(np.array([side, side]), "sides"))
    first = [
        helper.make_node("ReduceMax", ["observation"], ["number"], keepdims=0),
        helper.make_node("Expand", ["number", "sides"], ["matrix"]),
        helper.make_node("ReduceMax", ["matrix"], ["greatest"], keepdims=0),
        helper.make_node("Add", [last.input[0], "greatest"], [LEVERS]),
    ]
    graph.node.remove(last)
    graph.node.extend(first)


def with_state(graph: Any, name: str, operator: str, *inputs: str, **options: int) -> None:
    """One more state, of a tenth of LARGEST numbers for each boat."""
    for values, begin in ((graph.input, "state_"), (graph.output, "next_")):
        values.append(helper.make_tensor_value_info(begin + name, DOUBLE, ["boats", LARGEST // 10]))
    graph.node.append(helper.make_node(operator, list(inputs), [f"next_{name}"], **options))


def many(graph: Any) -> None:
    """States of more than LARGEST numbers together."""
    for number in range(11):
        with_state(graph, f"q{number}", "Identity", f"state_q{number}")


def more_boats(graph: Any) -> None:
    """A state that has twice the boats after each step."""
    with_state(graph, "q", "Concat", "state_q", "state_q", axis=0)


def texts(graph: Any) -> None:
    """Levers that are texts."""
    last = next(node for node in graph.node if LEVERS in node.output)
    last.output[0] = "numbers"
    graph.node.append(helper.make_node("Cast", ["numbers"], [LEVERS], to=onnx.TensorProto.STRING))
    levers = next(one for one in graph.output if one.name == LEVERS)
    levers.type.tensor_type.elem_type = onnx.TensorProto.STRING


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (expanded, "cannot be computed"),
        (many, "is not the step of a pilot"),
        (more_boats, "do not keep their shapes"),
        (texts, "is not the step of a pilot"),
    ],
)
def test_a_graph_that_is_no_pilots_step_is_refused(
    change: Callable[[Any], None], message: str, tmp_path: Path
) -> None:
    path = make_onnx(tmp_path)
    model = onnx.load(path)
    change(model.graph)
    next(one for one in model.metadata_props if one.key == KEY).value = BLANK
    path.write_bytes(sealed(model.SerializeToString()))
    with pytest.raises(UserError, match=message):
        pilot = OnnxPilot(path)
        pilot.reset(3)
        pilot.act(np.zeros((3, len(pilot.senses))))
