"""Design files with one number that no design has: each is refused by its key, or the design is finite."""

import copy
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.design.hull_lines import load_hull
from swamp_rl.design.matching import best_ranges, load_match, matches
from swamp_rl.design.pump_jet import design_pump_jet, load_pump_jet
from swamp_rl.design.stability import stability
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml, write_yaml

HEEL = np.radians([0.0, 50.0])
DESIGNS: dict[str, Callable[[Path], Any]] = {
    "swamp_hull": lambda path: stability(load_hull(path), load_hull(path).conditions[0], HEEL),
    "typhoon_match": lambda path: (matches(load_match(path)), best_ranges(load_match(path))),
    "swamp_pump_jet": lambda path: design_pump_jet(load_pump_jet(path)),
}
ABSURD = (0.0, 1e-29, 1e5, 1e18)


def with_one(data: Any, number: float) -> Iterator[tuple[str, Any]]:
    """Copies of a design in each of which another number is replaced, and the key of that."""
    for key in list(data) if isinstance(data, dict) else range(len(data)):
        if isinstance(data[key], dict | list):
            for below, changed in with_one(data[key], number):
                yield f"{key}.{below}".removesuffix(".value"), _with(data, key, changed)
        elif isinstance(data[key], int | float):
            yield str(key), _with(data, key, number)


def _with(data: Any, key: Any, value: Any) -> Any:
    changed = copy.copy(data)
    changed[key] = value
    return changed


@pytest.mark.parametrize("name", DESIGNS)
def test_a_number_that_no_design_has_is_refused_or_can_be_computed(name: str, tmp_path: Path) -> None:
    data, path = read_yaml(find_config("designs", name)), tmp_path / "design.yaml"
    for number in ABSURD:
        for key, changed in with_one(data, number):
            write_yaml(path, changed)
            try:
                DESIGNS[name](path)
            except UserError as error:
                assert "\n" not in str(error) or key in str(error)


@pytest.mark.parametrize(
    ("name", "key", "message"),
    [
        ("swamp_hull", "spacing", "spacing must be at most the length"),
        ("swamp_hull", "depth", "depth must be at most the length"),
        ("swamp_hull", "water_density", "water_density: must be at most 1300"),
        ("swamp_pump_jet", "revolutions", "lower revolutions"),
        ("swamp_pump_jet", "water_density", "water_density: must be at most 1300"),
        ("typhoon_match", "design_speed", "design_speed: must be at most 50"),
        ("typhoon_match", "water_density", "water_density: must be at most 1300"),
        ("typhoon_match", "propellers.diameter", "propellers.diameter: must be at most 20"),
    ],
)
def test_a_number_far_too_large_is_refused_by_its_key(
    name: str, key: str, message: str, tmp_path: Path
) -> None:
    changed = dict(with_one(read_yaml(find_config("designs", name)), 1e18))[key]
    write_yaml(tmp_path / "design.yaml", changed)
    with pytest.raises(UserError, match=message):
        DESIGNS[name](tmp_path / "design.yaml")
