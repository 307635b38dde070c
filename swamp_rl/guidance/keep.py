"""Station keeping for whatever drives the boat: the controller that fits, or the reason why there is none."""

from collections.abc import Collection

from swamp_rl.allocation import Jets
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.drive import Drive, drive_of
from swamp_rl.guidance.holding import Holding, best_holding, holding_at
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
        raise UserError(f"{held.reason}; choose another heading or place, or use more jets")
    if alone:
        return OneJetKeeper(boat, drive, place, held), held
    station = Station(*place, held.heading)
    return StationKeeper(drive, servo_of(boat), station, length=boat.length), held


def weathervane(boat: Boat, drive: Drive, place: tuple[float, float]) -> tuple[WeathervaneKeeper, Holding]:
    """The controller with the bow in the weather; UserError where none pushes the boat, or too hard."""
    held = weather_heading(boat, drive)
    if held.margin == 0.0:
        raise UserError(
            f"boat {boat.name} has no sway force and holds only with its bow in a current or wind "
            "that it can stem; there is none here"
        )
    if not held.holds:
        raise UserError(f"{held.reason}; choose another place")
    return WeathervaneKeeper(drive, servo_of(boat), place, held.heading, boat.length), held


def drive_without(boat: Boat, failed: Collection[str]) -> Drive:
    """What drives the boat less thrusters that failed; UserError for unknown ones, and for propellers."""
    drive = drive_of(boat)
    if not failed:
        return drive
    if not isinstance(drive, Jets):
        raise UserError(f"boat {boat.name}: --failed serves boats with jets alone; leave it out")
    return drive.without(failed)
