"""Layers of an experiment, files and overrides: their merge, and targets of what is no longer evaluated."""

from collections.abc import Mapping, Sequence
from functools import reduce
from pathlib import Path
from typing import Any

from swamp_rl.errors import UserError
from swamp_rl.explain import nearest

Layer = tuple[str | Path, dict[str, Any]]
"""Where it was given, a file or an override, and its nested keys; each layer overrides those below it."""


def merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """`below` with the keys of `above` over it, mapping into mapping; other values replace those below."""
    result = dict(below)
    for key, value in above.items():
        under = result.get(key)
        if isinstance(under, Mapping) and isinstance(value, Mapping):
            value = merged(under, value)
        result[key] = value
    return result


def with_targets_evaluated(groups: Sequence[Sequence[Layer]]) -> list[Layer]:
    """All layers of the groups, the lowest first, without targets at levels that are no longer evaluated.

    A group that gives `evaluation.levels` removes the targets of lower groups at levels that these evaluate
    and that it does not, one that sets pilots to null removes theirs. Its own targets stay, to be refused
    where their level or pilot is not evaluated. UserError for a pilot set to null that no layer below has.
    """
    kept: list[Layer] = []
    for group in groups:
        before, after = (_levels(_merged(layers)) for layers in (kept, group))
        gone, dropped = before - after if after else set(), _dropped(kept, group)
        kept = [*((where, _without(data, gone, dropped)) for where, data in kept), *group]
    return kept


def _dropped(below: Sequence[Layer], group: Sequence[Layer]) -> set[str]:
    """Names of the pilots that the group sets to null."""
    found = set()
    for number, (where, data) in enumerate(group):
        known = _mapping(_merged([*below, *group[:number]]).get("pilots"))
        for name, plan in _mapping(data.get("pilots")).items():
            if plan is None and name not in known:
                raise UserError(f"{where}: pilots.{name}: no such pilot to drop{nearest(str(name), known)}")
            if plan is None:
                found.add(name)
    return found


def _merged(layers: Sequence[Layer]) -> dict[str, Any]:
    return reduce(merged, (data for _, data in layers), {})


def _levels(data: Mapping[str, Any]) -> set[str]:
    """Names of the levels that are evaluated; none where there are none, or where they are no list."""
    levels = _mapping(data.get("evaluation")).get("levels")
    listed = levels if isinstance(levels, list) else []
    return {Path(level).stem for level in listed if isinstance(level, str)}


def _without(data: dict[str, Any], levels: set[str], pilots: set[str]) -> dict[str, Any]:
    """The layer's data without its targets at these levels and of these pilots, and without pilots that have
    no other target."""
    targets = _mapping(data.get("targets"))
    success, smoother = _mapping(targets.get("success")), targets.get("smoother_than_data")
    left: dict[str, Any] = {}
    if success and (levels or pilots):
        rates = {name: _rates(one, levels) for name, one in success.items() if name not in pilots}
        left["success"] = {name: one for name, one in rates.items() if one != {}}
    if isinstance(smoother, list):
        left["smoother_than_data"] = [name for name in smoother if name not in pilots]
    return data | {"targets": {**targets, **left}} if left else data


def _rates(rates: Any, levels: set[str]) -> Any:
    if not isinstance(rates, Mapping):
        return rates
    return {level: rate for level, rate in rates.items() if level not in levels}


def _mapping(data: Any) -> Mapping[str, Any]:
    return data if isinstance(data, Mapping) else {}
