"""What an episode cost: path, smoothness of the commands and energy of the jets, for one run or a batch."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder, Thruster
from swamp_rl.boat.estimate_drive import WIDEST_SCREW

Array = NDArray[np.float64]


def path_length(pose: Array) -> Array:
    """Length of the track [m]: `pose` (..., T, 3) with north and east first -> (...)."""
    steps = np.diff(pose[..., :2], axis=-2)
    return np.hypot(steps[..., 0], steps[..., 1]).sum(axis=-1)


def command_change(commands: Array) -> Array:
    """Mean change of the levers per step [1]: `commands` (..., T, 2) = throttle, angle -> (...).

    The change of a step is |Δthrottle| + |Δangle|, both as fractions of full lever; a smooth hand keeps it
    small. Only commands given at the same rate compare. Fewer than two steps have changed nothing: 0.
    """
    if commands.shape[-2] < 2:
        return np.zeros(commands.shape[:-2])
    return np.abs(np.diff(commands, axis=-2)).sum(axis=-1).mean(axis=-1)


def jet_areas(boat: Boat, thrusters: Sequence[Thruster | PropellerRudder] | None = None) -> Array:
    """(K,) cross-section [m²] of each thruster's jet; thrusters: some of the boat's, all by default.

    Of a jet the nozzle's; of a propeller half its disc, to which the wake of a disc at rest contracts
    (momentum theory). Where the boat file has neither, that of a propeller of `WIDEST_SCREW` times the
    draught is assumed.
    """
    areas = []
    for thruster in boat.thrusters if thrusters is None else thrusters:
        if isinstance(thruster, Thruster) and thruster.nozzle_area > 0.0 and thruster.propeller is None:
            areas.append(thruster.nozzle_area)
            continue
        screw = thruster.propeller
        diameter = WIDEST_SCREW * boat.draught if screw is None else screw.diameter
        areas.append(0.125 * math.pi * diameter**2)
    return np.array(areas)


def jet_power(thrust: Array, water_density: float, area: Array | float) -> Array:
    """Kinetic power [W] that jets of the given bollard thrust [N] leave in the water; any shape.

    area [m²]: of their cross-sections, see `jet_areas`.
    By momentum T = ρ A_n V_o² the jet leaves at V_o = √(T / (ρ A_n)) and carries ½ ρ A_n V_o³ = ½ T V_o.
    At full throttle (12.2 N) that is 22 W, where the motor took 97 W (the pump-jet article, figure 21); what
    the battery gives is `swamp_rl.energy.pack_power`.
    """
    force = np.abs(thrust)
    return 0.5 * force * np.sqrt(force / (water_density * area))


def bollard_thrust(throttle: Array, linear: Array, quadratic: Array) -> Array:
    """Thrust [N] at zero speed of thrusters with throttle (..., K) and curves linear, quadratic (K,)."""
    return linear * throttle + quadratic * throttle * np.abs(throttle)
