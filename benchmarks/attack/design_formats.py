"""Formats of designs, missions and boats by estimates: a good file of each, and the reader of a bad one."""

import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.attack.cheaper import figures_left_blank
from benchmarks.attack.samples import THRUSTERS, copied_config, make_boat
from swamp_rl.ordinary import MOST_JSON, contents

Make, Read = Callable[[Path], Path], Callable[[Path], Any]


def seldom(path: Path) -> bool:
    """Whether an input is one of the seven in eight; what is no file or too large is left to the reader."""
    try:
        return zlib.crc32(contents(path, MOST_JSON)) % 8 != 0
    except OSError:
        return True


@contextmanager
def seldom_drawn(path: Path) -> Iterator[None]:
    """Figures, nine tenths of the time, are laid out for one input in eight, and left blank."""
    from swamp_rl.experiments.reports import design_match, design_pump_jet

    with ExitStack() as stack:
        stack.enter_context(figures_left_blank())
        if seldom(path):
            for module, name in ((design_match, "draw_match"), (design_pump_jet, "draw_pump_jet")):
                stack.enter_context(patch.object(module, name, lambda path, **_: path.touch()))
        yield


def _hull(path: Path) -> Any:
    """Of the righting levers, whose 61 angles take seconds, two, and three of one input in eight."""
    from swamp_rl.experiments.reports.design_hull import floating, quantities

    from swamp_rl.boat import load_boat
    from swamp_rl.design.hull_lines import load_hull
    from swamp_rl.design.stability import stability

    hull = load_hull(path)
    heel = np.radians([0.0, 50.0] if seldom(path) else [0.0, 5.0, 50.0])
    conditions = [stability(hull, condition, heel) for condition in hull.conditions]
    load_boat("swamp", floating(hull, conditions[0]))
    return [quantities(hull, one) for one in conditions]


def _match(path: Path) -> Any:
    from swamp_rl.experiments.reports.design_match import write_match

    with seldom_drawn(path):
        return write_match(path.parent / "out", str(path))


def _pump_jet(path: Path) -> Any:
    from swamp_rl.experiments.reports.design_pump_jet import write_pump_jet

    with seldom_drawn(path):
        return write_pump_jet(path.parent / "out", str(path), "swamp")


def _mission(path: Path) -> Any:
    from swamp_rl.energy.mission import load_mission

    return load_mission(path)


def _path(path: Path) -> Any:
    from swamp_rl.guidance.path_file import load_path

    return load_path(path)[0].curve()


def _vehicle(path: Path) -> Any:
    from swamp_rl.identification.square_twin import load_vehicle

    return load_vehicle(path)


def make_curves(folder: Path) -> Path:
    """A level of disturbances of forces that are functions of one variable, by knots and by formulas."""
    (folder / "file.yaml").write_text(CURVES)
    return folder / "file.yaml"


CURVES = """effects:
- {effect: force_curve, component: surge, covariate: heading, knots: [-3.2, 0.0, 3.2], values: [2, 1, 2]}
- effect: force_curve
  component: yaw
  covariate: yaw_rate
  formula: dead_zone
  knots: [-1, 1]
  values: [3, 0.1]
  standard_errors: [0.1, 0.01]
- {effect: force_curve, thruster: bs, component: thrust, covariate: throttle, knots: [0, 1], values: [1, 0]}
"""


def make_propellers(folder: Path) -> Path:
    """SWAMP with a propeller of each kind and a table of thrust in place of its jets."""
    (folder / "boat.yaml").write_text(PROPELLERS)
    return folder / "boat.yaml"


PROPELLERS = """extends: swamp
thrust_deduction: null
thruster_model:
  thrust_linear: null
  thrust_quadratic: null
  astern_linear: null
  astern_quadratic: null
  advance_loss: null
  power: null
thrusters:
  bs:
    propeller:
      {diameter: 0.08, revolutions_max: 25.0, revolutions_max_astern: 20.0, wake: 0.1, crossflow_loss: 0.5,
      side_share: 0.05, torque_coefficient: 0.05,
      open_water: {kind: linear, bollard_coefficient: 0.45, null_advance: 1.05}}
    power: {idle: 9.4, efficiency: 0.5}
  bp:
    propeller: {diameter: 0.08, revolutions_max: 25.0, open_water: {kind: disc, pitch_ratio: 1.0}}
    power: {idle: 1.0, coefficient: 2.0}
  ss:
    propeller:
      {diameter: 0.08, revolutions_max: 25.0, revolutions_max_astern: 20.0, torque_coefficient: 0.05,
      open_water: {kind: four_quadrant, cosines: [0.01, 0.2, 0.0, -0.01], sines: [0.0, -0.75, 0.02, 0.01]},
      motor: {stall_torque: 3.0, nominal_torque: 1.5, nominal_speed: 200.0, no_load_speed: 300.0,
      gear_ratio: 0.8, inertia: 0.001}}
    power: {idle: 9.4, efficiency: 0.5}
  sp:
    thrust_table:
      speed: {value: [0.0, 1.0, 2.0], unit: m/s, provenance: measured, source: "towing tank, 3 May"}
      rows:
      - {throttle: -1.0, thrust: [-20.0, -26.0, -34.0]}
      - {throttle: 0.5, thrust: [8.0, 4.0, -2.0]}
      - {throttle: 1.0, thrust: [30.0, 22.0, 12.0]}
    power: {throttle: [0.0, 0.5, 1.0], power: [2.0, 10.0, 60.0]}
"""


def read_level(path: Path) -> Any:
    """Disturbances of a file, for SWAMP's thrusters."""
    from swamp_rl.effects import load_disturbances

    return load_disturbances(path, THRUSTERS)


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
    "path.yaml": (copied_config("paths/river.yaml"), _path),
    "path.yaml, lines": (copied_config("paths/lawn_mower.yaml"), _path),
    "vehicle.yaml": (copied_config("vehicles/typhoon.yaml"), _vehicle),
    "disturbances.yaml, curves": (make_curves, read_level),
    "boat.yaml, propellers": (make_propellers, _boat),
    "boat.yaml, thrust polynomials": (copied_config("boats/esso_osaka.yaml"), _boat),
    "boat.yaml, resistance tables": (copied_config("boats/swamp-thesis.yaml"), _boat),
    "boat.yaml, by estimates": (make_boat("propeller-rudder"), _boat),
}
"""Of each name the maker and the reader."""
