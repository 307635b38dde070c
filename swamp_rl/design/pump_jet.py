"""Design of a mixed-flow pump-jet from its thrust (A. Odetti's thesis, 5.3.1; the pump-jet paper, 3.1).

Equation numbers are the thesis's. Where the print is wrong, the function says what is taken in its place.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from swamp_rl.boat.part import NOT_NEGATIVE, POSITIVE, WATER, Part
from swamp_rl.boat.quantity import Unit
from swamp_rl.constants import FOOT, GRAVITY
from swamp_rl.design.read import read_design
from swamp_rl.design.velocity_triangles import STREAMLINES, Triangle, free_vortex_triangle, slip_factor
from swamp_rl.errors import UserError

GALLON_PER_MINUTE = 3.785411784e-3 / 60.0  # m3/s
MINUTE = 60.0  # s
OUTLET_ANGLES = math.radians(15.0), math.radians(35.0)  # vane angles that keep the efficiency, 5.3.1

FASTEST_VANE = 1000.0  # m/s, well below the speed of sound in water

SHARE = Field(gt=0, le=1)
RATIO = Field(gt=0, le=10)


class PumpJetDesign(Part):
    """A pump-jet's requirements and the ratios that its geometry is scaled by."""

    design: Literal["pump-jet"]
    "Kind of design."
    name: Annotated[str, Field(min_length=1)]
    "Name in tables; the file's by default."
    thrust: Annotated[float, POSITIVE, Unit("N")]
    "T: ahead, at rest, at full revolutions."
    revolutions: Annotated[float, POSITIVE, Unit("1/s")]
    "n: full revolutions of the impeller."
    water_density: Annotated[float, WATER, Unit("kg/m3")]
    "Density of the water."
    module_diameter: Annotated[float, POSITIVE, Unit("m")]
    "D_p: of the module, which all lengths are scaled by."
    nozzle_area: Annotated[float, POSITIVE, Unit("m2")]
    "A_n: of all openings together (5.1)."
    nozzle_angle: Annotated[float, Field(ge=0, lt=1.4), Unit("rad")]
    "α: of the jet below the horizontal."
    nozzle_loss: Annotated[float, NOT_NEGATIVE, Unit("1")]
    "k_n of h_n = k_n V_o²/2g (5.31)."
    inlet_speed: Annotated[float, NOT_NEGATIVE, Unit("m/s")] = 0.0
    "V_i: of the water at the intake (5.10)."
    loss_efficiency: Annotated[float, SHARE, Unit("1")]
    "η_loss: by which the head of the jet and the nozzle is divided (5.10)."
    pump_efficiency: Annotated[float, SHARE, Unit("1")]
    "η_p of the power (5.12)."
    mechanical_efficiency: Annotated[float, SHARE, Unit("1")]
    "η_m of the power (5.12)."
    rotative_efficiency: Annotated[float, SHARE, Unit("1")] = 1.0
    "η_r of the power (5.12)."
    motor_efficiency: Annotated[float, SHARE, Unit("1")]
    "Efficiency of the motor: shaft power over electric power."
    blades: Annotated[int, Field(ge=2, le=40)]
    "Number of vanes."
    blade_thickness: Annotated[float, POSITIVE, Unit("m")]
    "Thickness of a vane, constant along it."
    inlet_tip_ratio: Annotated[float, RATIO, Unit("1")]
    "D_1t / D_p."
    inlet_mean_ratio: Annotated[float, RATIO, Unit("1")]
    "D_1m / D_p."
    inlet_height_ratio: Annotated[float, RATIO, Unit("1")]
    "l_i / D_p: height of the vane's inlet edge."
    impeller_height_ratio: Annotated[float, RATIO, Unit("1")]
    "h_o / D_p: height of the impeller."
    outlet_mean_ratio: Annotated[float, RATIO, Unit("1")]
    "e_m = D_1t / D_2m."
    outlet_tip_ratio: Annotated[float, RATIO, Unit("1")]
    "e = D_1t / D_2t."
    inlet_whirl: Annotated[float, NOT_NEGATIVE, Unit("m/s")]
    "c_u1: tangential speed of the water at the mean inlet diameter (5.17)."


@dataclass(frozen=True)
class Geometry:
    """Of the impeller: diameters [m] at tip, mean and root of inlet and outlet; edges and height [m]."""

    inlet: tuple[float, float, float]
    outlet: tuple[float, float, float]
    inlet_height: float
    outlet_height: float
    impeller_height: float

    @property
    def inlet_area(self) -> float:
        """A_1m = 2π R_1m l_i [m²] (5.13)."""
        return math.pi * self.inlet[1] * self.inlet_height

    @property
    def outlet_area(self) -> float:
        """A_2m = 2π R_2m l_o [m²] (5.20)."""
        return math.pi * self.outlet[1] * self.outlet_height


@dataclass(frozen=True)
class PumpJet:
    """A designed pump-jet: SI units, angles in radians.

    shaft_power: of (5.12); electric_power: with the motor; inlet, outlet: the velocity triangles of tip, mean
    and root; slip: Stodola's σ of the mean outlet (5.27); vane_angle: β_2 of a vane that makes the head in
    spite of the slip.
    """

    design: PumpJetDesign
    geometry: Geometry
    outlet_speed: float
    flow: float
    head: float
    inlet: tuple[Triangle, Triangle, Triangle]
    outlet: tuple[Triangle, Triangle, Triangle]
    slip: float
    vane_angle: float
    shaft_power: float
    electric_power: float

    @property
    def head_speed(self) -> float:
        """√(2 g H_p) [m/s], which the constants below are made dimensionless by."""
        return math.sqrt(2.0 * GRAVITY * self.head)

    @property
    def specific_speed(self) -> float:
        """N_s = n √Q / H_p^0.75 in rpm, m³/s and m (5.11)."""
        return MINUTE * self.design.revolutions * math.sqrt(self.flow) / self.head**0.75

    @property
    def us_specific_speed(self) -> float:
        """N_s in rpm, US gallons a minute and feet."""
        gallons, feet = self.flow / GALLON_PER_MINUTE, self.head / FOOT
        return MINUTE * self.design.revolutions * math.sqrt(gallons) / feet**0.75

    @property
    def speed_constant(self) -> float:
        """K_u = u_2 / √(2 g H_p)."""
        return self.outlet[1].blade / self.head_speed

    @property
    def head_coefficient(self) -> float:
        """ψ = K_u²/2 = u_2² / (4 g H_p), as table 5.1 has it."""
        return 0.5 * self.speed_constant**2

    @property
    def capacity_constants(self) -> tuple[float, float]:
        """K_m1 and K_m2: c_m / √(2 g H_p) at inlet and outlet."""
        return self.inlet[1].meridian / self.head_speed, self.outlet[1].meridian / self.head_speed

    @property
    def efficient(self) -> bool:
        """Whether β_2 lies in the range that keeps the efficiency (5.3.1)."""
        low, high = OUTLET_ANGLES
        return low <= self.outlet[1].angle <= high


def load_pump_jet(name_or_path: str | Path) -> PumpJetDesign:
    """The pump-jet design of a file; UserError as in `read_design`."""
    return read_design(name_or_path, "pump-jet", PumpJetDesign)


def geometry_of(design: PumpJetDesign) -> Geometry:
    """Diameters and heights scaled from the module's diameter (5.3.1).

    Tip and root lie so that the mean diameter halves the flow: D_m² = (D_t² + D_r²)/2 at the outlet. At the
    inlet the print has D_1r² = D_1t² − 2 D_1m²; D_1t − 2 l_i, the height that (5.13) uses, is the same for
    its ratios and exists for others. UserError where a root or tip does not exist.
    """
    diameter = design.module_diameter
    tip, mean = design.inlet_tip_ratio * diameter, design.inlet_mean_ratio * diameter
    height = design.inlet_height_ratio * diameter
    root = tip - 2.0 * height
    if not 0.0 < root < mean < tip:
        raise UserError(
            f"{design.name}: the inlet's tip, mean and root, {tip:.4g}, {mean:.4g} and {root:.4g} m across, "
            "must descend and be above 0: change inlet_tip_ratio, inlet_mean_ratio or inlet_height_ratio"
        )
    mean_out, tip_out = tip / design.outlet_mean_ratio, tip / design.outlet_tip_ratio
    squared = 2.0 * mean_out**2 - tip_out**2
    if squared <= 0.0:
        raise UserError(
            f"{design.name}: outlet_tip_ratio {design.outlet_tip_ratio:g} leaves no root at the outlet; it "
            f"must be above outlet_mean_ratio / √2 = {design.outlet_mean_ratio / math.sqrt(2.0):.4g}"
        )
    outlet = tip_out, mean_out, math.sqrt(squared)
    if min(outlet) < mean:
        raise UserError(
            f"{design.name}: the outlet, {min(outlet):.4g} m across, is narrower than the inlet's mean, "
            f"{mean:.4g} m; lower outlet_mean_ratio and outlet_tip_ratio"
        )
    impeller = design.impeller_height_ratio * diameter
    return Geometry((tip, mean, root), outlet, height, height * mean_out / tip_out, impeller)


def jet_speed(design: PumpJetDesign) -> float:
    """V_o [m/s] of ρ A_n V_o (V_o − V_i) = T / cos α (5.2, 5.3).

    (5.4) has the cosine on the other side than (5.3) and leaves V_i out; the force along the jet is what the
    momentum theorem gives, and its horizontal part is the thrust.
    """
    along = design.thrust / math.cos(design.nozzle_angle)
    half = 0.5 * design.inlet_speed
    return half + math.sqrt(half**2 + along / (design.water_density * design.nozzle_area))


def pump_head(design: PumpJetDesign, outlet_speed: float) -> float:
    """H_p = ((1 + k_n) V_o² − V_i²) / (2g η_loss) [m] (5.10 with the nozzle's loss of 5.31)."""
    kinetic = (1.0 + design.nozzle_loss) * outlet_speed**2 - design.inlet_speed**2
    return kinetic / (2.0 * GRAVITY * design.loss_efficiency)


def design_pump_jet(design: PumpJetDesign) -> PumpJet:
    """The pump-jet that a design file asks for; UserError where there is none."""
    geometry, speed = geometry_of(design), jet_speed(design)
    flow, head = design.nozzle_area * speed, pump_head(design, speed)
    turning = 2.0 * math.pi * design.revolutions
    radii = 0.5 * geometry.inlet[1], 0.5 * geometry.outlet[1]
    if not design.inlet_whirl < turning * radii[0]:
        raise UserError(
            f"{design.name}: inlet_whirl {design.inlet_whirl:g} m/s is not below the vane's "
            f"{turning * radii[0]:.3g} m/s; lower it or raise revolutions"
        )
    if turning * radii[1] > FASTEST_VANE:
        raise UserError(
            f"{design.name}: the vane moves at {turning * radii[1]:.3g} m/s, at most {FASTEST_VANE:g}; "
            "lower revolutions or module_diameter"
        )
    # Euler's equation with (5.23): g H_p = u_2 c_u2 − u_1 c_u1
    whirl = (GRAVITY * head + turning * radii[0] * design.inlet_whirl) / (turning * radii[1])
    if not 0.0 < whirl < turning * radii[1]:
        least = math.sqrt(GRAVITY * head) / (2.0 * math.pi * radii[1])
        raise UserError(
            f"{design.name}: no solution: a head of {head:.3g} m needs an outlet whirl of {whirl:.3g} m/s, "
            f"but the vane has {turning * radii[1]:.3g} m/s; raise revolutions above {least:.3g} 1/s"
        )
    inlet, outlet = (
        tuple(
            free_vortex_triangle(at, 0.5 * diameter, radius, turning, flow / area, swirl)
            for at, diameter in zip(STREAMLINES, diameters, strict=True)
        )
        for diameters, radius, area, swirl in (
            (geometry.inlet, radii[0], geometry.inlet_area, design.inlet_whirl),
            (geometry.outlet, radii[1], geometry.outlet_area, whirl),
        )
    )
    for triangle in (*inlet, *outlet):
        if triangle.relative_whirl <= 0.0:
            raise UserError(
                f"{design.name}: no solution: at the {triangle.streamline} the water whirls at "
                f"{triangle.whirl:.3g} m/s, its vane at {triangle.blade:.3g} m/s; raise revolutions"
            )
    slip = slip_factor(outlet[1], design.blades)
    if slip * outlet[1].blade <= whirl:
        raise UserError(
            f"{design.name}: no solution: with {design.blades} blades the water slips past them too much (σ "
            f"{slip:.2f}) to make the head, even if they were radial; add blades"
        )
    shaft = design.water_density * GRAVITY * flow * head
    shaft /= design.pump_efficiency * design.mechanical_efficiency * design.rotative_efficiency
    return PumpJet(
        design=design,
        geometry=geometry,
        outlet_speed=speed,
        flow=flow,
        head=head,
        inlet=_three(inlet),
        outlet=_three(outlet),
        slip=slip,
        vane_angle=math.atan2(outlet[1].meridian, outlet[1].blade - whirl / slip),
        shaft_power=shaft,
        electric_power=shaft / design.motor_efficiency,
    )


def _three(triangles: Sequence[Triangle]) -> tuple[Triangle, Triangle, Triangle]:
    tip, mean, root = triangles
    return tip, mean, root


@dataclass(frozen=True)
class Running:
    """The pump-jet at a share of its full revolutions, at rest: SI units."""

    throttle: float
    revolutions: float
    flow: float
    head: float
    thrust: float
    shaft_power: float
    electric_power: float


def running_at(jet: PumpJet, throttle: float) -> Running:
    """The affinity laws: Q ~ n, H and T ~ n², P ~ n³, at the efficiencies of the design point."""
    return Running(
        throttle=throttle,
        revolutions=throttle * jet.design.revolutions,
        flow=throttle * jet.flow,
        head=throttle**2 * jet.head,
        thrust=throttle**2 * jet.design.thrust,
        shaft_power=throttle**3 * jet.shaft_power,
        electric_power=throttle**3 * jet.electric_power,
    )
