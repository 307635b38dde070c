"""Effects onto records: each parameter is added to, multiplied into or put in place of its field."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.effects.curve import Curve, write_curve
from swamp_rl.effects.declare import Effect
from swamp_rl.effects.entries import ALL, EffectEntry, Selector

COMBINE = {
    "add": lambda old, new: old + new,
    "multiply": lambda old, new: old * new,
    "replace": lambda old, new: np.broadcast_to(new, old.shape),
}


def apply_effects(
    record: NDArray[np.void], entries: Sequence[EffectEntry], thruster_names: Sequence[str]
) -> None:
    """Write `entries`, in their order, into the fields of a structured array (n,), in place.

    A field has shape (n,), or (n, K) with a column for each of the K thrusters.
    """
    for entry in entries:
        thrusters = selected(entry.thruster, thruster_names)
        write_effect(record, entry.effect, entry.values, thrusters, curve=entry.curve)


def selected(thruster: Selector, thruster_names: Sequence[str]) -> NDArray[np.bool_]:
    """(K,) which thrusters a selector means; None means all of them, as `all` does."""
    if isinstance(thruster, tuple):
        return np.array([name in thruster for name in thruster_names], dtype=bool)
    return np.array([thruster in (None, ALL, name) for name in thruster_names], dtype=bool)


def write_effect(
    record: NDArray[np.void],
    effect: Effect,
    values: Mapping[str, Any],
    thrusters: NDArray[np.bool_],
    boats: NDArray[np.bool_] | bool = True,
    curve: Curve | None = None,
) -> None:
    """One effect into `record` (n,) in place, for the marked boats (n,) and thrusters (K,) or (n, K).

    values: parameter name -> a number or one for each boat (n,). UserError for more curves than a boat has
    room for.
    """
    boats = np.broadcast_to(boats, record.shape)
    if curve:
        write_curve(record["force_curves"], curve, values, int(thrusters.ravel().argmax()), boats)
    for parameter in effect.parameters:
        field = record[parameter.field]
        value = np.broadcast_to(np.asarray(values[parameter.name], dtype=float), record.shape)
        where = boats
        if field.ndim == 2:
            value, where = value[:, None], boats[:, None] & thrusters
        np.copyto(field, COMBINE[effect.combine](field, value), where=where)
    if effect.swaps:
        exchange(record[effect.swaps], boats[:, None] & thrusters)
    if effect.reverses:
        field = record[effect.reverses]
        np.copyto(field, -field, where=boats[:, None] & thrusters)


def exchange(field: NDArray[Any], marked: NDArray[np.bool_]) -> None:
    """Exchange the two marked numbers of each row of `field` (n, K), in place; rows without marks stay."""
    rows = np.flatnonzero(marked.any(axis=1))
    two = np.nonzero(marked[rows])[1].reshape(-1, 2)
    field[rows[:, None], two] = field[rows[:, None], two[:, ::-1]]
