"""The boat and the step that the pilot of a plan was made for, as its folder or its file tells."""

from collections.abc import Mapping
from typing import Any

from swamp_rl.pilots.description import Made
from swamp_rl.pilots.store import describe_pilot


def made_of(kind: str, options: Mapping[str, Any]) -> Made | None:
    """For which boat a pilot of that kind and those options was made; None where that is not told.

    UserError for a stored or exported pilot that is missing or damaged.
    """
    if kind == "stored":
        return describe_pilot(options["folder"]).made
    if kind == "onnx":
        from swamp_rl.export import OnnxPilot

        return OnnxPilot(options["file"]).made
    return None
