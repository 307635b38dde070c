"""The boat's equations of motion and their integration over one substep (Runge-Kutta of order four)."""

import math
from typing import Any

from swamp_rl.physics.air_and_current import current_push, wind_push
from swamp_rl.physics.compile import compiled
from swamp_rl.physics.force_curve import COMPONENT, curve_forces
from swamp_rl.physics.hull import hull_forces
from swamp_rl.physics.propulsion import propulsion_forces
from swamp_rl.physics.resistance import towing
from swamp_rl.physics.rigid_body import accelerations, inverse_inertia

# The motion is a tuple of six numbers: north, east [m], heading [rad], surge, sway [m/s], yaw rate [rad/s],
# with surge and sway relative to the water.
Six = tuple[float, float, float, float, float, float]


@compiled
def current_at(time: float, p: Any) -> tuple[float, float]:
    """Current north and east [m/s] at `time` t [s]: V_0 + V' t."""
    return p.current_north + p.current_north_rate * time, p.current_east + p.current_east_rate * time


@compiled(entry=True)
def water_velocity(time: float, p: Any) -> tuple[float, float]:
    """Velocity north and east [m/s] of the water that the hull moves in at `time` [s].

    Water that gathers speed presses on a floating hull with just the force that takes the hull along, so the
    motion relative to it stays that of still water. With the thesis's current model (a force) the water
    stands still and `current_push` acts instead.
    """
    if p.current_as_force != 0.0:
        return 0.0, 0.0
    return current_at(time, p)


@compiled
def wave_push(time: float, p: Any) -> float:
    """Push [N] of one harmonic wave at `time` t [s], towards where it goes: F sin(2π f t + φ)."""
    return p.wave_force * math.sin(2.0 * math.pi * p.wave_frequency * time + p.wave_phase)


@compiled(entry=True)
def external_forces(
    cos: float, sin: float, u_ground: float, v_ground: float, time: float, wind: tuple[float, float], p: Any
) -> tuple[float, float, float]:
    """Wind, current-as-a-force, waves and steady push at `time` [s].

    cos, sin: of the heading; wind: north and east component [m/s] of where it comes from.
    """
    surge, sway, yaw = 0.0, 0.0, 0.0
    if wind[0] != 0.0 or wind[1] != 0.0:
        ahead = wind[0] * cos + wind[1] * sin
        starboard = wind[1] * cos - wind[0] * sin
        surge, sway, yaw = wind_push(u_ground, v_ground, ahead, starboard, p)
    if p.current_as_force != 0.0:
        current = current_at(time, p)
        if current[0] != 0.0 or current[1] != 0.0:
            ahead = current[0] * cos + current[1] * sin
            starboard = current[1] * cos - current[0] * sin
            x, y, n = current_push(u_ground, v_ground, ahead, starboard, p)
            surge, sway, yaw = surge + x, sway + y, yaw + n
    north, east = p.external_force_north, p.external_force_east
    if p.wave_force != 0.0:
        push = wave_push(time, p)
        north, east = north - push * math.cos(p.wave_from), east - push * math.sin(p.wave_from)
    surge += north * cos + east * sin
    sway += east * cos - north * sin
    return surge, sway, yaw


@compiled
def constants_of(p: Any, tank: Any) -> Any:
    """What `rates` needs of the record p alone: `towing` and `inverse_inertia`."""
    return towing(p, tank), inverse_inertia(p)


@compiled
def rates(
    motion: Any, jets: Any, moment: int, time: float, water: tuple[float, float], held: Any, p: Any, tank: Any
) -> Six:
    """Time derivatives of `motion` at `time` [s].

    jets[moment]: (K, JET) by `move_actuators`; water: its velocity then; held: the wind's components and
    `constants_of`, which a control step does not change.
    """
    wind, (tow, inverse) = held
    heading, u, v, r = motion[2], motion[3], motion[4], motion[5]
    cos, sin = math.cos(heading), math.sin(heading)
    u_ground = u + water[0] * cos + water[1] * sin
    v_ground = v + water[1] * cos - water[0] * sin
    x_hull, y_hull, n_hull = hull_forces(u, v, r, p, tank, tow)
    x_jets, y_jets, n_jets = propulsion_forces(jets, moment, u, v, r, p)
    x_out, y_out, n_out = external_forces(cos, sin, u_ground, v_ground, time, wind, p)
    if p.force_curves[0, COMPONENT] != 0.0:
        own: Any = curve_forces(motion, u_ground, v_ground, time, jets, moment, p)
        x_out, y_out, n_out = x_out + own[0], y_out + own[1], n_out + own[2]
    u_dot, v_dot, r_dot = accelerations(
        u, v, r, x_hull + x_jets + x_out, y_hull + y_jets + y_out, n_hull + n_jets + n_out, inverse, p
    )
    return (
        u * cos - v * sin + water[0],
        u * sin + v * cos + water[1],
        r,
        u_dot,
        v_dot,
        r_dot,
    )


@compiled
def moved(motion: Any, rate: Any, time: float) -> Six:
    """motion + time * rate, element by element."""
    return (
        motion[0] + time * rate[0],
        motion[1] + time * rate[1],
        motion[2] + time * rate[2],
        motion[3] + time * rate[3],
        motion[4] + time * rate[4],
        motion[5] + time * rate[5],
    )


@compiled
def runge_kutta_step(motion: Any, time: float, h: float, jets: Any, held: Any, p: Any, tank: Any) -> Six:
    """One classical fourth-order step of h [s] from `time` [s].

    jets: (3, K, JET), the outputs at 0, h/2 and h; held: as of `rates`.
    """
    drifts = p.current_north_rate != 0.0 or p.current_east_rate != 0.0
    water = water_velocity(time, p)
    rate, total = (0.0,) * 6, motion
    for stage in range(4):
        ahead = 0.5 * h * ((stage + 1) // 2)  # 0, h/2, h/2, h
        if drifts and ahead > 0.0:
            water = water_velocity(time + ahead, p)
        rate = rates(moved(motion, rate, ahead), jets, (stage + 1) // 2, time + ahead, water, held, p, tank)
        total = moved(total, rate, h / 6.0 if stage % 3 == 0 else h / 3.0)
    return total
