"""Hold station with every combination of failed thrusters: the tables of docs/station_keeping.md.

    python -m benchmarks.guidance.station_keeping

Each state is judged beforehand by what its jets can hold, then tried in the compiled simulator: known states
in steady wind, and once more with gusts, seen through GPS, AHRS and the extended Kalman filter.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.allocation import Jets, jets_of
from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.guidance.holding import Holding, best_holding, holding_at
from swamp_rl.guidance.loop import Controller, drive
from swamp_rl.guidance.one_jet import OneJetKeeper
from swamp_rl.guidance.servo import VelocityServo, inertia_of
from swamp_rl.guidance.station import Station, StationKeeper
from swamp_rl.navigation.filter import START, WITH_MODEL, Navigator
from swamp_rl.navigation.predict import STATES, BoatModel
from swamp_rl.navigation.sensors import Sensors
from swamp_rl.navigation.simulated import navigate
from swamp_rl.simulator.state import EAST, HEADING, NORTH

Array = NDArray[np.float64]
Score = list[tuple[bool, bool]]

RADIUS, TURNED = 0.5, math.radians(10)  # m and rad within which the station counts as held
ROUGH = 1.5  # m, the same in gusts and seen through the filter
SECONDS, JUDGED, DT = 90.0, 30.0, 0.2
OFF = (0.5, -0.5, 0.3)  # m, m, rad from the station at the start
SENSORS = Sensors()
SAID = {True: "holds", False: "cannot"}


@dataclass(frozen=True)
class Sea:
    """Current towards north and east [m/s], mean wind [m/s] and where it comes from [deg]."""

    name: str
    north: float
    east: float
    wind: float
    wind_from: float

    def boat(self, gusts: bool = False) -> Boat:
        """SWAMP in this sea."""
        boat = load_boat("swamp")
        given = [
            {"effect": "current", "north": self.north, "east": self.east},
            {"effect": "wind", "speed": self.wind, "from": math.radians(self.wind_from)},
        ]
        if gusts:
            given.append({"effect": "gusts", "speed_std": 0.25 * self.wind, "direction_std": 0.2})
        return boat.model_copy(
            update={"effects": tuple(parse_effects(given, self.name, boat.thruster_names))}
        )


SEAS = (Sea("moderate", 0.0, 0.2, 4.0, 270.0), Sea("strong", 0.0, 0.35, 6.0, 270.0))


def keeper_of(boat: Boat, jets: Jets, held: Holding) -> Controller:
    """One jet alone where it can hold, else the velocity loop with whatever jets there are."""
    if int(jets.works.sum()) == 1 and held.holds:
        return OneJetKeeper(boat, jets, (0.0, 0.0), held)
    return StationKeeper(jets, VelocityServo(inertia_of(boat)), Station(0.0, 0.0, held.heading))


def strayed(track: Array, held: Holding, one_jet: bool) -> tuple[float, float]:
    """Farthest [m] and most turned away [rad] at the end; the last jet's heading is its own affair."""
    end = track[-round(JUDGED / DT) :]
    turned = np.abs(wrapped(end[:, HEADING] - held.heading))
    return float(np.hypot(end[:, NORTH], end[:, EAST]).max()), 0.0 if one_jet else float(turned.max())


def tried(sea: Sea, failed: Sequence[str], held: Holding) -> tuple[float, float]:
    """As `strayed`, with a perfect navigator in steady wind."""
    boat = sea.boat()
    jets = jets_of(boat).without(failed)
    pose = (OFF[0], OFF[1], held.heading + OFF[2])
    track = drive(boat, keeper_of(boat, jets, held), pose, SECONDS, DT, failed=failed)
    return strayed(track, held, int(jets.works.sum()) == 1)


def tried_by_filter(sea: Sea, failed: Sequence[str], held: Holding) -> tuple[float, float]:
    """As `strayed`, in gusts and seen through the filter, which knows neither current nor wind."""
    boat, calm = sea.boat(gusts=True), load_boat("swamp")
    dead = [{"effect": "thruster_failure", "thruster": name, "time": 0.0} for name in failed]
    effects = boat.effects + tuple(parse_effects(dead, "benchmark", boat.thruster_names))
    broken = boat.model_copy(update={"effects": effects})
    jets = jets_of(calm).without(failed)
    keeper = keeper_of(sea.boat(), jets, held)
    start = np.array([OFF[0], OFF[1], held.heading + OFF[2]])
    x = np.concatenate([start, np.zeros(STATES - 3)])
    model = calm.model_copy(update={"effects": effects[len(boat.effects) :]})
    navigator = Navigator(BoatModel(model), x, WITH_MODEL, np.diag(START**2))

    def commands(time: float, at: Navigator, azimuths: Array) -> Array:
        return keeper.act(at.seen(time, azimuths.copy()), DT)

    run = navigate(broken, navigator, SENSORS, commands, SECONDS, np.random.default_rng(0), DT, pose=start)
    return strayed(run.truth, held, int(jets.works.sum()) == 1)


def states() -> list[tuple[str, ...]]:
    """Nothing failed, then any one, two and three thrusters."""
    names = load_boat("swamp").thruster_names
    return [failed for count in range(4) for failed in itertools.combinations(names, count)]


def holds(result: tuple[float, float], radius: float = RADIUS) -> bool:
    """Whether the station was held."""
    return result[0] <= radius and result[1] <= 2 * TURNED * radius


def cell(result: tuple[float, float]) -> str:
    """Distance, and the heading's error where it was lost."""
    turned = f", turned {math.degrees(result[1]):.0f} deg" if result[1] > TURNED else ""
    return f"{result[0]:.2f} m{turned}"


def rows_of(sea: Sea) -> tuple[list[list[str]], list[list[str]], Score, Score]:
    """Table rows at the set heading and at the best one, and (promised, held): known state, gusts."""
    fixed, best, known, rough = [], [], [], []
    boat, gusty = sea.boat(), sea.boat(gusts=True)
    for failed in states():
        jets = jets_of(boat).without(failed)
        name = ", ".join(failed) or "none"
        set_heading, chosen = holding_at(boat, jets, 0.0), best_holding(boat, jets)
        blown = margin_in_gusts(gusty, jets, chosen)
        first, second = tried(sea, failed, set_heading), tried(sea, failed, chosen)
        third = tried_by_filter(sea, failed, chosen)
        known += [(set_heading.holds, holds(first)), (chosen.holds, holds(second))]
        rough.append((blown.holds, holds(third, ROUGH)))
        heading = f"{math.degrees(chosen.heading) % 360:.0f}"
        fixed.append([name, f"{set_heading.margin:.2f}", SAID[set_heading.holds], cell(first)])
        row = [name, heading, f"{chosen.margin:.2f}", SAID[chosen.holds], cell(second)]
        best.append([*row, f"{blown.margin:.2f}", SAID[blown.holds], cell(third)])
        print(sea.name, fixed[-1], best[-1], flush=True)
    return fixed, best, known, rough


def margin_in_gusts(gusty: Boat, jets: Jets, chosen: Holding) -> Holding:
    """Result for the chosen heading once the gusts are known."""
    if int(jets.works.sum()) == 1:
        return best_holding(gusty, jets)
    return holding_at(gusty, jets, chosen.heading)


def promises_row(name: str, score: Score) -> list[str]:
    """How often what was predicted was right."""
    right = sum(promised == held for promised, held in score)
    broken = sum(promised and not held for promised, held in score)
    return [name, str(len(score)), str(right), str(broken), str(len(score) - right - broken)]


def main() -> None:
    """Write the tables."""
    heading = ["failed", "margin", "predicted", f"greatest offset in the last {JUDGED:.0f} s"]
    chosen = ["failed", "heading, deg", "margin", "predicted", "greatest offset"]
    chosen += ["margin in gusts", "predicted", "greatest offset in gusts, by the filter"]
    parts: dict[str, str] = {}
    known: Score = []
    rough: Score = []
    for sea in SEAS:
        fixed, best, in_calm, in_gusts = rows_of(sea)
        parts[f"{sea.name}, bow north"] = table(heading, fixed)
        parts[f"{sea.name}, best bow"] = table(chosen, best)
        known += in_calm
        rough += in_gusts
    rows = [promises_row("known state, steady wind", known), promises_row("gusts, by the filter", rough)]
    heads = ["", "cases", "right", "predicted to hold, lost", "predicted to fail, held"]
    write_parts(DOCS / "station_keeping.md", parts | {"promises": table(heads, rows)})


if __name__ == "__main__":
    main()
