"""A pilot's step as an ONNX graph, for computers that have an ONNX runtime and nothing else of this."""

from swamp_rl.export.onnx_file import greatest_difference, write_onnx
from swamp_rl.export.onnx_pilot import OnnxPilot

__all__ = ["OnnxPilot", "greatest_difference", "write_onnx"]
