"""Messages to the page: plain JSON, SI units, angles in rad."""

import json
import math
from typing import Any

from swamp_rl.physics.motion import current_at
from swamp_rl.runs import Run
from swamp_rl.simulator.state import NORTH, SURGE, TIME, YAW_RATE
from swamp_rl.teleop.craft import actuators
from swamp_rl.teleop.rows import MOTION, disturbed, largest_difference
from swamp_rl.teleop.session import RUN, Session

DIGITS = 5


def scene(session: Session, source: str) -> dict[str, Any]:
    """What changes with the boat only: course, boat, and what there is to choose from."""
    boat, course = session.boat.boat, session.boat.course
    return {
        "type": "scene",
        "course": {
            "name": course.name,
            "gates": [
                {
                    "name": gate.name,
                    "heading": gate.heading,
                    "centre": [gate.centre.north, gate.centre.east],
                    "buoys": [[buoy.north, buoy.east] for buoy in gate.buoys],
                }
                for gate in course.gates
            ],
            "bounds": course.bounds.model_dump(),
            "buoy_radius": course.buoy_radius,
        },
        "boat": {
            "name": boat.name,
            "length": boat.length,
            "breadth": boat.breadth,
            "thrusters": [
                {"name": item.name, "x": item.x, "y": item.y, "full": item.throttle_max}
                for item in boat.thrusters
            ],
            "stern": list(session.boat.stern),
        },
        "boats": list(session.berths),
        "levels": list(session.levels),
        "pilots": list(session.pilots),
        "source": source,
        "simulated": session.boat.simulated,
    }


def frame(session: Session, now: float) -> str:
    """The boat at `now` as JSON text."""
    state = session.state(now)
    azimuths, throttles = actuators(state)
    weather = session.boat.weather(state)
    data = {
        "type": "frame",
        "phase": session.phase,
        "outcome": session.outcome,
        "helm": session.helm,
        "stopped": session.phase == RUN and session.stopped(now),
        "trouble": session.trouble,
        "time": float(state[TIME]),
        "run_time": session.run_time,
        "pose": state[NORTH : NORTH + 3].tolist(),
        "velocity": state[SURGE : YAW_RATE + 1].tolist(),
        "azimuth": azimuths.tolist(),
        "throttle": throttles.tolist(),
        "levers": session.levers,
        "wind": weather and weather[:2],
        "current": weather and weather[2:],
        "passed": session.boat.now.passed,
    }
    return json.dumps(_rounded(data), allow_nan=False, separators=(",", ":"))


def status(session: Session) -> dict[str, Any]:
    """What changes now and then."""
    return {
        "type": "status",
        "nickname": session.nickname,
        "boat": session.vessel,
        "level": session.level,
        "pilot": session.pilot,
        "count": session.recordings.count,
        "board": session.recordings.board,
        "watch": list(session.watched),
    }


def replayed(run: Run, session: Session) -> dict[str, Any]:
    """A stored run to be shown again, with how far it is from the same run sailed anew: nought, if exact.

    None instead for a run that was not simulated.
    """
    boat = session.boat.boat
    about = run.meta.model_dump()
    channels = [item.command_columns for item in boat.thrusters]
    columns = {name: _list(run, name) for name in ("time", *MOTION)}
    return {
        "name": run.name,
        "about": {
            key: about.get(key) for key in ("nickname", "level", "helm", "seconds", "outcome", "gates")
        },
        "columns": columns,
        "azimuth": [_list(run, f"applied_{angle}") or _list(run, str(angle)) for angle, _ in channels],
        "throttle": [_list(run, f"applied_{level}") or _list(run, level) for _, level in channels],
        "levers": [_list(run, name) for name in ("joy_thrust", "joy_angle")],
        "wind": [_list(run, name) for name in ("wind_speed", "wind_from")],
        "current": list(current_at(0.0, disturbed(run, boat)[0])),
        "difference": None if run.meta.initial_state is None else largest_difference(run, boat),
    }


def _list(run: Run, name: str) -> list[float]:
    return [_rounded(value) for value in run.columns[name].tolist()] if name in run.columns else []


def _rounded(entry: Any) -> Any:
    if isinstance(entry, float):
        return round(entry, DIGITS) if math.isfinite(entry) else None
    if isinstance(entry, dict):
        return {key: _rounded(value) for key, value in entry.items()}
    return [_rounded(value) for value in entry] if isinstance(entry, list | tuple) else entry
