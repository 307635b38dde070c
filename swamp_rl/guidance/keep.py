"""Station keeping for whatever drives the boat: the controller that fits, or the reason why there is none."""

from collections.abc import Collection

from swamp_rl.allocation import Jets
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.drive import Drive, drive_of
from swamp_rl.guidance.holding import Holding, best_holding, holding_at, steady_force
from swamp_rl.guidance.one_jet import OneJetKeeper
from swamp_rl.guidance.servo import servo_of
from swamp_rl.guidance.station import Station, StationKeeper
from swamp_rl.guidance.weathervane import WeathervaneKeeper, pushes_sideways, weather_heading

Keeper = StationKeeper | OneJetKeeper | WeathervaneKeeper


def keeper_for(
    boat: Boat, drive: Drive, place: tuple[float, float], heading: float | None = None
) -> tuple[Keeper, Holding]:
    """Who holds `place` [m], and the balance that this rests on; UserError with the reason if no one can.

    boat: with the current and wind that are believed in its effects. heading [rad]: where the bow shall
    point; the one with the greatest margin if not given. UserError where the drive leaves no choice: one jet
    lies where its moment balances, a drive without sway force with the bow in the weather.
    """
    working = int(drive.works.sum()) if isinstance(drive, Jets) else len(drive.names)
    alone = isinstance(drive, Jets) and working == 1
    forced = bool(working) and not alone and not pushes_sideways(drive)
    if heading is not None and (alone or forced):
        has = "one working jet" if alone else "no sway force"
        raise UserError(
            f"boat {boat.name} has {has}: current and wind set the heading at which it can keep "
            "station; leave the heading out"
        )
    if forced:
        return weathervane(boat, drive, place)
    assert isinstance(drive, Jets)
    held = best_holding(boat, drive) if heading is None else holding_at(boat, drive, heading)
    if not held.holds:
        raise UserError(f"{held.reason}; {_advice(drive, heading is not None)}")
    if alone:
        return OneJetKeeper(boat, drive, place, held), held
    station = Station(*place, held.heading)
    return StationKeeper(drive, servo_of(boat), station, length=boat.length), held


def _advice(jets: Jets, chosen: bool) -> str:
    """What helps a boat that cannot hold with these jets, at a heading that was chosen or at its best."""
    if int(jets.works.sum()) == 1:
        return "use a second thruster: one alone holds only where the force that is needed passes through it"
    if chosen:
        return "choose another heading"
    more = "" if jets.works.all() else ", or use more thrusters"
    return f"choose a place with less current and wind{more}"


def weathervane(boat: Boat, drive: Drive, place: tuple[float, float]) -> tuple[WeathervaneKeeper, Holding]:
    """The controller with the bow in the weather; UserError where none pushes the boat, or too hard."""
    held = weather_heading(boat, drive)
    if held is None or not held.holds:
        pushed = any(steady_force(boat, heading).any() for heading in (0.0, 1.0))
        why = "; there is none here"
        if held is not None:
            why = f", which set the heading; {held.reason}"
        elif pushed:
            why = "; these oppose each other here, and at no heading push it straight astern"
        raise UserError(
            f"boat {boat.name} has no sway force and holds only with its bow in a current or wind that it "
            f"can stem{why}"
        )
    return WeathervaneKeeper(drive, servo_of(boat), place, held.heading, boat.length), held


def drive_without(boat: Boat, failed: Collection[str]) -> Drive:
    """What drives the boat less thrusters that failed; UserError for unknown ones, and for propellers."""
    drive = drive_of(boat)
    if not failed:
        return drive
    if not isinstance(drive, Jets):
        raise UserError(f"boat {boat.name}: --failed serves boats with jets alone; leave it out")
    return drive.without(failed)
