"""A designed pump-jet: tables, the thrust and power curve, and the boat file that has its thrust."""

import math
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.design import (
    Quantity,
    Table,
    as_json,
    boat_file,
    designed,
    spec,
    write_design,
)
from swamp_rl.experiments.reports.design_pump_jet_figure import draw_pump_jet

from swamp_rl.boat import load_boat
from swamp_rl.boat.schema import Thruster
from swamp_rl.design.pump_jet import OUTLET_ANGLES, PumpJet, design_pump_jet, load_pump_jet, running_at
from swamp_rl.design.velocity_triangles import Triangle
from swamp_rl.errors import UserError

FIGURE = "pump_jet.png"
THROTTLES = np.linspace(0.0, 1.0, 21)
CURVE = {
    "throttle": "1",
    "revolutions": "1/s",
    "flow": "m3/s",
    "head": "m",
    "thrust": "N",
    "shaft_power": "W",
    "electric_power": "W",
}
TRIANGLES = {
    "edge": "",
    "streamline": "",
    "radius": "m",
    "blade_speed": "m/s",
    "meridian_speed": "m/s",
    "whirl_speed": "m/s",
    "relative_speed": "m/s",
    "angle": "rad",
}


def write_pump_jet(out: Path, asked: str, boat: str) -> list[str]:
    """Design the pump-jet of a file and write it into `out`; lines to print. UserError if there is none."""
    jet = design_pump_jet(load_pump_jet(asked))
    refuse_propellers(boat)
    found = quantities(jet)
    rows = [list(asdict(running_at(jet, float(throttle))).values()) for throttle in THROTTLES]
    triangles = [
        triangle_row(edge, triangle)
        for edge, three in (("inlet", jet.inlet), ("outlet", jet.outlet))
        for triangle in three
    ]
    content = {"design": "pump-jet", "asked": spec(jet.design), "figures": as_json(found)}
    write_design(
        out,
        asked,
        content,
        [Table("curve.csv", CURVE, rows), Table("triangles.csv", TRIANGLES, triangles)],
        (FIGURE, partial(draw_pump_jet, jet=jet)),
        boat_file(boat, thrust_of(jet)),
    )
    lines = [one.line for one in found]
    if not jet.efficient:
        low, high = (math.degrees(angle) for angle in OUTLET_ANGLES)
        lines.append(f"the vane outlet angle is outside of {low:g} to {high:g} deg: expect less efficiency")
    return lines


def refuse_propellers(boat: str) -> None:
    """UserError where the thrusters of a boat are no jets."""
    others = [one.name for one in load_boat(boat).thrusters if not isinstance(one, Thruster)]
    if others:
        raise UserError(
            f"{boat}: {', '.join(others)}: no jet, which a pump-jet could replace; name another --boat"
        )


def thrust_of(jet: PumpJet) -> dict[str, Any]:
    """The keys of a boat file that the jets share: thrust at rest T p², and the nozzle."""
    source = f"design {jet.design.name}"
    return {
        "thruster_model": {
            "thrust_linear": designed(0.0, "N", f"{source}, affinity laws"),
            "thrust_quadratic": designed(jet.design.thrust, "N", source),
            "nozzle_area": designed(jet.design.nozzle_area, "m2", source),
        }
    }


def triangle_row(edge: str, triangle: Triangle) -> list[Any]:
    """A row of `TRIANGLES`."""
    return [
        edge,
        triangle.streamline,
        triangle.radius,
        triangle.blade,
        triangle.meridian,
        triangle.whirl,
        triangle.relative,
        triangle.angle,
    ]


def angle(key: str, value: float, meaning: str) -> Quantity:
    """An angle [rad] that people read in degrees."""
    return Quantity(key, value, "rad", meaning, f"{math.degrees(value):.1f} deg")


def quantities(jet: PumpJet) -> list[Quantity]:
    """What table 5.1 lists, and geometry, flow and power."""
    inlet_constant, outlet_constant = jet.capacity_constants
    inlet, outlet = jet.geometry.inlet, jet.geometry.outlet
    speed = f"{60.0 * jet.design.revolutions:.4g} rpm"
    return [
        Quantity("thrust", jet.design.thrust, "N", "thrust at rest T"),
        Quantity("revolutions", jet.design.revolutions, "1/s", "revolutions n", speed),
        Quantity("outlet_speed", jet.outlet_speed, "m/s", "speed of the jet V_o"),
        Quantity("flow", jet.flow, "m3/s", "flow Q_o"),
        Quantity("head", jet.head, "m", "head H_p"),
        Quantity("specific_speed", jet.specific_speed, "rpm, m3/s, m", "specific speed N_s, metric"),
        Quantity("us_specific_speed", jet.us_specific_speed, "rpm, gpm, ft", "specific speed N_s, US"),
        Quantity("speed_constant", jet.speed_constant, "1", "speed constant K_u"),
        Quantity("head_coefficient", jet.head_coefficient, "1", "head coefficient ψ"),
        Quantity("inlet_capacity_constant", inlet_constant, "1", "capacity constant K_m1"),
        Quantity("outlet_capacity_constant", outlet_constant, "1", "capacity constant K_m2"),
        angle("vane_inlet_angle", jet.inlet[1].angle, "vane entrance angle β_1"),
        angle("vane_outlet_angle", jet.outlet[1].angle, "vane outlet angle β_2, without slip"),
        Quantity("slip", jet.slip, "1", "slip factor σ (Stodola)"),
        angle(
            "vane_outlet_angle_with_slip", jet.vane_angle, "vane outlet angle that makes the head with slip"
        ),
        *(
            Quantity(f"{edge}_{line}_diameter", value, "m", f"{edge} diameter at the {line}")
            for edge, three in (("inlet", inlet), ("outlet", outlet))
            for line, value in zip(("tip", "mean", "root"), three, strict=True)
        ),
        Quantity("inlet_vane_height", jet.geometry.inlet_height, "m", "height of the inlet edge l_i"),
        Quantity("outlet_vane_height", jet.geometry.outlet_height, "m", "height of the outlet edge l_o"),
        Quantity("shaft_power", jet.shaft_power, "W", "shaft power"),
        Quantity("electric_power", jet.electric_power, "W", "electric power"),
    ]
