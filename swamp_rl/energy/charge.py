"""State of charge, voltage and current of battery packs under a given power."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat.battery import Battery

Array = NDArray[np.float64]


def voltage_at(battery: Battery, charge: Array) -> Array:
    """Voltage [V] V(s) = V_e + (V_f − V_e) s at the state of charge s [1]; any shape."""
    return battery.voltage_empty + (battery.voltage_full - battery.voltage_empty) * charge


def stored_energy(battery: Battery, charge: Array) -> Array:
    """Energy [J] that a pack gives from the state of charge s [1] down to 0; any shape.

    W(s) = C ∫_0^s V ds' = C (V_e s + ½ (V_f − V_e) s²), C [C] the capacity: the drawn charge is ∫ I dt with
    I = P / V.
    """
    slope = battery.voltage_full - battery.voltage_empty
    return np.asarray(battery.capacity * (battery.voltage_empty * charge + 0.5 * slope * charge**2))


def charge_at(battery: Battery, energy: Array) -> Array:
    """State of charge [1] at which a pack still gives `energy` [J]: the inverse of `stored_energy`.

    s = 2 w / (V_e + √(V_e² + 2 (V_f − V_e) w)), w = W / C; 0 where no energy is left.
    """
    w = np.maximum(energy, 0.0) / battery.capacity
    slope = battery.voltage_full - battery.voltage_empty
    return np.asarray(2.0 * w / (battery.voltage_empty + np.sqrt(battery.voltage_empty**2 + 2.0 * slope * w)))


def current_at(battery: Battery, power: Array, charge: Array) -> Array:
    """Current [A] I = P / V(s) of a pack at power P [W] and state of charge s [1]; shapes that broadcast."""
    return np.asarray(power / voltage_at(battery, charge))


class Discharge(NamedTuple):
    """Packs over time: charge, voltage (T + 1, packs) at the rows; power, current (T, packs) between them.

    current [A] is the mean of each interval: the charge that is drawn over its length.
    """

    power: Array
    energy: Array
    charge: Array
    voltage: Array
    current: Array


def discharge(battery: Battery, power: Array, step: float, start: float = 1.0) -> Discharge:
    """Discharge of packs by a power [W] (T, packs), each row held for `step` [s], from a state of charge.

    Exact: s follows from the energy that is left, see `stored_energy`. energy [J] (T + 1, packs) is the sum
    up to each row. A pack that is empty stays at s = 0.
    """
    drawn = np.cumsum(np.vstack([np.zeros((1, power.shape[1])), power * step]), axis=0)
    charge = charge_at(battery, stored_energy(battery, np.array(start)) - drawn)
    current = -np.diff(charge, axis=0) * battery.capacity / step
    return Discharge(power, drawn, charge, voltage_at(battery, charge), current)
