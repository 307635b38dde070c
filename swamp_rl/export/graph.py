"""An ONNX graph that grows operation by operation, each value known by its name."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array

OPSET = 17
IR_VERSION = 8
"Of 2022: what runs on a small computer is seldom of this year."
STATE, NEXT = "state_", "next_"


@dataclass
class Graph:
    """What has been put together so far; a value's name stands for it, and n is the number of boats."""

    nodes: list[Any] = field(default_factory=list)
    constants: list[Any] = field(default_factory=list)
    inputs: list[Any] = field(default_factory=list)
    outputs: list[Any] = field(default_factory=list)

    def op(self, operator: str, *inputs: str, **attributes: Any) -> str:
        """One of ONNX's operators on values; the name of what comes out."""
        from onnx import helper

        name = f"v{len(self.nodes)}"
        self.nodes.append(helper.make_node(operator, list(inputs), [name], **attributes))
        return name

    def constant(self, value: Any, dtype: Any = np.float64) -> str:
        """An array or a number of type `dtype`."""
        from onnx import numpy_helper

        name = f"c{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.array(value, dtype=dtype), name))
        return name

    def input(self, name: str, width: int | None, dtype: Any = np.float64) -> str:
        """(n, width), or (n,) where width is None, given anew at every step."""
        self.inputs.append(_declared(name, width, dtype))
        return name

    def output(self, name: str, value: str, width: int | None, dtype: Any = np.float64) -> None:
        """Have `value`, (n, width) or (n,), come out under `name`."""
        from onnx import helper

        self.nodes.append(helper.make_node("Identity", [value], [name]))
        self.outputs.append(_declared(name, width, dtype))

    def state(self, name: str, width: int | None, dtype: Any = np.float64) -> str:
        """What the step before has left under `name` by `keep`: zeros at a run's start."""
        return self.input(STATE + name, width, dtype)

    def keep(self, name: str, value: str, width: int | None, dtype: Any = np.float64) -> None:
        """Leave `value` to the next step."""
        self.output(NEXT + name, value, width, dtype)

    def cast(self, value: str, dtype: Any) -> str:
        """`value` as another type."""
        from onnx import helper

        return self.op("Cast", value, to=helper.np_dtype_to_tensor_dtype(np.dtype(dtype)))

    def column(self, value: str) -> str:
        """(n,) as (n, 1)."""
        return self.op("Unsqueeze", value, self.constant([1], np.int64))

    def choose(self, value: str, columns: Array | list[int]) -> str:
        """Those columns of (n, d), in their order."""
        return self.op("Gather", value, self.constant(columns, np.int64), axis=1)

    def within_reach(self, levers: str) -> str:
        """Levers (n, 2), stopped at the ends of their ways."""
        return self.op("Min", self.op("Max", levers, self.constant(LOWEST)), self.constant(HIGHEST))

    def model(self, name: str, about: dict[str, str]) -> Any:
        """The whole as an ONNX model with `about` as its metadata, found to be sound by onnx's checker."""
        from onnx import checker, helper

        graph = helper.make_graph(self.nodes, name, self.inputs, self.outputs, self.constants)
        model = helper.make_model(
            graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=IR_VERSION
        )
        helper.set_model_props(model, about)
        checker.check_model(model, full_check=True)
        return model


def _declared(name: str, width: int | None, dtype: Any) -> Any:
    from onnx import helper

    shape: list[Any] = ["boats"] if width is None else ["boats", width]
    return helper.make_tensor_value_info(name, helper.np_dtype_to_tensor_dtype(np.dtype(dtype)), shape)
