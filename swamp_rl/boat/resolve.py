"""What a boat file may leave to be worked out: the thrusters' common block, and Yoshimura's C_D."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swamp_rl.boat.merge import is_quantity
from swamp_rl.errors import UserError

TEMPLATE = "thruster_model"  # what all thrusters of a file share, so that it is written once
REGRESSION = "yoshimura"


def resolved(raw: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """The merged mapping as the schema wants it; what is malformed is left for the schema to refuse."""
    whole = {key: value for key, value in raw.items() if key != TEMPLATE}
    template = raw.get(TEMPLATE, {})
    if not isinstance(template, Mapping):
        raise UserError(f"{path}: {TEMPLATE} must be a mapping of what all thrusters share")
    if isinstance(raw.get("thrusters"), list):
        whole["thrusters"] = [
            {**template, **thruster} if isinstance(thruster, Mapping) else thruster
            for thruster in raw["thrusters"]
        ]
    length, draught = _value(raw.get("length")), _value(raw.get("draught"))
    hull: Any = raw["hull"] if isinstance(raw.get("hull"), Mapping) else {}
    given: Any = hull.get("c_d")
    if _value(given) == REGRESSION and _is_positive(length) and _is_positive(draught):
        number = yoshimura_c_d(length, draught)
        whole["hull"] = {**hull, "c_d": {**given, "value": number} if is_quantity(given) else number}
    return whole


def yoshimura_c_d(length: float, draught: float) -> float:
    """Cross-flow drag coefficient [1] by Yoshimura's regression on length over draught (thesis 8.1.3)."""
    return -0.0591 * length / draught + 1.848


def _value(given: Any) -> Any:
    return given.get("value") if is_quantity(given) else given


def _is_positive(given: Any) -> bool:
    is_number = isinstance(given, int | float) and not isinstance(given, bool)
    return is_number and math.isfinite(given) and given > 0
