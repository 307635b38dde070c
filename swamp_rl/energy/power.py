"""Electric power of each thruster and of each battery pack, from what the actuators do."""

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.drawn import full_power, refuse_without_battery
from swamp_rl.energy.charge import stored_energy, voltage_at

Array = NDArray[np.float64]


def thruster_power(boat: Boat, throttle: Array, left: Array | float = 1.0) -> Array:
    """Electric power [W] (..., K) at throttles [1] (..., K), by `swamp_rl.boat.drawn.full_power`.

    throttle: revolutions [rps] for a propeller with a rudder; left: what the voltage leaves of the thrust at
    rest (..., K), 1 at the voltage of a full pack. The power is a function of the throttle alone: the sources
    measure it on the bollard (thesis 5.5.2, figures 5.32, 5.33), and none of them under way. UserError where
    the boat file lacks a key.
    """
    refuse_without_battery(boat)
    share = np.broadcast_to(left, np.shape(throttle))
    powers = [
        full_power(thruster, throttle[..., k], boat.water_density, share[..., k])
        for k, thruster in enumerate(boat.thrusters)
    ]
    return np.stack(powers, axis=-1)


def thrust_left(boat: Boat, charge: Array) -> Array:
    """Share [1] (..., K) that the packs' voltages leave of each thruster's thrust, (V(s) / V_f)^e.

    charge: state of charge s of each pack (..., packs). A thruster on the centre line has the mean of both;
    an empty pack gives nothing.
    """
    refuse_without_battery(boat)
    assert boat.battery is not None
    ratio = voltage_at(boat.battery, charge) / boat.battery.voltage_full
    of_pack = np.where(charge > 0.0, ratio**boat.battery.thrust_exponent, 0.0)
    return _sum(of_pack, shares(boat).T)


def pack_names(boat: Boat) -> tuple[str, ...]:
    """Names of the packs in the order of every array of packs."""
    return ("battery",) if boat.battery is None or boat.battery.packs == 1 else ("starboard", "port")


def shares(boat: Boat) -> Array:
    """Share (K, packs) of each thruster's power that each pack gives: by the side on which it stands."""
    y = np.array([thruster.y for thruster in boat.thrusters])
    if boat.battery is None or boat.battery.packs == 1:
        return np.ones((len(y), 1))
    starboard = 0.5 * (1.0 + np.sign(y))
    return np.stack([starboard, 1.0 - starboard], axis=1)


def pack_power(boat: Boat, throttle: Array, left: Array | float = 1.0) -> Array:
    """Power [W] (..., packs) drawn from each pack at throttles [1] (..., K), its hotel load included.

    left: as in `thruster_power`. UserError where the boat file lacks a key.
    """
    return supplied(boat, thruster_power(boat, throttle, left))


def supplied(boat: Boat, power: Array) -> Array:
    """Power [W] (..., packs) that each pack gives for the thrusters (..., K) [W] and its hotel load."""
    of_thrusters = _sum(power, shares(boat))
    return np.asarray(of_thrusters + (boat.battery.hotel_power if boat.battery else 0.0))


def _sum(values: Array, weights: Array) -> Array:
    """values (..., m) times weights (m, n), summed in order, so that a row has the same bits in any batch."""
    return np.asarray(sum(values[..., i, None] * weights[i] for i in range(len(weights))))


def range_left(boat: Boat, used: Array, length: Array, start: float | Array = 1.0) -> Array:
    """Distance [m] (...) that is left above the reserve after a track, at the energy per metre of that track.

    used: energy [J] (..., packs) drawn so far; length [m] (...) of the track; start: state of charge [1] at
    its beginning, a number or (..., packs). The pack that comes first to its reserve decides. 0 beyond the
    reserve, not a number without way.
    """
    refuse_without_battery(boat)
    assert boat.battery is not None
    reserve = stored_energy(boat.battery, np.array(1.0 - boat.battery.depth_of_discharge))
    left = stored_energy(boat.battery, np.array(start)) - used - reserve
    with np.errstate(divide="ignore", invalid="ignore"):
        multiple = np.where(used > 0.0, np.maximum(left, 0.0) / used, np.inf).min(axis=-1)
        return np.asarray(np.where(length > 0.0, multiple * length, np.nan))
