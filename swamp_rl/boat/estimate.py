"""A boat file from length, breadth, mass and thrust alone: every other number is a published estimate."""

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any, Literal, get_args

from pydantic import BaseModel

from swamp_rl.boat.defaults import assumed, default_current, default_joypad, default_wind
from swamp_rl.boat.estimate_drive import (
    Sizes,
    loss_at_speed,
    resistance_at,
    resistance_section,
    speed_of_thrust,
    thrusters_of,
)
from swamp_rl.boat.estimate_hull import (
    ATHWART,
    BLOCK,
    GYRATION,
    added_masses,
    draught_of,
    fin_derivatives,
    hull_derivatives,
)
from swamp_rl.boat.foil import Foil
from swamp_rl.boat.merge import is_quantity
from swamp_rl.boat.plausible import implausible_sizes
from swamp_rl.boat.propeller_rudder import Propeller, PropellerRudder, Rudder
from swamp_rl.boat.quantity import SPREAD
from swamp_rl.boat.resistance import DriftResistance
from swamp_rl.boat.schema import Boat, Current, Hull, Joypad, Thruster, Wind
from swamp_rl.constants import FASTEST, GRAVITY
from swamp_rl.errors import UserError

Kind = Literal[
    "twin-fixed", "four-fixed", "azimuth", "four-azimuths", "propeller-rudder", "waterjet", "outboard"
]
KINDS = get_args(Kind)
DENSITY = 1025.0  # kg/m3, the sea
GIVEN = "given to swamp-rl boat new"
RANGE = 1e-4, 1e10
"""SI, of each size that is given: beyond it the estimates leave the range of numbers."""
LARGEST_FIN = 0.5  # of length times draught
# of a fin's part of a coefficient: area, aspect ratio and the hull's boundary layer are guesses
FIN_SPREAD = 0.4
DIGITS = 4  # of what is written
MODELS: dict[str, type[BaseModel]] = {
    "hull": Hull,
    "resistance": DriftResistance,
    "wind": Wind,
    "current": Current,
    "joypad": Joypad,
    "propeller": Propeller,
    "rudder": Rudder,
    "foil": Foil,
}
HEADS = {
    "hull": "coefficients on ½ρLd: Kijima 1990, Yoshimura and Masumoto 2012",
    "resistance": "½ρLd X'_0 u U",
    "thrusters": "one block for each",
    "wind": "any key may be left out: it then has this default",
    "current": "any key may be left out: it then has this default",
    "joypad": "what the two levers command; may be left out as a whole",
}
SPREADS = {
    "x_vr": 0.1,
    "y_v": 0.15,
    "y_r": 0.07,
    "n_v": 0.07,
    "n_r": 0.03,
    "c_d": 0.3,
    "c_ry": 0.4,
    "c_rn": 0.4,
}
OF_TWO = 2.0  # times these for two hulls: the regressions are of one, in undisturbed water
SOURCES = {
    "x_vr": "Yoshimura and Masumoto 2012, 1.91 C_B B/L - 0.08",
    "y_v": "Kijima 1990, -(π k/2 + 1.4 C_B B/L), k = 2 d/L",
    "y_r": "Yoshimura and Masumoto 2012, 0.5 C_B B/L",
    "n_v": "Kijima 1990, -k",
    "n_r": "Kijima 1990, -0.54 k + k²",
    "c_d": "Hoerner 1965, against B/(2 d)",
    "c_ry": "strip theory",
    "c_rn": "strip theory",
}


def boat_file(
    name: str,
    kind: str,
    length: float,
    breadth: float,
    mass: float,
    thrust: float | None,
    top_speed: float | None = None,
    draught: float | None = None,
    fin: float | None = None,
    demihull: float | None = None,
) -> dict[str, Any]:
    """The content of a boat file, each number `assumed`, with its source and the width `sd` of its prior.

    kind: one of KINDS; length, breadth, draught [m], mass [kg]; thrust [N]: of all thrusters together, full
    ahead at rest, None to estimate it by the top speed; top_speed [m/s]: what it gives; fin [m²]: lateral
    area of skeg, fin or lower unit at the stern, none by default; demihull [m]: breadth of each of two hulls,
    one hull by default. UserError for a number beyond RANGE, for neither thrust nor top speed, for a top
    speed beyond the Froude number that the simulator holds for, and for dimensions and a mass that no boat
    has.
    """
    asked: dict[str, float | None] = {"length": length, "breadth": breadth, "mass": mass}
    asked |= {"thrust": thrust, "top-speed": top_speed, "draught": draught, "fin": fin, "demihull": demihull}
    for word, value in asked.items():
        if value is not None and not RANGE[0] <= value <= RANGE[1]:
            raise UserError(
                f"--{word} {value:g}: must be a number above 0, within [{RANGE[0]:g}, {RANGE[1]:g}]"
            )
    if thrust is None and top_speed is None:
        raise UserError(
            "--thrust: give the total bollard pull [N], or --top-speed [m/s], by which it is estimated"
        )
    froude = (top_speed or 0.0) / math.sqrt(GRAVITY * length)
    if froude > FASTEST:
        raise UserError(
            f"--top-speed {top_speed:g}: is a Froude number of {froude:.3g} at {length:g} m of length; the "
            f"model goes to {FASTEST:g}, give at most {FASTEST * math.sqrt(GRAVITY * length):.3g} m/s"
        )
    if kind not in KINDS:
        raise UserError(f"--kind {kind}: must be one of {', '.join(KINDS)}")
    if demihull is not None and not 2.0 * demihull < breadth:
        raise UserError(f"--demihull {demihull:g}: two such hulls do not fit in --breadth {breadth:g}")
    sizes = _sizes(kind, length, breadth, mass, thrust, top_speed, draught, demihull)
    if fin is not None and fin > LARGEST_FIN * length * sizes.draught:
        raise UserError(
            f"--fin {fin:g}: is more than {LARGEST_FIN:g} of the hull's own lateral area, "
            f"{length * sizes.draught:.3g} m2; correct it"
        )
    if faults := implausible_sizes(sizes):
        raise UserError(of_sizes(": ".join(faults[0])))
    source = "given" if top_speed is not None else "where R = 0.9 m g Fn³, SWAMP's tank"
    thrusters = thrusters_of(kind, sizes)
    return {
        "name": name,
        **_particulars(sizes, draught is None),
        "hull": _hull(sizes, fin),
        "resistance": resistance_section(kind, sizes, source),
        "thrusters": thrusters,
        "wind": default_wind(length, breadth),
        "current": default_current(length, breadth, sizes.draught),
        "joypad": default_joypad(thrusters),
    }


def of_sizes(fault: str) -> str:
    """What is wrong with a boat's numbers, in terms of the sizes that they were estimated from."""
    options = "--length, --breadth, --draught, --mass, --thrust and --top-speed"
    return f"these sizes: {fault.partition('; check ')[0]}; check {options}"


def _sizes(
    kind: str,
    length: float,
    breadth: float,
    mass: float,
    thrust: float | None,
    top_speed: float | None,
    draught: float | None,
    demihull: float | None,
) -> Sizes:
    afloat = breadth if demihull is None else 2.0 * demihull
    block = BLOCK if draught is None else mass / (DENSITY * length * afloat * draught)
    depth = draught_of(mass, length, afloat, DENSITY) if draught is None else draught
    left = 1.0 - loss_at_speed(kind)
    pull = resistance_at(length, mass, top_speed or 0.0) / left if thrust is None else thrust
    speed = top_speed or speed_of_thrust(length, mass, left * pull)
    return Sizes(
        length, breadth, depth, mass, block, DENSITY, pull, speed, demihull or breadth, thrust is not None
    )


def _particulars(sizes: Sizes, floats: bool) -> dict[str, Any]:
    """The dimensions, the mass and the inertias; floats: whether the draught is an estimate."""
    length, breadth, draught, mass = sizes[:4]
    inertia = mass * ((GYRATION * length) ** 2 + (ATHWART * sizes.spacing) ** 2)
    gyration = "radius of gyration 0.25 L, ITTC" + (
        ", and 0.25 S abeam, SWAMP's CAD" if sizes.spacing else ""
    )
    surge, sway, yaw = added_masses(mass, length, sizes.demihull, draught)
    yaw += surge * (0.5 * sizes.spacing) ** 2  # each demihull at S/2 beside its own turning
    source = f"floats at C_B = {BLOCK:g}, small craft 0.35 to 0.65" if floats else GIVEN
    lamb = "Lamb 1932, ellipsoid of L, B, d" + (" of each demihull" if sizes.spacing else "")
    return {
        "length": assumed(length, "m", GIVEN, 0.02 * length),
        "breadth": assumed(breadth, "m", GIVEN, 0.02 * breadth),
        "draught": assumed(draught, "m", source, (0.25 if floats else 0.05) * draught),
        "mass": assumed(mass, "kg", GIVEN, 0.05 * mass),
        "inertia_z": assumed(inertia, "kg m2", gyration, 0.3 * inertia),
        "x_g": assumed(0.0, "m", "ours, amidships", 0.03 * length),
        "added_mass_surge": assumed(-surge, "kg", lamb, max(surge, 0.05 * mass)),
        "added_mass_sway": assumed(-sway, "kg", lamb, 0.4 * sway),
        "added_inertia_yaw": assumed(-yaw, "kg m2", lamb, max(0.5 * yaw, 0.1 * inertia)),
        "water_density": assumed(sizes.water_density, "kg/m3", "the sea; fresh water has 1000", 10.0),
    }


def _hull(sizes: Sizes, fin: float | None) -> dict[str, Any]:
    found = hull_derivatives(sizes.length, sizes.demihull, sizes.draught, sizes.block)
    added = {} if fin is None else fin_derivatives(fin, sizes.length, sizes.draught)
    hull, wider = {}, OF_TWO if sizes.spacing else 1.0
    for name, value in found.items():
        source = SOURCES[name] + (f"; a fin of {fin:g} m2 aft, Fujii 1961" if name in added else "")
        of_fin = added.get(name, 0.0)
        spread = math.hypot(wider * SPREADS[name], FIN_SPREAD * of_fin)
        hull[name] = assumed(value + of_fin, "1", source, spread)
    apart = "breadth less that of a demihull" if sizes.spacing else "one hull, or two taken as one"
    return hull | {"spacing": assumed(sizes.spacing, "m", apart, 0.1 * sizes.breadth)}


def annotated(content: Mapping[str, Any], head: str) -> str:
    """The text of a boat file, each number on a line with what it means; head: its first lines."""
    lines = [f"# {line}" for line in head.splitlines()]
    return "\n".join([*lines, *_lines(content, Boat, "")]) + "\n"


def _lines(section: Mapping[str, Any], model: type[BaseModel], indent: str) -> Iterator[str]:
    for key, value in section.items():
        field = model.model_fields.get(key)
        meaning = " ".join((field.description or "").split()) if field else ""
        if isinstance(value, Mapping) and not is_quantity(value):
            yield from ([] if indent else [""])
            yield f"{indent}{key}: # {HEADS.get(key, meaning)}"
            yield from _lines(value, MODELS[key], f"{indent}  ")
        elif key == "thrusters" and not indent:
            yield from ("", f"{key}: # {HEADS[key]}")
            for thruster in value:
                of = PropellerRudder if thruster["kind"] == "propeller_rudder" else Thruster
                inner = list(_lines(thruster, of, "    "))
                yield from [f"  - {inner[0].lstrip()}", *inner[1:]]
        else:
            yield f"{indent}{key}: {_leaf(value, not indent)} # {meaning}"


def _leaf(value: Any, named: bool) -> str:
    """A leaf as YAML in one line, numbers to four digits; named: a boat's name stays in quotes."""
    if not is_quantity(value):
        text = json.dumps(_short(value), ensure_ascii=False)
        return text if text.startswith('"') and named else text.replace('"', "")
    unit = '"1"' if value["unit"] == "1" else value["unit"]
    parts = [
        f"value: {json.dumps(_short(value['value']))}",
        f"unit: {unit}",
        f"provenance: {value['provenance']}",
    ]
    parts.append(f"source: {json.dumps(value['source'], ensure_ascii=False)}")
    if SPREAD in value:
        parts.append(f"{SPREAD}: {json.dumps(_short(value[SPREAD]))}")
    return f"{{{', '.join(parts)}}}"


def _short(value: Any) -> Any:
    if isinstance(value, list):
        return [_short(one) for one in value]
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value
