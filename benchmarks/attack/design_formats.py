"""Formats of designs, missions and boats by estimates: a good file of each, and the reader of a bad one."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.attack.cheaper import figures_left_blank
from benchmarks.attack.samples import copied_config, make_boat

Make, Read = Callable[[Path], Path], Callable[[Path], Any]


def _hull(path: Path) -> Any:
    """Of the righting levers, whose 61 angles take seconds, three."""
    from swamp_rl.experiments.reports.design_hull import draught_over_load, floating, quantities

    from swamp_rl.boat import load_boat
    from swamp_rl.design.hull_lines import load_hull
    from swamp_rl.design.stability import stability

    hull = load_hull(path)
    heel = np.radians([0.0, 5.0, 50.0])
    conditions = [stability(hull, condition, heel) for condition in hull.conditions]
    load_boat("swamp", floating(hull, conditions[0]))
    return draught_over_load(hull), [quantities(hull, one) for one in conditions]


def _match(path: Path) -> Any:
    from swamp_rl.experiments.reports.design_match import write_match

    with figures_left_blank():
        return write_match(path.parent / "out", str(path))


def _pump_jet(path: Path) -> Any:
    from swamp_rl.experiments.reports.design_pump_jet import write_pump_jet

    with figures_left_blank():
        return write_pump_jet(path.parent / "out", str(path), "swamp")


def _mission(path: Path) -> Any:
    from swamp_rl.energy.mission import load_mission

    return load_mission(path)


def _boat(path: Path) -> Any:
    from swamp_rl.boat import load_boat
    from swamp_rl.simulator import parameters

    return parameters(load_boat(path))


DESIGN_FORMATS: dict[str, tuple[Make, Read]] = {
    "design hull": (copied_config("designs/swamp_hull.yaml"), _hull),
    "design match": (copied_config("designs/typhoon_match.yaml"), _match),
    "design match, of a boat": (copied_config("designs/typhoon_cfd.yaml"), _match),
    "design pump-jet": (copied_config("designs/swamp_pump_jet.yaml"), _pump_jet),
    "mission.yaml": (copied_config("missions/survey.yaml"), _mission),
    "boat.yaml, by estimates": (make_boat("propeller-rudder"), _boat),
}
"""Of each name the maker and the reader."""
