"""What a boat file may leave to be worked out: the thrusters' common block, and Yoshimura's C_D."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swamp_rl.boat.merge import is_quantity, is_section, listed, merge, without_nulls
from swamp_rl.errors import UserError

TEMPLATE = "thruster_model"  # what all thrusters of a file share, so that it is written once
REGRESSION = "yoshimura"


def resolved(raw: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """The merged mapping as the schema wants it; what is malformed is left for the schema to refuse.

    Thrusters may stand as a list or, by name, as a mapping. What is null is removed, from a thruster also
    where the common block has it.
    """
    whole = {key: value for key, value in raw.items() if key != TEMPLATE}
    template = {} if raw.get(TEMPLATE) is None else raw[TEMPLATE]
    if not isinstance(template, Mapping):
        raise UserError(f"{path}: {TEMPLATE} must be a mapping of what all thrusters share")
    thrusters: Any = raw.get("thrusters")
    if is_section(thrusters):
        thrusters = [item for item in listed(thrusters) if item is not None]
    if isinstance(thrusters, list):
        whole["thrusters"] = [merge(template, item) if is_section(item) else item for item in thrusters]
    hull: Any = raw["hull"] if isinstance(raw.get("hull"), Mapping) else {}
    given: Any = hull.get("c_d")
    if _value(given) == REGRESSION:
        number = _regression(_value(raw.get("length")), _value(raw.get("draught")), path)
        whole["hull"] = {**hull, "c_d": {**given, "value": number} if is_quantity(given) else number}
    return without_nulls(whole)


def _regression(length: Any, draught: Any, path: Path) -> float:
    """C_D from length and draught; 0 where one of these is no length, for which the file is then refused."""
    if not (_is_positive(length) and _is_positive(draught)):
        return 0.0
    number = yoshimura_c_d(length, draught)
    if number < 0.0:
        raise UserError(
            f"{path}: hull.c_d: the regression {REGRESSION!r} gives {number:.3g} at length / draught "
            f"{length / draught:.4g}, for it ends near 31; check both, or give c_d as a number"
        )
    return number


def yoshimura_c_d(length: float, draught: float) -> float:
    """Cross-flow drag coefficient [1] by Yoshimura's regression on length over draught (thesis 8.1.3)."""
    return -0.0591 * length / draught + 1.848


def _value(given: Any) -> Any:
    return given.get("value") if is_quantity(given) else given


def _is_positive(given: Any) -> bool:
    is_number = isinstance(given, int | float) and not isinstance(given, bool)
    return is_number and math.isfinite(given) and given > 0
