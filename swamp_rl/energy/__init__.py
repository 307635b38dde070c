"""Electric power of the thrusters, charge of the batteries, and missions by them."""

from swamp_rl.boat.drawn import missing
from swamp_rl.energy.charge import Discharge, charge_at, current_at, discharge, stored_energy, voltage_at
from swamp_rl.energy.power import pack_power, range_left, thrust_left, thruster_power

__all__ = [
    "Discharge",
    "charge_at",
    "current_at",
    "discharge",
    "missing",
    "pack_power",
    "range_left",
    "stored_energy",
    "thrust_left",
    "thruster_power",
    "voltage_at",
]
