"""What to do where no set of effects explains the runs, in plain words."""

from collections.abc import Sequence

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.command_names import as_column
from swamp_rl.criticism.data.run_set import Wind
from swamp_rl.criticism.result import Extension, ResidualForce

EARTH = "heading", "position north", "position east", "time"
HULL = "speed", "surge", "sway", "yaw rate"
OF_EARTH = "something fixed to the earth or in time"
AGAIN = "the same manoeuvre again elsewhere and at another time"
ACTION: dict[Wind, str] = {
    "unknown": f"{OF_EARTH}, such as wind, current, waves or a line: record the wind (columns wind_speed "
    f"and wind_from), and {AGAIN}",
    "ignored": f"{OF_EARTH}, such as wind, current, waves or a line: diagnose with the measured wind, "
    f"without --ignore wind, and record {AGAIN}",
    "measured": f"{OF_EARTH} beside the measured wind, such as its coefficients in the boat file, current, "
    f"waves or a line: record {AGAIN}",
}
RESISTANCE = (
    "the hull: record straight runs at several speeds, coasting without thrust, and circles of two sizes to "
    "either side"
)
THRUST = (
    "the thrusters: compare the limits of throttle, azimuth and rudder in the boat file with the boat's, "
    "check the logged commands with swamp-rl runs doctor, and record straight runs at several throttles"
)


def next_steps(
    boat: Boat,
    leftover: Sequence[ResidualForce],
    extension: Extension | None,
    missing_motion: Sequence[str],
    wind: Wind = "unknown",
) -> list[str]:
    """Of an unexplained model error, what helps most first.

    leftover, extension: of the diagnosis; missing_motion: what the runs lack; wind: of the runs.
    """
    steps = []
    if not any(one.provenance == "fitted" for one in boat.provenance.values()):
        steps.append(
            "fit the numbers of the boat file to these runs, then diagnose others with the fitted file: "
            "swamp-rl identify boat. No number of this file was fitted to runs: many may be wrong at once, "
            "where a diagnosis adds three effects at most"
        )
    origins: dict[str, list[str]] = {}
    for force, variable in _dependences(leftover, extension):
        origins.setdefault(_origin(force, variable, wind), []).append(variable)
    for origin, variables in origins.items():
        names = " and ".join(dict.fromkeys(as_column(one, boat) for one in variables))
        steps.append(f"the missing force depends on {names}, which suggests {origin}")
    if not origins:
        steps.append(
            "the missing force depends on no single variable: record each manoeuvre twice. What repeats is "
            "the boat's, what differs is the weather's"
        )
    if extension and extension.written:
        steps.append(
            "simulate with extended_boat.yaml, which has the missing force, within the range of these runs"
        )
    if missing_motion:
        steps.append("record what these runs lack: see the limits of the data")
    return steps


def _dependences(leftover: Sequence[ResidualForce], extension: Extension | None) -> list[tuple[str, str]]:
    """Each force and the variable that it depends on: of the extension, or else the largest residual's."""
    if extension:
        return [(one.component, one.covariate.replace("_", " ")) for one in extension.curves]
    return [(one.force, one.variable) for one in leftover[:1]]


def _origin(force: str, variable: str, wind: Wind) -> str:
    """What a force comes from, by the variable that it depends on."""
    if variable in EARTH:
        return ACTION[wind]
    return RESISTANCE if variable in HULL and not force.startswith("thrust") else THRUST
