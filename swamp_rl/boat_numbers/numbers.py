"""The numbers of a boat file that a fit moves, each with its prior."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, PropellerRudder, Thruster
from swamp_rl.boat.plausible import Limit, ranges
from swamp_rl.boat.resistance import TankResistance
from swamp_rl.boat.screw import Linear, OpenWater
from swamp_rl.boat_numbers.number import Number, log_width
from swamp_rl.boat_numbers.start_effects import free_of_effects
from swamp_rl.effects import Reference
from swamp_rl.effects.limits import LONGEST_DELAY
from swamp_rl.simulator import parameters
from swamp_rl.simulator.reference import reference_of

Array = NDArray[np.float64]

MEASURED = 0.3  # of the usual prior width, for a number that the file gives as measured
# of the prior width of a time constant: the shortest that is fitted, since shorter ones are followed at once
SHORTEST, LAG_STEP = 0.05, 0.03
ROOM = 1.25  # factor that is left to the ends of plausible ranges, which depend on the mass as well
LAG = 0.3  # prior width of a time constant, in lengths over top speed
# prior width [1] of the factor at full command; it is 0.6 where thrust grows by the square of the command up
# to 60 % and in proportion to it from there on
SATURATION = 0.3
SATURATED = "efficiency_100"  # field of the record
COMPASS = "heading_bias"  # field of the record
DEVIATION = 0.1  # rad, prior width of an offset of the compass: declination, mounting and deviation
FOIL = 0.4  # prior width of the logarithm of a foil's area and of its γ, as of a rudder's
DERIVATIVE = 0.02  # prior width [1] of a hull derivative beside its share, which may be 0 or of either sign


def free_numbers(boat: Boat, positions: bool = False) -> tuple[Number, ...]:
    """The numbers of a boat that a fit moves; positions: also where its thrusters are."""
    of, loaded = reference_of(boat), _as_loaded(boat)
    found = [*_inertia(loaded), *_resistance(boat, of), *_hull(boat, of)]
    for k, thruster in enumerate(boat.thrusters):
        found += _propeller(boat, k) if isinstance(thruster, PropellerRudder) else _jet(boat, k)
        found += _positions(boat, k) if positions and not isinstance(thruster, PropellerRudder) else []
    found += [*_lags(boat, of), *_clocks(boat), _compass(boat)]
    plausible = {limit.key: limit for limit in ranges(loaded)}
    found = list(free_of_effects(found, boat))
    return tuple(_within(_narrowed(number, boat), plausible.get(number.name)) for number in found)


def without_compass(numbers: Sequence[Number]) -> tuple[Number, ...]:
    """The numbers but an offset of the compass, which most boats do not have."""
    return tuple(one for one in numbers if one.field != COMPASS)


def _as_loaded(boat: Boat) -> Boat:
    """The boat with the mass, inertia and centre of gravity that its effects give it."""
    record = parameters(boat)[0]
    return boat.model_copy(update={name: float(record[name]) for name in ("mass", "inertia_z", "x_g")})


def _within(number: Number, limit: Limit | None) -> Number:
    """The number with the bounds that a boat file's plausible range sets its factor exp(x)."""
    if limit is None or not number.scaled or limit.ratio <= 0.0:
        return number
    low = math.log(limit.low * ROOM / limit.ratio) if limit.low > 0.0 else -math.inf
    return replace(number, low=min(low, 0.0), high=max(math.log(limit.high / ROOM / limit.ratio), 0.0))


def _narrowed(number: Number, boat: Boat) -> Number:
    """The number with the prior width that the boat file gives; without one, a narrower prior if measured."""
    key = number.name if number.element is None else number.name.rpartition(".")[0]
    given = boat.provenance.get(key)
    if given is None:
        return number
    sd = given.sd[number.element] if isinstance(given.sd, tuple) and number.element is not None else given.sd
    if isinstance(sd, float | int) and sd > 0.0 and (number.start != 0.0 or not number.scaled):
        return replace(number, sd=log_width(sd / abs(number.start)) if number.scaled else float(sd))
    return replace(number, sd=MEASURED * number.sd) if given.provenance == "measured" else number


def _inertia(boat: Boat) -> Iterable[Number]:
    mass, turning = boat.mass, boat.inertia_z
    steps, turns = "changes of thrust", "turns that begin and end"
    yield _share("mass", "kg", "mass", mass, 0.1, steps)
    yield _share("inertia_z", "kg m2", "inertia_z", turning, 0.25, turns)
    yield Number("x_g", "m", "x_g", boat.x_g, 0.03 * boat.length, "tight turns at speed")
    for name, own, unit, trial in (
        ("added_mass_surge", mass, "kg", steps),
        ("added_mass_sway", mass, "kg", "turns that begin and end"),
        ("added_inertia_yaw", turning, "kg m2", turns),
    ):
        value = getattr(boat, name)
        if value < 0.0:
            yield _share(name, unit, name, value, 0.5, trial)
        else:
            yield Number(name, unit, name, value, 0.2 * own, trial, high=0.0)


def _share(name: str, unit: str, field: str, start: float, sd: float, trial: str) -> Number:
    """A number with a prior in proportion to it."""
    return Number(name, unit, field, start, sd, trial, scaled=True)


def _resistance(boat: Boat, of: Reference) -> Iterable[Number]:
    straight = "straight runs at several speeds"
    if isinstance(boat.resistance, TankResistance):
        scale = float(parameters(boat)["resistance_scale"][0])
        yield _share("resistance.table", "1", "resistance_scale", scale, 0.4, straight)
    else:
        for name, where in (("x_0_ahead", straight), ("x_0_astern", "straight runs astern")):
            value = getattr(boat.resistance, name) * _load_factor(parameters(boat))[0]
            yield _share(f"resistance.{name}", "1", name, value, 0.5, where)
    yield _damping(boat, "linear_drag", 0.2 * of.damping, "N s/m", "coasting to a stop")
    yield _damping(boat, "linear_sway_damping", 0.15 * of.damping, "N s/m", "slow turns")
    yield _damping(boat, "linear_yaw_damping", 0.1 * of.yaw_damping, "N m s/rad", "slow turns on the spot")


def write_numbers(numbers: Sequence[Number], made: NDArray[Any], x: Array) -> None:
    """Put the numbers x (n, p) into records (n,) of the boat that they are of, in place."""
    by_drift = "x_0_ahead" in (made.dtype.names or ())  # its reference mass is the boat's own
    for name in ("x_0_ahead", "x_0_astern") if by_drift else ():
        made[name] *= _load_factor(made)
    for number, own in zip(numbers, x.T, strict=True):
        number.write(made, own)
    if by_drift:
        made["reference_mass"] = made["mass"]


def _load_factor(record: NDArray[np.void]) -> Array:
    """(n,) resistance at the mass of records over that at their reference mass: load to the 2/3."""
    return np.cbrt((record["mass"] / record["reference_mass"]) ** 2)


def _damping(boat: Boat, effect: str, sd: float, unit: str, trial: str) -> Number:
    start = float(parameters(boat)[effect][0])
    return Number(f"effects.{effect}.coefficient", unit, effect, start, sd, trial, low=min(0.0, start))


def _hull(boat: Boat, of: Reference) -> Iterable[Number]:
    record = parameters(boat)[0]
    trials = {
        "x_vr": "turns at speed",
        "y_v": "turns at speed",
        "y_r": "turns at speed",
        "n_v": "turns at speed",
        "n_r": "turns of several rates at speed",
        "c_ry": "tight turns",
        "c_rn": "turns on the spot",
    }
    for name, trial in trials.items():
        start = float(record[name])
        sd = 0.3 if name in ("c_ry", "c_rn") else 0.4 * abs(start) + DERIVATIVE
        high = 0.0 if name in ("y_v", "n_r") and start <= 0.0 else math.inf
        # The hull of the cross flow is alike fore and aft: C_rY and -C_rY give one sway force.
        low = 0.0 if name in ("c_ry", "c_rn") and start >= 0.0 else -math.inf
        yield Number(f"hull.{name}", "1", name, start, sd, trial, low=low, high=high)
    if record["c_d"] > 0.0:
        yield _share("hull.c_d", "1", "c_d", float(record["c_d"]), 0.4, "tight turns")


def _jet(boat: Boat, k: int) -> Iterable[Number]:
    thruster, record = boat.thrusters[k], parameters(boat)[0]
    assert isinstance(thruster, Thruster)
    key, screw = f"thrusters.{thruster.name}", thruster.propeller
    for way, ahead in (("thrust", True), ("astern", False)):
        names = [f"{way}_{power}" for power in ("linear", "quadratic")]
        most = float(sum(record[name][k] for name in names))
        if most == 0.0:
            continue
        trial = f"several throttles {'ahead' if ahead else 'astern'} of {thruster.name}"
        for name in names:
            start = float(record[name][k])
            yield Number(f"{key}.{name}", "N", name, start, 0.3 * most, trial, low=0.0, thrusters=(k,))
    if screw is not None:
        yield from _open_water(screw.open_water, key, k, f"several throttles of {thruster.name}")
    elif thruster.thrust_table is None and record["nozzle_area"][k] > 0.0:
        start = float(record["advance_loss"][k])
        trial = "full throttle at speed"
        name = f"{key}.advance_loss"
        yield Number(name, "1", "advance_loss", start, 0.3, trial, low=0.0, thrusters=(k,))
    if screw is None and thruster.thrust_table is None:
        yield from _saturation(boat, k)
    yield _dead_band(boat, k)
    if thruster.kind == "azimuth":
        start = float(record["azimuth_offset"][k])
        name = f"{key}.azimuth_offset"
        yield Number(name, "rad", "azimuth_offset", start, 0.1, "straight runs", thrusters=(k,))
    if thruster.foil is not None:
        yield from _foil(thruster, k)


def _foil(thruster: Thruster, k: int) -> Iterable[Number]:
    """Area and flow straightening of a foil, of which the file has a value above 0."""
    assert thruster.foil is not None
    for name, unit, trial in (("area", "m2", "azimuths at speed"), ("gamma", "1", "turns at speed")):
        start, field = float(getattr(thruster.foil, name)), f"foil_{name}"
        if start > 0.0:
            key = f"thrusters.{thruster.name}.foil.{name}"
            yield Number(key, unit, field, start, FOIL, trial, scaled=True, thrusters=(k,))


def _open_water(model: OpenWater, key: str, k: int, trial: str) -> Iterable[Number]:
    """The thrust at rest of a propeller's model, where that is a number of the file."""
    if isinstance(model, Linear):
        start, name = model.bollard_coefficient, f"{key}.propeller.open_water.bollard_coefficient"
        yield Number(name, "1", "screw_bollard", start, 0.3 * start, trial, low=0.0, thrusters=(k,))


def _saturation(boat: Boat, k: int) -> Iterable[Number]:
    """The share of the curve's thrust that is left at full command: T = e(p) (a + b p) p, a, b >= 0, rises
    faster than the command where e = 1; measured curves of propellers rise slower near full command.
    """
    record = parameters(boat)[0]
    if record["efficiency_30"][k] != 1.0 or record["efficiency_60"][k] != 1.0:
        return
    start, name = float(record[SATURATED][k]), boat.thrusters[k].name
    key = f"effects.thruster_efficiency_curve.at_100.{name}"
    trial = f"several throttles above 60 % of {name}"
    yield Number(key, "1", SATURATED, start, SATURATION, trial, low=0.0, thrusters=(k,))


def _dead_band(boat: Boat, k: int) -> Number:
    start, name = float(parameters(boat)["dead_band"][0, k]), boat.thrusters[k].name
    trial = f"small throttles of {name}"
    return Number(
        f"effects.throttle_dead_band.below.{name}",
        "1",
        "dead_band",
        start,
        0.08,
        trial,
        low=0.0,
        high=0.6,
        thrusters=(k,),
    )


def _positions(boat: Boat, k: int) -> Iterable[Number]:
    thruster, record = boat.thrusters[k], parameters(boat)[0]
    for axis in ("x", "y"):
        start = float(record[f"thruster_{axis}"][k])
        name = f"thrusters.{thruster.name}.{axis}"
        trial = f"turns with {thruster.name} alone"
        most = 0.75 * (boat.length if axis == "x" else boat.breadth)
        yield Number(
            name,
            "m",
            f"thruster_{axis}",
            start,
            0.1 * boat.length,
            trial,
            low=-most,
            high=most,
            thrusters=(k,),
        )


def _propeller(boat: Boat, k: int) -> Iterable[Number]:
    """Open-water thrust and wake of the propeller, and the forces of the rudder in its race."""
    thruster, record = boat.thrusters[k], parameters(boat)[0]
    assert isinstance(thruster, PropellerRudder)
    key, model = f"thrusters.{thruster.name}", thruster.propeller.open_water
    thrust, astern, steered = "several revolutions ahead", "revolutions astern", "rudder angles at speed"

    def one(
        name: str, field: str, sd: float, trial: str, low: float = -math.inf, high: float = math.inf
    ) -> Number:
        start = float(record[field][k])
        return Number(f"{key}.{name}", "1", field, start, sd, trial, low=low, high=high, thrusters=(k,))

    def share(name: str, field: str, sd: float, trial: str) -> Number:
        start = float(record[field][k]) if record[field].ndim == 1 else 1.0
        return Number(f"{key}.{name}", "1", field, start, sd, trial, scaled=True, thrusters=(k,))

    if model is not None:
        yield from _open_water(model, key, k, thrust)
    for name, trial in (("k_t", thrust), ("astern_thrust", astern)) if model is None else ():
        for i in range(3):
            start = float(record[name][k, i])
            sd = 0.3 * max(abs(start), 0.3 * abs(float(record[name][k, 0])))
            number = f"{key}.propeller.{name}.{i}"
            yield Number(number, "1", name, start, sd, trial, thrusters=(k,), element=i)
    yield one("propeller.wake_zero", "wake_zero", 0.15, thrust, 0.0, 0.95)
    yield share("propeller.side_force", "propeller_side_force", 0.5, astern)
    yield share("propeller.yaw_moment", "propeller_yaw_moment", 0.5, astern)
    yield one("rudder.a_h", "rudder_a_h", 0.2, steered)
    yield one("rudder.flow_lever", "rudder_flow_lever", 0.3, "turns of several rates at speed")
    for name, sd, trial in (
        ("gamma_p", 0.4, "turns at speed"),
        ("gamma_n", 0.4, "turns at speed"),
        ("epsilon", 0.25, steered),
        ("k_x", 0.5, "rudder angles at several revolutions"),
        ("k_x_astern", 0.5, astern),
    ):
        if record[f"rudder_{name}"][k] > 0.0:
            yield share(f"rudder.{name}", f"rudder_{name}", sd, trial)


def _lags(boat: Boat, of: Reference) -> Iterable[Number]:
    """Time constants, one for all thrusters that have the same in the file."""
    record, every = parameters(boat)[0], boat.thrusters
    for field, of_propeller, trial in (
        ("pump_time_constant", "revolutions_time_constant", "steps of the throttle"),
        ("azimuth_time_constant", "rudder_time_constant", "steps of the azimuth or the rudder"),
    ):
        for propeller, name in ((False, field), (True, of_propeller)):
            mine = [
                k
                for k, thruster in enumerate(every)
                if isinstance(thruster, PropellerRudder) == propeller
                and (thruster.kind != "fixed" or field == "pump_time_constant")
            ]
            for start in sorted({float(record[field][k]) for k in mine}):
                alike = tuple(k for k in mine if record[field][k] == start)
                key = f"thrusters.{every[alike[0]].name}.{name}"
                sd = LAG * of.time
                least = min(start or np.inf, SHORTEST * sd)
                yield Number(
                    key, "s", field, start, sd, trial, low=least, thrusters=alike, step=LAG_STEP, least=sd
                )


def _clocks(boat: Boat) -> Iterable[Number]:
    """Delay of the commands, and the receiver's clock against theirs."""
    record, trial = parameters(boat)[0], "many changes of the commands"
    for effect, parameter, field, low in (
        ("command_delay", "delay", "command_delay", 0.0),
        ("clock_offset", "offset", "clock_offset", -LONGEST_DELAY),
    ):
        start = float(record[field])
        name = f"effects.{effect}.{parameter}"
        yield Number(name, "s", field, start, 0.2, trial, low=low, high=LONGEST_DELAY)


def _compass(boat: Boat) -> Number:
    """Constant offset of the compass."""
    start, most = float(parameters(boat)[0]["heading_bias"]), 0.5 * math.pi
    name, trial = "effects.heading_bias.bias", "straight runs on several courses"
    return Number(name, "rad", COMPASS, start, DEVIATION, trial, low=-most, high=most)
