"""Compiled simulation of many windows, and the whitening filter of Gauss-Markov noise."""

from typing import Any

import numpy as np

from swamp_rl.criticism.options import options
from swamp_rl.criticism.threads import divided
from swamp_rl.physics.compile import compiled, still_used, uncounted
from swamp_rl.physics.force_curve import JET
from swamp_rl.physics.motion import constants_of
from swamp_rl.simulator.delay import delayed_command
from swamp_rl.simulator.state import SURGE, TIME
from swamp_rl.simulator.step import continue_alike, forget_outputs, move_actuators, take_weather


def roll(
    params: Any,
    which: Any,
    tank: Any,
    start: Any,
    commands: Any,
    weather: Any,
    run: Any,
    first: Any,
    steps: Any,
    seeds: Any,
    dt: float,
    substeps: int,
    parts: int,
    acceleration: Any,
    block: int,
    track: Any,
) -> None:
    """Fill track (V W, T + 1, 6) with the rigid motion of V variants of W windows, the start first.

    params: (m,) records; which: (V W,) the record of each boat, or (W,) of each window, whose variants then
    start with the same actuators and are simulated side by side, the actuators once; start: (V W, S) states;
    commands: (R, samples parts, 2K), one for each of the equal parts of a sample's step; weather: (R or 0,
    samples, 3), rows of `take_weather`; run, first, steps: (W,) run, first sample and number of steps of
    dt [s]; the last state is repeated beyond; seeds: as many as which. acceleration: (V W or 0, B, 3) added
    acceleration [m/s2, m/s2, rad/s2] of surge, sway and yaw, each for `block` steps; half of a step's share
    before the step and half after (Strang splitting).
    """
    commands, weather = np.ascontiguousarray(commands), np.ascontiguousarray(weather)
    where = commands, weather, run, first, steps, seeds, dt, substeps, parts, acceleration, block, track

    def part(mine: slice) -> None:
        _roll(params, which, tank, start, *where, mine.start, mine.stop)

    every = int(steps.sum()) * (len(start) // len(run)) * substeps
    divided(part, len(which), every)


def roll_actuators(params: Any, start: Any, commands: Any, run: Any, dt: float, states: Any) -> None:
    """Fill states (n, T, S - 6) with time and actuators of whole runs; they depend on the commands alone."""

    commands = np.ascontiguousarray(commands)

    def part(mine: slice) -> None:
        _roll_actuators(params[mine], start[mine], commands, run[mine], dt, states[mine])

    divided(part, len(start), states.shape[0] * states.shape[1] // options().actuator_share)


@compiled(threaded=True)
def _roll(
    params: Any,
    which: Any,
    tank: Any,
    start: Any,
    commands: Any,
    weather: Any,
    run: Any,
    first: Any,
    steps: Any,
    seeds: Any,
    dt: float,
    substeps: int,
    parts: int,
    acceleration: Any,
    block: int,
    track: Any,
    begin: int,
    end: int,
) -> None:
    groups, windows = which.shape[0], run.shape[0]
    alike = start.shape[0] // groups
    room = np.empty((3, commands.shape[2] // 2, JET)), np.empty(start.shape[1]), np.empty(commands.shape[2])
    jets, state, arrived = uncounted(room[0]), uncounted(room[1]), uncounted(room[2])
    moved, own = np.empty((alike, 6)), params[:1].copy()
    rigid = uncounted(moved)
    given, measured, curves, filled = (
        uncounted(commands),
        uncounted(weather),
        uncounted(tank),
        uncounted(track),
    )
    accelerated = acceleration.shape[0] > 0
    h, finer = dt / parts, (substeps + parts - 1) // parts
    for g in range(begin, end):
        own[0] = params[which[g]]
        w = g % windows
        forget_outputs(jets)
        for c in range(start.shape[1]):  # no slice: numba would compile its error's text as well
            state[c] = start[g, c]
        for v in range(alike):
            for c in range(6):
                rigid[v, c] = start[v * groups + g, c]
                filled[v * groups + g, 0, c] = rigid[v, c]
        constants = constants_of(own[0], curves)
        for j in range(track.shape[1] - 1):
            if j < steps[w]:
                part = min(j // block, acceleration.shape[1] - 1)
                if accelerated:
                    for v in range(alike):
                        for c in range(3):
                            rigid[v, SURGE + c] += 0.5 * dt * acceleration[v * groups + g, part, c]
                if weather.shape[0] > 0:
                    take_weather(own[0], measured[run[w], min(first[w] + j, weather.shape[1] - 1)])
                    constants = constants_of(own[0], curves)
                for q in range(parts):
                    row = min((first[w] + j) * parts + q, commands.shape[1] - 1)
                    delayed_command(given[run[w]], row, own[0].command_delay / h, arrived)
                    continue_alike(state, rigid, own[0], curves, arrived, seeds[g], h, finer, jets, constants)
                if accelerated:
                    for v in range(alike):
                        for c in range(3):
                            rigid[v, SURGE + c] += 0.5 * dt * acceleration[v * groups + g, part, c]
            for v in range(alike):
                for c in range(6):
                    filled[v * groups + g, j + 1, c] = rigid[v, c]
    still_used(room)
    still_used(moved)


@compiled(threaded=True)
def _roll_actuators(params: Any, start: Any, commands: Any, run: Any, dt: float, states: Any) -> None:
    room = np.empty((3, commands.shape[2] // 2, JET)), np.empty(start.shape[1]), np.empty(commands.shape[2])
    jets, state, arrived = uncounted(room[0]), uncounted(room[1]), uncounted(room[2])
    given = uncounted(commands)
    for i in range(start.shape[0]):
        forget_outputs(jets)
        for c in range(start.shape[1]):
            state[c] = start[i, c]
        for j in range(states.shape[1]):
            for c in range(states.shape[2]):
                states[i, j, c] = state[6 + c]
            delayed_command(given[run[i]], j, params[i].command_delay / dt, arrived)
            move_actuators(state, arrived, dt, jets, params[i])
            state[TIME] += dt
    still_used(room)


@compiled(entry=True)
def whiten(values: Any, keep: Any, gain: Any, scale: Any) -> None:
    """Replace standardised values (V, W, T, C) by innovations, in channels with a Gauss-Markov part.

    keep: (C,) its autocorrelation over one step, 0 where there is none; gain, scale: (W, T, C).
    """
    for v in range(values.shape[0]):
        for w in range(values.shape[1]):
            for c in range(values.shape[3]):
                if keep[c] == 0.0:
                    continue
                wandered = 0.0
                for t in range(values.shape[2]):
                    wandered *= keep[c]
                    if scale[w, t, c] > 0.0:
                        innovation = values[v, w, t, c] - wandered
                        values[v, w, t, c] = innovation * scale[w, t, c]
                        wandered += gain[w, t, c] * innovation


@compiled(entry=True)
def filter_gains(power: Any, white: Any, keep: Any, seen: Any, gain: Any, scale: Any) -> None:
    """Fill gain and 1 / innovation standard deviation (W, T, C) of the Kalman filter that `whiten` runs.

    power, white: (C,) variances of the Gauss-Markov and of the white part; keep: (C,); seen: (W, T, C).
    """
    for w in range(seen.shape[0]):
        for c in range(seen.shape[2]):
            unknown = power[c]
            for t in range(seen.shape[1]):
                if t > 0:
                    unknown = keep[c] * keep[c] * unknown + (1.0 - keep[c] * keep[c]) * power[c]
                if seen[w, t, c]:
                    gain[w, t, c] = unknown / (unknown + white[c])
                    scale[w, t, c] = 1.0 / np.sqrt(unknown + white[c])
                    unknown *= 1.0 - gain[w, t, c]
