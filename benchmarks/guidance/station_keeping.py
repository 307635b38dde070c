"""Hold station with every combination of failed thrusters and write docs/station_keeping.md.

    python -m benchmarks.guidance.station_keeping

Each state is judged beforehand by what its jets can hold, then tried in the compiled simulator: known states
in steady wind, and once more with gusts, seen through GPS, AHRS and the extended Kalman filter.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from swamp_rl.allocation import Jets, jets_of
from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.guidance.holding import RESERVE, Holding, best_holding, holding_at
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

ROOT = Path(__file__).resolve().parents[2]
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
    turned = np.abs((end[:, HEADING] - held.heading + math.pi) % (2 * math.pi) - math.pi)
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
        return keeper.act(at.seen(azimuths.copy()), DT)

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
    """What is said of the chosen heading once the gusts are known."""
    if int(jets.works.sum()) == 1:
        return best_holding(gusty, jets)
    return holding_at(gusty, jets, chosen.heading)


def section(sea: Sea) -> tuple[str, Score, Score]:
    """The text for one sea."""
    fixed, best, known, rough = rows_of(sea)
    heading = ["failed", "margin", "said beforehand", f"farthest in the last {JUDGED:.0f} s"]
    chosen = ["failed", "heading, deg", "margin", "said", "farthest"]
    chosen += ["margin in gusts", "said", "farthest in gusts, by the filter"]
    boat = sea.boat()
    reasons = [
        f"* {', '.join(failed)}: {holding_at(boat, jets_of(boat).without(failed), 0.0).reason}."
        for failed in (("bs",), ("bs", "bp"), ("bs", "bp", "ss"))
    ]
    speed = math.hypot(sea.north, sea.east)
    said = "\n".join(reasons)
    text = f"""## {sea.name.capitalize()}: from the west, current {speed:.2f} m/s and wind {sea.wind:.0f} m/s

Bow held to the north, so across the current:

{table(heading, fixed)}

The bow where the margin is largest:

{table(chosen, best)}

What is said beforehand of three of these states, bow to the north:

{said}
"""
    return text, known, rough


def verdict(score: Score) -> str:
    """How often the promise was right."""
    right = sum(promised == held for promised, held in score)
    broken = sum(promised and not held for promised, held in score)
    cautious = len(score) - right - broken
    return f"right in {right} of {len(score)}, broken in {broken} and too cautious in {cautious}"


def document() -> str:
    """The text of docs/station_keeping.md."""
    found = [section(sea) for sea in SEAS]
    seas = "\n".join(text for text, _, _ in found)
    known, rough = (verdict([one for part in found for one in part[column]]) for column in (1, 2))
    sensors = (
        f"{SENSORS.position} m every {SENSORS.gps_interval} s, {SENSORS.heading} rad and "
        f"{SENSORS.yaw_rate} rad/s every {SENSORS.ahrs_interval} s"
    )
    return f"""# Station keeping with failed thrusters

Written by `python -m benchmarks.guidance.station_keeping`.
SWAMP at full load starts {math.hypot(*OFF[:2]):.1f} m and
{math.degrees(OFF[2]):.0f} deg from its station. The station counts as held if in the last {JUDGED:.0f} of
{SECONDS:.0f} s the boat stays within {RADIUS} m and {math.degrees(TURNED):.0f} deg of it. Two jets or more
are steered by a position loop around a velocity loop (thesis 6.4) and thrust allocation, which where not
all can be had looks after the heading first; the last jet alone by optimal control about the heading at which
current, wind and its own moment cancel, so its heading is not its to choose.

*Margin*: how many times the steady force and moment can be had from the jets that work; {RESERVE:g} is asked
for. It is a cone program over the attainable region, solved before anything moves. With known state and
steady wind the promise was {known}.

The last columns are in gusts of a quarter of the wind's speed, the margin that of a gust of two standard
deviations, the boat seen through a GPS and an AHRS by the extended Kalman filter, which knows neither
current nor wind ({sensors}), one draw of
gusts each.
Held there means within {ROUGH} m and {math.degrees(2 * TURNED * ROUGH):.0f} deg; the promise was {rough}.

{seas}
"""


def main() -> None:
    """Write the document."""
    (ROOT / "docs" / "station_keeping.md").write_text(document(), encoding="utf-8")


if __name__ == "__main__":
    main()
