"""Functions of the residual force as effect instances that a fit estimates: by knots, and by formulas."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import within_half_turn
from swamp_rl.boat import Boat
from swamp_rl.criticism.data.command_names import COMMANDS
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.model.candidates import EffectInstance, Spec
from swamp_rl.criticism.model.scales import force_scale
from swamp_rl.criticism.nuisance.force_functions import THRUST
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import CurvePoint, ResidualForce
from swamp_rl.effects import LIBRARY
from swamp_rl.effects.curve import ANGLES, Curve, formulas_of
from swamp_rl.physics.force_curve import KNOTS

Array = NDArray[np.float64]

PLACE = (("north", "position north"), ("east", "position east"))
POWER = {"proportional": 1, "dead_zone": 1, "square": 2, "cube": 3}


@dataclass(frozen=True)
class Function:
    """One function of the residual force, or one of both position coordinates; starts: of its fit."""

    instances: tuple[EffectInstance, ...]
    starts: tuple[Array, ...]


def curve_instances(run_set: RunSet, leftover: Sequence[ResidualForce]) -> list[Function]:
    """The functions of the residual force by knots over the data's range. A horizontal force that depends on
    the position is tried first, listed or not: a line's force is a function of the speed as well. The thrust
    of a propeller with a rudder is listed beside the surge force that it is as well: the first one counts.
    """
    listed: dict[tuple[str, str, tuple[str, ...]], ResidualForce] = {}
    for one in leftover:
        if len(one.curve) > 1:
            listed.setdefault(_names(run_set.boat, one), one)
    place = [listed.pop(_names(run_set.boat, zero), zero) for zero in (_zero(run_set, *key) for key in PLACE)]
    parts = [
        [_by_knots(run_set, one) for one in place],
        *([_by_knots(run_set, one)] for one in listed.values()),
    ]
    return [Function(tuple(one for one, _ in each), tuple(start for _, start in each)) for each in parts]


def _zero(run_set: RunSet, force: str, variable: str) -> ResidualForce:
    """A function that is zero over the data's range."""
    ends = np.quantile(
        variable_values(run_set, variable), [options().curve_tails, 1.0 - options().curve_tails]
    )
    curve = [CurvePoint(at=float(end), force=0.0, standard_error=0.0) for end in ends]
    return ResidualForce(force=force, variable=variable, explained=0.0, curve=curve)


def _by_knots(run_set: RunSet, one: ResidualForce) -> tuple[EffectInstance, Array]:
    """The instance of a function, and its values as they were estimated."""
    component, covariate, selectors = _names(run_set.boat, one)
    values = variable_values(run_set, one.variable)
    if covariate in ANGLES and _goes_round(one.curve):
        return _round_an_angle(run_set.boat, one, values)
    at = np.array([point.at for point in one.curve])
    at[0] -= options().curve_wider * (at[1] - at[0])
    at[-1] += options().curve_wider * (at[-1] - at[-2])
    if len(values):
        tail = 0.0 if covariate in ("throttle", "azimuth", "time") else options().curve_tails
        ends = np.quantile(values, [tail, 1.0 - tail])
        margin = 1e-6 * float(np.ptp(ends))
        at[0], at[-1] = min(ends[0] - margin, at[1] - margin), max(ends[1] + margin, at[-2] + margin)
    knots = more_knots(at, values)
    curve = Curve(component, covariate, tuple(knots.tolist()), places=tuple(range(len(knots))))
    start = np.interp(knots, at, [point.force for point in one.curve])
    return _instance(run_set.boat, curve, selectors), start


def more_knots(at: Array, values: Array) -> Array:
    """Knots (K,) and more in the middle of the longest intervals, as many as a curve may have; see `_inside`
    for values (n,).
    """
    while len(at) < KNOTS:
        longest = np.argsort(-np.diff(at), kind="stable")
        added = next((one for place in longest if len(one := _inside(at, int(place), (0.5,), values))), None)
        if added is None:
            break
        at = np.sort(np.concatenate([at, added]))
    return at


def _inside(at: Array, place: int, shares: Sequence[float], values: Array) -> Array:
    """(n,) new knots at shares of an interval between knots (K,), moved to the nearest of the samples: where
    there are none a function is interpolated, not estimated. values: samples (n,), none for a variable that
    was not measured.
    """
    low, high = at[place : place + 2]
    wanted = low + np.array(shares) * (high - low)
    if not len(values):
        return wanted
    margin = options().knots_apart * (at[-1] - at[0])
    there = np.unique(values[(values > low + margin) & (values < high - margin)])
    return np.unique([there[np.abs(there - one).argmin()] for one in wanted]) if len(there) else there


def with_knots_moved(
    run_set: RunSet, instance: EffectInstance, values: Array
) -> tuple[EffectInstance, Array] | None:
    """A function with two knots more in the interval in which its values (p,) change most, in place of those
    that bend it least, and its values there; None where there are no samples, and for one round an angle.
    """
    curve = instance.curve
    assert curve is not None
    if curve.places != tuple(range(len(curve.knots))):
        return None
    given, place = np.array(curve.knots), int(np.abs(np.diff(values)).argmax())
    variable = curve.covariate.replace("_", " ")
    if variable in ("throttle", "azimuth"):
        variable += f" {instance.selectors[0]}"
    added = _inside(given, place, (1 / 3, 2 / 3), variable_values(run_set, variable))
    if not len(added):
        return None
    at = np.sort(np.concatenate([given, added]))
    force = np.interp(at, given, values)
    held = np.isin(at, [given[0], *given[place : place + 2], *added, given[-1]])
    while len(at) > KNOTS:
        bends = [np.inf] * len(at)
        for k in np.flatnonzero(~held):
            beside = [k - 1, k + 1]
            bends[k] = abs(force[k] - float(np.interp(at[k], at[beside], force[beside])))
        left = np.arange(len(at)) != int(np.argmin(bends))
        at, force, held = at[left], force[left], held[left]
    moved = Curve(curve.component, curve.covariate, tuple(at.tolist()), places=tuple(range(len(at))))
    return _instance(run_set.boat, moved, instance.selectors), force


def _round_an_angle(boat: Boat, one: ResidualForce, values: Array) -> tuple[EffectInstance, Array]:
    """Of an angle over a full turn: the first and the last knot, half a turn to either side, are one."""
    component, covariate, selectors = _names(boat, one)
    count = len(one.curve)
    apart = 2.0 * np.pi / count
    numbers = np.round(np.array([point.at for point in one.curve]) / apart).astype(int) % count
    force = np.array([point.force for point in one.curve])[np.argsort(numbers)]
    around = np.arange(count + 1) - count // 2  # from half a turn to port to half a turn to starboard
    near = np.round(values / apart).astype(int) % count
    known = np.array([(near == number).mean() >= options().knot_share for number in range(count)])
    place = np.where(known, np.cumsum(known) - 1, -1)
    knots = apart * around
    knots[0], knots[-1] = -np.pi - 1e-9, np.pi + 1e-9
    curve = Curve(component, covariate, tuple(knots.tolist()), places=tuple(place[around % count].tolist()))
    return _instance(boat, curve, selectors), force[known]


def _goes_round(points: Sequence[CurvePoint]) -> bool:
    """Whether knots are evenly spaced over a full turn."""
    at = np.array([point.at for point in points])
    apart = np.diff(np.unique(np.round(at, 6)))
    return np.allclose(apart, 2.0 * np.pi / len(at), atol=options().round_angle)


def _names(boat: Boat, one: ResidualForce) -> tuple[str, str, tuple[str, ...]]:
    """Component, variable and thruster (none or one), as `force_curve` has them. The thrust of a propeller
    with a rudder, which the rudder does not turn, is a surge force.
    """
    first, _, second = one.variable.partition(" ")
    kinds = {f"{THRUST}{thruster.name}": thruster.kind for thruster in boat.thrusters}
    component = one.force
    owner: tuple[str, ...] = ()
    if kinds.get(one.force) == "propeller_rudder":
        component = "surge"
    elif one.force in kinds:
        component, owner = "thrust", (one.force.removeprefix(THRUST),)
    if first in COMMANDS:
        return component, first, (second,)
    return component, one.variable.replace(" ", "_"), owner


def variable_values(run_set: RunSet, variable: str) -> Array:
    """(n,) measured or commanded values of a variable; empty where it was not measured."""
    first, _, second = variable.partition(" ")
    kept = np.arange(run_set.measured.shape[1]) < run_set.lengths[:, None]
    if first in COMMANDS:
        names = run_set.boat.thruster_names
        column = names.index(second) + (len(names) if first == "throttle" else 0)
        values = run_set.commands[..., column][kept]
        return within_half_turn(values) if first == "azimuth" else values
    if variable == "time":
        return np.array([0.0, float(run_set.lengths.max() * run_set.dt)])
    channels = {"speed": ("surge", "sway"), "yaw rate": ("yaw_rate",)}
    names = channels.get(variable, (variable.removeprefix("position "),))
    if not set(names) <= set(run_set.present):
        return np.zeros(0)
    columns = [run_set.measured[..., CHANNELS.index(name)][kept] for name in names]
    values = columns[0] if len(columns) == 1 else np.hypot(*columns)
    values = values[np.isfinite(values)]
    return within_half_turn(values) if variable == "heading" else values


def _instance(boat: Boat, curve: Curve, selectors: tuple[str, ...]) -> EffectInstance:
    """A curve as an effect instance, its values within `curve_bound` typical sizes."""
    size = options().curve_scale * float(force_scale(boat)[2 if curve.component == "yaw" else 0])
    reach = max(abs(curve.knots[0]), abs(curve.knots[-1]))
    prior = None if curve.formula else size
    if curve.formula:
        size /= reach ** POWER.get(curve.formula, 0)
    most = options().curve_bound * size
    specs = [Spec(size, -most, most, (), 1e-6 * size, prior, 0.0)] * curve.size
    if curve.formula and curve.size > 1:
        low, high = (-2.0 * np.pi, 2.0 * np.pi) if curve.formula == "sine" else (0.0, reach)
        step = options().jump_step if curve.formula == "outside_radius" else 1e-6
        specs[1] = Spec(options().threshold_scale * reach, low, high, (), step * reach, None, 0.0)
    return EffectInstance(LIBRARY["force_curve"], selectors, tuple(specs), (), curve=curve)


def formula_instances(
    boat: Boat, instance: EffectInstance, values: Array, error: Array
) -> list[tuple[EffectInstance, Array]]:
    """Each formula whose units fit the variable, over the range of the knots, and the coefficients (q,) that
    are nearest to the values (p,) at the knots; error: (p,) of these.
    """
    curve = instance.curve
    assert curve is not None
    if curve.formula:
        return []
    at = np.array([knot for knot, place in zip(curve.knots, curve.places, strict=True) if place >= 0])
    places = [place for place in curve.places if place >= 0]
    force, weight = values[places], 1.0 / np.maximum(error[places], 1e-12)
    found, ends = [], (curve.knots[0], curve.knots[-1])
    for name in formulas_of(curve.covariate):
        made = _instance(boat, Curve(curve.component, curve.covariate, ends, name), instance.selectors)
        found.append((made, nearest_coefficients(name, at, force, weight)))
    return found


def nearest_coefficients(name: str, at: Array, force: Array, weight: Array) -> Array:
    """(q,) coefficients of a formula by weighted least squares, its threshold from a grid."""
    size, reach = np.abs(at), float(np.abs(at).max())
    if name == "sine":
        basis = np.column_stack([np.sin(at), -np.cos(at)])
        inside, across = np.linalg.lstsq(basis * weight[:, None], force * weight, rcond=None)[0]
        return np.array([np.hypot(inside, across), np.arctan2(across, inside)])
    grid = np.linspace(0.0, options().formula_reach * reach, options().formula_grid)
    shapes: list[tuple[tuple[float, ...], Array]]
    if name == "dead_zone":
        shapes = [((t,), np.sign(at) * np.maximum(size - t, 0.0)) for t in grid]
    elif name == "outside_radius":
        shapes = [((t,), np.sign(at) * (size > t)) for t in grid]
    else:
        shapes = [((), np.sign(at) * size ** POWER[name])]
    best, least = np.zeros(1), np.inf
    for threshold, shape in shapes:
        square = float((weight * shape) @ (weight * shape))
        slope = float((weight * shape) @ (weight * force)) / square if square > 0.0 else 0.0
        left = float(((weight * (force - slope * shape)) ** 2).sum())
        if left < least:
            best, least = np.array([slope, *threshold]), left
    return best
