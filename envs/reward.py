"""What a step is worth: a sum of terms, each with a weight that the environment is made with."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from swamp_rl.envs.own_terms import refuse_function

from swamp_rl.course.tables import GATE_COS, GATE_EAST, GATE_NORTH, GATE_SIN
from swamp_rl.effects.entries import is_number
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.own_code import is_code
from swamp_rl.physics.compile import compiled
from swamp_rl.simulator.state import ACTUATORS, EAST, NORTH


@dataclass(frozen=True)
class RewardTerm:
    """A term of the reward. weight: where none is given, in `unit`; cost: it is taken off."""

    name: str
    weight: float
    unit: str
    cost: bool
    equation: str
    "Of a step, in which w is the weight and Δt the time of the step."
    meaning: str


REWARD = (
    RewardTerm(
        "progress",
        0.1,
        "1/m",
        False,
        "w (D₀ − D₁)",
        "decrease of the distance to go D; the sum over a run is w (D at its start − D at its end)",
    ),
    RewardTerm("gate", 1.0, "1", False, "w G", "G gates passed in this step"),
    RewardTerm("success", 0.0, "1", False, "w", "once, when the last gate is passed"),
    RewardTerm(
        "failure", 2.0, "1", True, "w", "once, for touching a buoy or the ground or leaving the bounds"
    ),
    RewardTerm("effort", 0.01, "1/s", True, "w τ² Δt", "throttle τ of the action"),
    RewardTerm(
        "time", 0.02, "1/s", True, "w Δt", "under way, so that waiting costs more than what it puts off"
    ),
    RewardTerm(
        "change",
        0.002,
        "s",
        True,
        "w (Δτ² + Δα²) / Δt",
        "change of throttle τ and angle α of the action; depends on Δt",
    ),
    RewardTerm(
        "cross_track", 0.0, "1/(m s)", True, "w e Δt", "distance e from the middle line of the gate ahead"
    ),
    RewardTerm(
        "energy",
        0.0,
        "1/J",
        True,
        "w P Δt",
        "kinetic power P that the jets leave in the water, as evaluation reports it",
    ),
)
FURTHER = ("cross_track", "energy")
"""Terms that are only worked out where they have a weight."""
DEFAULTS = {term.name: term.weight for term in REWARD}


@compiled
def reward(
    world: Any,
    way_made: float,
    gates: int,
    succeeded: bool,
    failed: bool,
    throttle: float,
    throttle_rate: float,
    angle_rate: float,
) -> float:
    """The terms of a step that depend on the action and the course; `REWARD` has the equations.

    world: the record with the weights and the step dt [s]; way_made: decrease of `distance_to_go` [m];
    gates: passed in this step; throttle: of the step [1]; throttle_rate, angle_rate: changes of the levers
    since the step before, by dt [1/s]. Effort is an integral over time, the same at any step. Change is the
    integral of the squared rates only of levers that vary smoothly; a jump by d costs w d²/dt.
    """
    effort = world.reward_effort * throttle * throttle
    change = world.reward_change * (throttle_rate * throttle_rate + angle_rate * angle_rate)
    gained = world.reward_progress * way_made + world.reward_gate * gates
    if succeeded:
        gained += world.reward_success
    spent = (effort + change + world.reward_time) * world.step
    return gained - spent - (world.reward_failure if failed else 0.0)


@compiled
def further_costs(world: Any, state: Any, gate: Any) -> float:
    """The terms FURTHER of a step that ended in `state` (S,); gate: the row of `gate_table` that was ahead.

    The power is that of `swamp_rl.evaluation.metrics.jet_power` at the bollard thrust of what the pumps do.
    """
    north, east = state[NORTH] - gate[GATE_NORTH], state[EAST] - gate[GATE_EAST]
    off = abs(east * gate[GATE_COS] - north * gate[GATE_SIN])
    power, thrusters = 0.0, world.thrust_linear.shape[0]
    for k in range(thrusters):
        throttle = state[ACTUATORS + thrusters + k]
        force = abs(world.thrust_linear[k] * throttle + world.thrust_quadratic[k] * throttle * abs(throttle))
        power += 0.5 * force * math.sqrt(force / world.jet_flow[k])
    return (world.reward_cross_track * off + world.reward_energy * power) * world.step


def weights_of(given: Mapping[str, Any] | None) -> dict[str, float]:
    """The weight of every built-in term, then of one's own; what is not given has its default.

    UserError for a name that is none and for a weight that is not a finite number.
    """
    if given is None:
        given = {}
    refuse_function("reward", given)
    if not isinstance(given, Mapping):
        raise UserError(f"reward: must be weights by name of the term, not {given!r}")
    for name, weight in given.items():
        refuse_function("reward", name)
        if name not in DEFAULTS and not is_code(name):
            known = [f"{term.name} [{term.unit}]" for term in REWARD]
            hint = nearest(str(name), DEFAULTS).partition(" known here")[0]
            raise UserError(f"reward: no term {name!r}{hint} known here: {', '.join(known)}, module:function")
        if not is_number(weight):
            raise UserError(f"reward: {name}: the weight must be a finite number, not {weight!r}")
    return {**DEFAULTS, **{name: float(weight) for name, weight in given.items()}}
