"""The boat file: what a boat is, each number with its unit, provenance and source."""

from swamp_rl.boat.battery import Battery
from swamp_rl.boat.load import load_boat
from swamp_rl.boat.propeller_rudder import PropellerRudder
from swamp_rl.boat.quantity import Provenance
from swamp_rl.boat.schema import Boat, Thruster

__all__ = ["Battery", "Boat", "PropellerRudder", "Provenance", "Thruster", "load_boat"]
