"""Station keeping for whatever jets still work: the controller that fits, or the reason why there is none."""

from swamp_rl.allocation import Jets
from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.guidance.holding import Holding, best_holding, holding_at
from swamp_rl.guidance.one_jet import OneJetKeeper
from swamp_rl.guidance.servo import servo_of
from swamp_rl.guidance.station import Station, StationKeeper


def keeper_for(
    boat: Boat, jets: Jets, place: tuple[float, float], heading: float | None = None
) -> tuple[StationKeeper | OneJetKeeper, Holding]:
    """Who holds `place` [m], and the balance that this rests on; UserError with the reason if no one can.

    boat: with the current and wind that are believed in its effects. heading [rad]: where the bow shall
    point; the one with the greatest margin if not given, and always for the last jet.
    """
    alone = int(jets.works.sum()) == 1
    held = best_holding(boat, jets) if heading is None or alone else holding_at(boat, jets, heading)
    if not held.holds:
        raise UserError(f"{held.reason}; choose another heading or place, or use more jets")
    if alone:
        return OneJetKeeper(boat, jets, place, held), held
    station = Station(*place, held.heading)
    return StationKeeper(jets, servo_of(boat), station, length=boat.length), held
