"""What is the same for all boats of an environment, as the record that the compiled step reads."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.reward import FURTHER, REWARD
from swamp_rl.envs.task import Task

from swamp_rl.boat.fixed_lever import fixed_lever
from swamp_rl.errors import UserError
from swamp_rl.evaluation.metrics import jet_areas
from swamp_rl.simulator.parameters import parameters
from swamp_rl.simulator.substeps import substeps_of

LEVER_COLUMNS = ("middle", "swing", "least", "most", "idle", "gain", "turn", "low", "high")


@lru_cache(maxsize=64)
def world_record(thrusters: int) -> np.dtype[np.void]:
    """What is the same for all boats; K thrusters."""
    numbers = ("step", "reach", "south_edge", "north_edge", "west_edge", "east_edge")  # s, then m
    return np.dtype(
        [(name, np.float64) for name in numbers]
        + [("substeps", np.int64), ("last_tick", np.int64)]
        + [(f"reward_{term.name}", np.float64) for term in REWARD]  # weights
        + [("costs_further", np.int64), ("looks_further", np.int64)]  # 1 where any of these has a use
        # A thruster's azimuth [rad] is middle + swing times the angle's lever, within least and most; its
        # throttle idle + gain times the other + turn times the angle's, within low and high.
        + [(f"lever_{name}", np.float64, (thrusters,)) for name in LEVER_COLUMNS]
        + [("thrust_linear", np.float64, (thrusters,)), ("thrust_quadratic", np.float64, (thrusters,))]  # N
        + [("jet_flow", np.float64, (thrusters,))]  # density of the water times the jets' areas [kg/m]
    )


def world_of(task: Task) -> NDArray[np.void]:
    """The `world_record` (1,) of a task; UserError where the boat does not fit through a gate."""
    boat, course, step = task.boat, task.course, task.step
    reach = course.buoy_radius + 0.5 * boat.breadth
    for gate in course.gates:
        if gate.width <= 2.0 * reach:
            raise UserError(
                f"course {course.name}: gate {gate.name} is {gate.width:g} m wide, but boat {boat.name} "
                f"and the buoys need more than {2.0 * reach:g} m; choose a wider gate or a narrower boat"
            )
    world = np.zeros(1, world_record(len(boat.thrusters)))
    world["step"], world["substeps"] = step, substeps_of(step, boat)
    world["last_tick"] = task.last_tick
    for name, weight in task.weights.items():
        world[f"reward_{name}"] = weight
    world["costs_further"] = any(task.weights[name] for name in FURTHER)
    world["looks_further"] = task.observed.further
    world["jet_flow"] = boat.water_density * jet_areas(boat)
    world["reach"] = reach
    for edge in ("south", "north", "west", "east"):
        world[f"{edge}_edge"] = getattr(course.bounds, edge)
    limits = parameters(boat)
    world["lever_least"], world["lever_most"] = limits["azimuth_min"], limits["azimuth_max"]
    low_azimuth, high_azimuth = boat.joypad.azimuth
    low_throttle, high_throttle = boat.joypad.throttle
    for k, thruster in enumerate(boat.thrusters):
        linear, quadratic = thruster.thrust_curve(boat.water_density)
        world["thrust_linear"][0, k], world["thrust_quadratic"][0, k] = linear, quadratic
        full = thruster.throttle_max  # 1, or the propeller's revolutions
        world["lever_low"][0, k], world["lever_high"][0, k] = thruster.throttle_min, full
        if thruster.name not in boat.joypad.thrusters:
            continue
        world["lever_idle"][0, k] = low_throttle * full
        world["lever_gain"][0, k] = (high_throttle - low_throttle) * full
        if thruster.kind == "fixed":
            ahead, turn = fixed_lever(thruster)
            world["lever_middle"][0, k] = thruster.azimuth_min
            world["lever_idle"][0, k] *= ahead
            world["lever_gain"][0, k] *= ahead
            world["lever_turn"][0, k] = turn * high_throttle
        else:
            # Aft of midship a jet has to push the other way for the bow to go where the lever goes.
            side = -1.0 if thruster.kind == "azimuth" and thruster.x < 0.0 else 1.0
            world["lever_middle"][0, k] = side * 0.5 * (low_azimuth + high_azimuth)
            world["lever_swing"][0, k] = side * 0.5 * (high_azimuth - low_azimuth)
    return world
