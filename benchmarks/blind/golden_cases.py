"""The golden cases: what is wrong, how it is measured, and the verdict that is asked for."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from swamp_rl.experiments.synthetic.cases import EACH_RUN, RTK, Case

from benchmarks.blind.variants import Instruments

Effects = list[dict[str, Any]]


@dataclass(frozen=True)
class Golden:
    """One case. kind: as a blind case has it; runs of `seconds` each.

    boat: a name, or a file in the case's folder; instruments: of runs that are measured in
    another way than with the noise of the level; faulty: a column that is turned round; refused: words of the
    refusal; reason: why today's diagnosis is wrong, if it is.
    """

    family: str
    verdict: str
    effects: Effects = field(default_factory=list)
    kind: str = "single"
    level: str = "A"
    by_run: list[Effects] = field(default_factory=list)
    outside: dict[str, Any] | None = None
    seed: int = 0
    runs: int = 3
    seconds: float = 30.0
    boat: str = "swamp"
    instruments: Instruments | None = None
    faulty: str = ""
    refused: str = ""
    reason: str = ""

    @property
    def case(self) -> Case:
        """The truth."""
        return Case(self.level, self.kind, self.effects, outside=self.outside, by_run=self.by_run)


def instruments(wander: float = 0.0, stretches: int = 0) -> Instruments:
    """RTK noise, positions that wander by `wander` [m] over 20 s, stretches of rows lost in each run."""
    channels = ("surge", "sway", "yaw_rate")
    return Instruments(10.0, np.array(RTK), wander, 20.0, 0.0, 0.02, stretches, channels, False)


def one(name: str, **values: Any) -> dict[str, Any]:
    """An effect as a boat file has it."""
    return {"effect": name} | values


def winds(*each: tuple[float, float]) -> list[Effects]:
    """A wind for each run: speed [m/s] and where from [degrees]."""
    return [[one("wind", speed=speed, **{"from": math.radians(angle)})] for speed, angle in each]


def currents(*each: tuple[float, float]) -> list[Effects]:
    """A current for each run, towards north and east [m/s]."""
    return [[one("current", north=north, east=east)] for north, east in each]


WIND = one("wind", speed=4.5, **{"from": 1.0})
SWELL = one("waves", force=4.0, frequency=0.23, phase=0.0, **{"from": 1.0})
BREEZES = winds((5.2, 40), (3.1, 95), (6.0, 10), (2.4, -60), (4.3, 70))
ROUND = winds((4.0, 0), (5.0, 120), (3.0, -110), (6.0, 60), (4.5, 180))
TIDES = currents((0.10, 0.02), (0.05, -0.06), (0.14, 0.05), (-0.03, 0.04), (0.08, 0.09))
HULL = {"x_vr": 1.25, "y_v": 0.8, "y_r": 1.15, "n_v": 1.2, "n_r": 0.85}
MOORING = {
    "what": "mooring",
    "length": 4.0,
    "stiffness": 2.0,
    "variables": ["position_north", "position_east"],
}
STALLED = {
    "what": "dead_zone",
    "thruster": "ss",
    "below": 0.55,
    "variables": ["throttle_ss", "thrust_ss"],
}


def each_run(by_run: list[Effects], *effects: dict[str, Any], **more: Any) -> Golden:
    """Weather of each run, beside effects that all runs share."""
    kind = "pair" if effects else "single"
    return Golden(
        "weather by run",
        "cause",
        list(effects),
        kind,
        EACH_RUN,
        by_run,
        runs=5,
        seconds=24.0,
        **more,
    )


GOLDEN: dict[str, Golden] = {
    "clean": Golden("none", "nothing_wrong", kind="clean"),
    "clean_plain_receiver": Golden("none", "nothing_wrong", kind="clean", level="B"),
    "clean_wandering_receiver": Golden(
        "sensors", "nothing_wrong", kind="clean", runs=2, seconds=40.0, instruments=instruments(wander=0.3)
    ),
    "mass": Golden("hull", "cause", [one("mass", mass=66.0)]),
    "resistance": Golden("hull", "cause", [one("resistance", scale=1.4)]),
    "sway_drag": Golden("hull", "cause", [one("sway_drag", scale=0.6)]),
    "yaw_damping": Golden("hull", "cause", [one("yaw_damping", scale=1.6)]),
    "hull_coefficients": Golden("hull", "cause", [one("hull_coefficients", **HULL)]),
    "demihull_spacing": Golden("hull", "cause", [one("demihull_spacing", spacing=0.4)]),
    "thruster_gain": Golden("thrust", "cause", [one("thruster_gain", thruster="sp", gain=0.7)]),
    "azimuth_offset": Golden("thrust", "cause", [one("azimuth_offset", thruster="bs", offset=-0.15)]),
    "azimuth_lag": Golden("thrust", "cause", [one("azimuth_lag", time_constant=0.7)]),
    "thrust_deduction": Golden("thrust", "cause", [one("thrust_deduction", low=0.7, high=0.8)]),
    "thrust_scale": Golden("thrust", "cause", [one("thrust_scale", scale=0.85)]),
    "channel_swap": Golden("thrust", "cause", [one("channel_swap", thruster=["bs", "sp"])], seed=2),
    "channel_swap_of_equal_pairs": Golden(  # any bow and any stern thruster, of which each two act alike
        "indistinguishable", "indistinguishable", [one("channel_swap", thruster=["bs", "sp"])]
    ),
    "azimuth_reversed": Golden("thrust", "cause", [one("azimuth_reversed", thruster="bs")]),
    "azimuth_reversed_all": Golden(
        "thrust", "cause", [one("azimuth_reversed", thruster="all")], level="B", runs=2
    ),
    "thruster_failure": Golden("thrust", "cause", [one("thruster_failure", thruster="ss", time=21.0)]),
    "command_delay": Golden("thrust", "cause", [one("command_delay", delay=0.5)]),
    "wind": Golden("weather", "cause", [WIND]),
    "current": Golden("weather", "cause", [one("current", north=0.1, east=-0.06)]),
    "shallow_water": Golden("weather", "cause", [one("shallow_water", depth_over_draught=2.0)]),
    "waves": Golden("weather", "cause", [SWELL]),
    "position_delay": Golden("sensors", "cause", [one("position_delay", delay=0.5)]),
    "heading_bias": Golden("sensors", "cause", [one("heading_bias", bias=0.1)]),
    "yaw_damping_wandering_receiver": Golden(
        "sensors",
        "cause",
        [one("yaw_damping", scale=1.6)],
        runs=2,
        seconds=40.0,
        instruments=instruments(wander=0.3),
    ),
    "lost_rows": Golden(
        "lost rows", "cause", [one("resistance", scale=1.4)], instruments=instruments(stretches=2)
    ),
    "heading_turned_round": Golden("refused", "refused", kind="clean", faulty="heading", refused="heading"),
    "pair_wind_thruster": Golden(
        "pairs", "cause", [WIND, one("thruster_gain", thruster="bp", gain=0.7)], "pair"
    ),
    "pair_mass_compass": Golden(
        "pairs", "cause", [one("mass", mass=66.0), one("heading_bias", bias=0.1)], "pair"
    ),
    "mooring": Golden("unexplained force", "unexplained", kind="outside", outside=MOORING),
    "dead_zone": Golden("unexplained force", "unexplained", kind="outside", outside=STALLED, runs=2),
    "straight_courses": Golden(
        "indistinguishable", "indistinguishable", [one("thrust_scale", scale=1.2)], "confounded"
    ),
    "twin": Golden(
        "foreign boats",
        "cause",
        [one("thruster_gain", thruster="port", gain=0.75)],
        boat="twin.yaml",
        instruments=instruments(),
    ),
    "ferry": Golden(
        "foreign boats",
        "cause",
        [one("current", north=0.15, east=0.1)],
        boat="ferry.yaml",
        seconds=80.0,
        instruments=instruments(),
    ),
    "wind_by_run": each_run(BREEZES),
    "current_by_run": each_run(TIDES),
    "wind_by_run_mass": each_run(ROUND, one("mass", mass=66.0)),
    "wind_by_run_thruster": each_run(BREEZES, one("thruster_gain", thruster="sp", gain=0.65)),
    "current_by_run_azimuth_lag": each_run(TIDES, one("azimuth_lag", time_constant=0.6)),
}
