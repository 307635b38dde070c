"""What a boat file leaves to be worked out: thrusters' common block, draught by load, Yoshimura's C_D."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swamp_rl.boat.loading import Loading, is_loading
from swamp_rl.boat.merge import is_quantity, is_section, listed, merge, value_of, without_nulls
from swamp_rl.effects.entries import is_number
from swamp_rl.errors import UserError
from swamp_rl.explain import validated

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
    if is_loading(value_of(raw.get("draught"))):
        number = _by_load(raw, path)
        asked: Any = raw["draught"]
        whole["draught"] = {**asked, "value": number} if is_quantity(asked) else number
    hull: Any = raw["hull"] if isinstance(raw.get("hull"), Mapping) else {}
    given: Any = hull.get("c_d")
    if value_of(given) == REGRESSION:
        number = _regression(value_of(raw.get("length")), value_of(whole.get("draught")), path)
        whole["hull"] = {**hull, "c_d": {**given, "value": number} if is_quantity(given) else number}
    return without_nulls(whole)


def _by_load(raw: Mapping[str, Any], path: Path) -> float:
    """Draught [m] of the file's mass; UserError where the table, the mass or the density are none."""
    mass, density = value_of(raw.get("mass")), value_of(raw.get("water_density"))
    if raw.get("loading") is None:
        raise UserError(
            f"{path}: draught: loading: the file has no section loading; add it, or give a number"
        )
    if not (_is_positive(mass) and _is_positive(density)):
        raise UserError(
            f"{path}: draught: loading: needs mass and water_density, numbers above 0; check them"
        )
    table = validated(f"{path}: loading", Loading, raw["loading"])
    try:
        return table.draught_at(mass, density)
    except ValueError as error:
        raise UserError(f"{path}: draught: loading: {error}; change mass, or give a number") from error


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


def _is_positive(given: Any) -> bool:
    return is_number(given) and given > 0
