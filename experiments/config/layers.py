"""Layers of an experiment, files and overrides: their merge, and targets at levels no longer evaluated."""

from collections.abc import Mapping, Sequence
from functools import reduce
from pathlib import Path
from typing import Any

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
    and that it does not. Its own targets stay, to be refused where their level is not evaluated.
    """
    kept: list[Layer] = []
    for group in groups:
        before, after = (_levels(_merged(layers)) for layers in (kept, group))
        gone = before - after if after else set()
        kept = [*((where, _without(data, gone)) for where, data in kept), *group]
    return kept


def _merged(layers: Sequence[Layer]) -> dict[str, Any]:
    return reduce(merged, (data for _, data in layers), {})


def _levels(data: Mapping[str, Any]) -> set[str]:
    """Names of the levels that are evaluated; none where there are none, or where they are no list."""
    levels = _mapping(data.get("evaluation")).get("levels")
    listed = levels if isinstance(levels, list) else []
    return {Path(level).stem for level in listed if isinstance(level, str)}


def _without(data: dict[str, Any], levels: set[str]) -> dict[str, Any]:
    """The layer's data without its targets at these levels, and without pilots that have no other target."""
    success = _mapping(_mapping(data.get("targets")).get("success"))
    if not levels or not success:
        return data
    kept = {pilot: _rates(rates, levels) for pilot, rates in success.items()}
    kept = {pilot: rates for pilot, rates in kept.items() if rates != {}}
    return data | {"targets": data["targets"] | {"success": kept}}


def _rates(rates: Any, levels: set[str]) -> Any:
    if not isinstance(rates, Mapping):
        return rates
    return {level: rate for level, rate in rates.items() if level not in levels}


def _mapping(data: Any) -> Mapping[str, Any]:
    return data if isinstance(data, Mapping) else {}
