"""Predictions that need no model, which a boat file must be better than."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.prediction_error import Errors, Restarts, errors_at, errors_of
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Predictors

Array = NDArray[np.float64]


def trivial_predictors(run_set: RunSet, weight: Array) -> list[Predictors]:
    """Position errors of the boat file and of three trivial predictors at every horizon that the runs hold.

    weight: (R, T, 6).
    """
    found = []
    for horizon in options().horizons:
        own = _of_boat_file(run_set, weight, horizon)
        if not np.isfinite(own.error[:, :2]).all(axis=1).any():
            continue
        found.append(
            Predictors(
                horizon_s=horizon,
                boat_file=_rmse(own),
                at_rest=_rmse(errors_of(run_set, weight, horizon, _at_rest)),
                constant_velocity=_rmse(errors_of(run_set, weight, horizon, _constant_velocity)),
                no_thrust=_rmse(_of_boat_file(_without_thrust(run_set), weight, horizon)),
            )
        )
    return found


def _of_boat_file(run_set: RunSet, weight: Array, horizon: float) -> Errors:
    return errors_at(run_set, weight, horizon, Hypothesis(), np.zeros((len(run_set.lengths), 0)))


def _at_rest(run: int, start: Restarts) -> Array:
    """(n, 6): the boat stays where it is."""
    return np.concatenate([start.states[:, :3], np.zeros((len(start.states), 3))], axis=1)


def _constant_velocity(run: int, start: Restarts) -> Array:
    """(n, 6): straight on at the velocity over ground, turning at the yaw rate."""
    states = start.states.copy()
    seconds = start.steps * start.problem.dt
    cos, sin = np.cos(states[:, 2]), np.sin(states[:, 2])
    surge, sway, yaw_rate = states[:, 3:].T
    states[:, 0] += seconds * (surge * cos - sway * sin)
    states[:, 1] += seconds * (surge * sin + sway * cos)
    states[:, 2] += seconds * yaw_rate
    return states


def _without_thrust(run_set: RunSet) -> RunSet:
    commands = run_set.commands.copy()
    commands[..., commands.shape[2] // 2 :] = 0.0
    return replace(run_set, commands=commands)


def _rmse(errors: Errors) -> float:
    """Root mean square of the distance [m]."""
    squares = (errors.error[:, :2] ** 2).sum(axis=1)
    return float(np.sqrt(np.nanmean(squares)))
