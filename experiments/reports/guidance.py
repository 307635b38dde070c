"""A followed path or a held station: its run as a dataset, with a report, JSON, CSV and a figure."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table
from swamp_rl.experiments.reports.guidance_figures import draw_station, draw_track
from swamp_rl.experiments.reports.rows import write_rows

from swamp_rl.boat import Boat, load_boat
from swamp_rl.clipped import in_markdown
from swamp_rl.constants import SWAMP_LENGTH
from swamp_rl.energy import missing, pack_power
from swamp_rl.errors import UserError
from swamp_rl.guidance.curve import Curve, joined
from swamp_rl.guidance.curve_following import BehindVehicle, CurveFollower, Pace, SteadyPace
from swamp_rl.guidance.drive import drive_of
from swamp_rl.guidance.flight import STEP, Flight, flown, in_sea
from swamp_rl.guidance.keep import drive_without, keeper_for
from swamp_rl.guidance.path_file import load_path, speeds_of, spline
from swamp_rl.guidance.places import LONGEST
from swamp_rl.guidance.servo import servo_of
from swamp_rl.guidance.track_errors import along_and_across, spread, station_errors
from swamp_rl.runs import DatasetMeta, append_run, dataset_beside, read_run
from swamp_rl.runs.schema import ANALYSIS, meta_of
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.state import ACTUATORS, EAST, HEADING, NORTH, SURGE, SWAY

Array = NDArray[np.float64]

NOTES = "Guidance of swamp_rl in closed loop on its own simulator; no measured data."
PATIENCE, STARTING = 3.0, 60.0  # multiple of a path's time at its speed, and s more
SETTLING = 0.25  # share of a station's time that is left out of its figures
HELD_LENGTHS, HELD_TURN = 1.0, math.radians(30.0)  # of a station that is held, for 95 % of the time
UNITS = {"cross_track_error": "m", "distance": "m", "heading_error": "rad", "gap_error": "m"}


def follow_path(
    out: Path, name: str, boat_name: str, level: str | None, sea: list[dict[str, Any]], seed: int
) -> list[str]:
    """Follow a path file and write the folder; lines to print. UserError for what the boat cannot do."""
    path, file = load_path(name)
    boat, curve = load_boat(boat_name), path.curve()
    pace = SteadyPace(speeds_of(path, reference_of(boat).speed, file), curve.length)
    longest = PATIENCE * curve.length / path.speed + STARTING * (boat.length / SWAMP_LENGTH) ** 0.5
    result = {
        "what": "path",
        "name": path.name,
        "path": path.model_dump(mode="json"),
        "path_length": curve.length,
    }
    return _followed(out, boat, boat_name, curve, pace, longest, level, sea, seed, result)


def follow_leader(
    out: Path,
    file: Path,
    behind: float,
    boat_name: str,
    level: str | None,
    sea: list[dict[str, Any]],
    seed: int,
) -> list[str]:
    """Follow the vehicle of a run and write the folder; lines to print."""
    boat, leader = load_boat(boat_name), read_run(file)
    if not 0.0 < behind < math.inf:
        raise UserError(f"--behind {behind:g}: must be a distance above 0 m")
    curve, time, way = way_of(leader.time, leader.stacked(("north", "east")), boat.length, file)
    if curve.length <= behind:
        raise UserError(f"--behind {behind:g}: {file} is {curve.length:.3g} m long; follow more closely")
    pace = BehindVehicle(time, way, behind, reference_of(boat).speed)
    note = too_fast(pace, boat.length)
    longest = min(PATIENCE * float(time[-1]) + STARTING, LONGEST)
    target = {"what": "vehicle", "name": leader.name, "behind": behind, "path_length": curve.length}
    target |= {"note": note} if note else {}
    return _followed(out, boat, boat_name, curve, pace, longest, level, sea, seed, target)


def too_fast(pace: BehindVehicle, length: float) -> str:
    """A note for a vehicle that outruns a boat of that length [m] by more than half of it; else nothing."""
    lost, speed = pace.outrun()
    if lost <= 0.5 * length:
        return ""
    return (
        f"note: the vehicle moves at {speed:.3g} m/s, above {pace.fastest:.3g} m/s, the boat's top speed in "
        f"still water; the boat falls about {lost:.2g} m behind"
    )


def way_of(time: Array, places: Array, length: float, file: object) -> tuple[Curve, Array, Array]:
    """A spline through a vehicle's places (T, 2), half a length of the follower apart, and how far along it
    the vehicle had come [m] at its times [s] since the first; UserError for a vehicle that hardly moved."""
    kept = [0]
    for i in range(1, len(places)):
        if math.dist(places[i], places[kept[-1]]) >= 0.5 * length:
            kept.append(i)
    if len(kept) < 4:
        raise UserError(f"{file}: its vehicle moves less than two lengths of the boat; no path to follow")
    curve = joined([spline(places[kept], str(file))])
    way = along_and_across(curve, _as_states(places), length)[:, 0]
    return curve, time - time[0], way


def _as_states(places: Array) -> Array:
    states = np.zeros((len(places), HEADING + 1))
    states[:, [NORTH, EAST]] = places
    return states


def _followed(
    out: Path,
    boat: Boat,
    boat_name: str,
    curve: Curve,
    pace: Pace,
    longest: float,
    level: str | None,
    sea: list[dict[str, Any]],
    seed: int,
    target: dict[str, Any],
) -> list[str]:
    at_sea, offset, drawn = in_sea(boat, level, sea, seed)
    follower = CurveFollower(drive_of(boat), servo_of(boat), curve, pace, boat.length)
    north, east = curve.places[0] + offset[:2]
    with dataset_beside(out, _meta(boat, boat_name)) as part:
        pose = (float(north), float(east), float(curve.course[0] + offset[2]))
        flight = flown(at_sea, follower, pose, longest, seed)
        track = along_and_across(curve, flight.track, boat.length)
        result = target | _common(flight, seed, drawn) | {"cross_track_error": spread(track[:, 1])}
        if isinstance(pace, BehindVehicle):
            gap = np.array([pace.known(t) for t in flight.time]) - track[:, 0] - pace.behind
            moving = np.array([pace.known(t) > pace.behind for t in flight.time])
            result["gap_error"] = spread(gap[moving]) if moving.any() else None
        append_run(part, flight.run(target["what"], seed, drawn, {"guidance": target["what"]}))
        (part / ANALYSIS).mkdir()
        draw_track(part / ANALYSIS / "track.png", flight, curve, track[:, 1], _title(boat, target))
        _write(part / ANALYSIS, result, flight, {"along": track[:, 0], "across": track[:, 1]})
    return lines(result)


def hold_station(
    out: Path,
    boat_name: str,
    duration: float,
    heading: float | None,
    failed: list[str],
    level: str | None,
    sea: list[dict[str, Any]],
    seed: int,
) -> list[str]:
    """Hold a station and write the folder; lines to print. UserError with the reason where it cannot be."""
    boat = load_boat(boat_name)
    drive = drive_without(boat, failed)
    dead = [{"effect": "thruster_failure", "thruster": name, "time": 0.0} for name in failed]
    at_sea, offset, drawn = in_sea(boat, level, [*sea, *dead], seed)
    keeper, balance = keeper_for(at_sea, drive, (0.0, 0.0), heading)
    pose = (float(offset[0]), float(offset[1]), float(balance.heading + offset[2]))
    with dataset_beside(out, _meta(boat, boat_name)) as part:
        flight = flown(at_sea, Timed(keeper, duration), pose, duration, seed)
        away, turned = station_errors(flight.track, (0.0, 0.0), balance.heading)
        late = flight.time >= SETTLING * duration
        own = {
            "what": "station",
            "name": "station",
            "keeper": type(keeper).__name__,
            "heading": balance.heading,
            "margin": min(balance.margin, 1000.0),
            "failed": failed,
            "balance": balance.reason,
        }
        result = own | _common(flight, seed, drawn)
        result |= {"distance": spread(away[late]), "heading_error": spread(turned[late])}
        result |= {"held": is_held(result, boat.length)}
        append_run(part, flight.run("station", seed, drawn, {"guidance": "station"}))
        (part / ANALYSIS).mkdir()
        draw_station(part / ANALYSIS / "track.png", flight, away, turned, _title(boat, own))
        _write(part / ANALYSIS, result, flight, {"distance": away, "heading_error": turned})
    return [balance.reason, *lines(result)]


def is_held(result: dict[str, Any], length: float) -> bool:
    """Whether a boat of that length [m] was within a length of its station and 30 deg of its heading."""
    distance, turned = (result[name]["quantile_95"] for name in ("distance", "heading_error"))
    return bool(distance <= HELD_LENGTHS * length and turned <= HELD_TURN)


class Timed:
    """A controller that is over after `duration` [s]."""

    def __init__(self, controller: Any, duration: float) -> None:
        self.controller, self.duration, self.over = controller, duration, False

    def act(self, seen: Any, dt: float) -> Array:
        """As the controller does."""
        self.over = seen.time >= self.duration - 0.5 * dt
        return np.asarray(self.controller.act(seen, dt), dtype=np.float64)


def _meta(boat: Boat, boat_name: str) -> DatasetMeta:
    return meta_of(boat, boat_name, 1.0 / STEP, "simulated", notes=NOTES)


def _title(boat: Boat, goal: dict[str, Any]) -> str:
    what = goal["what"].capitalize()
    return f"{what} of {boat.name}" if what == "Station" else f"{what} {goal['name']} of {boat.name}"


def _common(flight: Flight, seed: int, drawn: list[dict[str, Any]]) -> dict[str, Any]:
    """Result of every flight: end, time, way, speed and energy."""
    steps = np.hypot(*np.diff(flight.track[:, [NORTH, EAST]], axis=0).T)
    speed = np.hypot(flight.track[:, SURGE], flight.track[:, SWAY])
    return {
        "boat": flight.boat.name,
        "source": "simulated",
        "completed": flight.completed,
        "seed": seed,
        "disturbances": drawn,
        "time": float(flight.time[-1]),
        "way": float(steps.sum()),
        "mean_speed": float(speed.mean()),
        "electric_energy": electric_energy(flight),
    }


def electric_energy(flight: Flight) -> float | None:
    """Energy [J] of all packs with the hotel load; None where the boat file has no battery or power curve."""
    if missing(flight.boat) is not None:
        return None
    throttle = flight.track[1:, ACTUATORS + len(flight.boat.thrusters) :]
    return float(pack_power(flight.boat, throttle).sum() * STEP)


def _write(folder: Path, result: dict[str, Any], flight: Flight, extra: dict[str, Array]) -> None:
    content = {
        "units": UNITS | {"time": "s", "way": "m", "mean_speed": "m/s", "electric_energy": "J"}
    } | result
    (folder / "result.json").write_text(json.dumps(content, indent=1, allow_nan=False), encoding="utf-8")
    columns = [flight.time, *flight.track[:, [NORTH, EAST, HEADING]].T, *extra.values()]
    write_rows(folder / "track.csv", ["time", "north", "east", "heading", *extra], np.stack(columns, axis=1))
    body = "\n".join(f"* {in_markdown(line)}" for line in lines(result))
    what = result["what"].capitalize() + f" {result['name']}" * (result["what"] != "station")
    text = f"# {in_markdown(what)}, {in_markdown(result['boat'])}\n\nSimulated.\n\n{body}\n\n"
    (folder / "report.md").write_text(
        f"{text}{error_table(result)}\n\n![track](track.png)\n", encoding="utf-8"
    )


def error_table(result: dict[str, Any]) -> str:
    """Mean, rms, 95 % and greatest error."""
    rows = [
        [f"{name.replace('_', ' ')}, {unit}", *(f"{value:.3f}" for value in result[name].values())]
        for name, unit in UNITS.items()
        if result.get(name)
    ]
    return table(["error", "mean", "rms", "95 %", "max"], rows)


def lines(result: dict[str, Any]) -> list[str]:
    """What the command line prints."""
    found = [f"{result['time']:.1f} s, {result['way']:.1f} m over ground"]
    if not result["completed"]:
        found.append("the end of the path was not reached in time")
    if result.get("note"):
        found.append(result["note"])
    for name, unit in UNITS.items():
        if result.get(name):
            e, scale = result[name], 180.0 / math.pi if unit == "rad" else 1.0
            values = ", ".join(
                f"{word} {scale * e[key]:.2f}"
                for word, key in (("mean", "mean"), ("rms", "rms"), ("95 %", "quantile_95"), ("max", "max"))
            )
            found.append(f"{name.replace('_', ' ')} [{'deg' if unit == 'rad' else unit}]: {values}")
    energy = result["electric_energy"]
    found.append("energy: the boat file has no battery" if energy is None else f"energy: {energy:.0f} J")
    if "held" in result:
        bound = f"a boat length of the station and {math.degrees(HELD_TURN):.0f} deg of the heading"
        verdict = "held: for" if result["held"] else "not held: for less than"
        found.append(f"{verdict} 95 % of the time within {bound}")
    return found
