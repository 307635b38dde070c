"""Which effects a boat can have: what its thrusters can do, and what was tested of it."""

from collections.abc import Iterable

from swamp_rl.boat.drawn import refuse_without_battery
from swamp_rl.boat.propeller_rudder import PropellerRudder
from swamp_rl.boat.resistance import DriftResistance
from swamp_rl.boat.schema import Boat, Thruster
from swamp_rl.effects import Effect
from swamp_rl.errors import UserError

WORDS = {"rudder": "a rudder, of which boat {} has none"}


def able(thruster: Thruster | PropellerRudder, needs: str) -> bool:
    """Whether a thruster can do or has what an effect needs: turn its thrust, push astern, a rudder."""
    turns, astern = thruster.kind != "fixed", thruster.throttle_min < 0.0
    return {"": True, "azimuth": turns, "astern": astern, "rudder": isinstance(thruster, PropellerRudder)}[
        needs
    ]


def refuse_inapplicable(boat: Boat, effects: Iterable[Effect], where: str, counted: bool = False) -> None:
    """UserError that begins with `where` if one of the effects needs tests, a rudder or a battery that the
    boat does not have, or a battery whose charge is not `counted`.
    """
    for effect in effects:
        if effect.battery and not counted:
            raise UserError(
                f"{where}: {effect.name} acts in the episodes of an environment alone, which count the "
                "charge; remove the effect"
            )
        if effect.battery:
            refuse_without_battery(boat, f"{where}: {effect.name}")
        if effect.name == "shallow_water" and isinstance(boat.resistance, DriftResistance):
            raise UserError(
                f"{where}: shallow_water needs the resistance of a towing tank at several depths, but "
                f"boat {boat.name} has coefficients for deep water; remove the effect"
            )
        if effect.needs in WORDS and not any(able(one, effect.needs) for one in boat.thrusters):
            needed = WORDS[effect.needs].format(boat.name)
            raise UserError(f"{where}: {effect.name} needs {needed}; remove the effect")
