"""A pilot by reservoir computing, as at Camogli (thesis 7.3.3): an echo state network and its ridge readout.

reservoirpy draws the reservoir. Training passes all runs through it in one batch; the pilot needs only the
matrices. Both use NumPy and SciPy.
"""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field
from scipy.sparse import csr_array

from swamp_rl.errors import SettingsError
from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.arrays import HIGHEST, LOWEST, Array, checked, checked_count, times
from swamp_rl.pilots.demonstrations import POSE, examples, rows_to_learn
from swamp_rl.pilots.divergence import refuse_diverged
from swamp_rl.pilots.readout import Moments, RecursiveReadout, ridge_readout, variance_matched
from swamp_rl.pilots.settings import (
    IN_ORDER,
    NotNegative,
    Positive,
    Seconds,
    Seed,
    Settings,
    Share,
    Width,
)
from swamp_rl.runs import Run

POSITION = ("north", "east")
ANGLES = ("cos_heading", "sin_heading", "gate_cos", "gate_sin")
Units = Annotated[Width, Field(ge=3)]
"Three or more: SciPy computes no eigenvalue of a smaller sparse matrix."


class ReservoirSettings(Settings):
    """The defaults were chosen on episodes of seeds from 1,000,000 on, which no experiment evaluates."""

    senses: tuple[str, ...] = POSE
    units: Units = 200
    spectral_radius: NotNegative = 0.5
    leak: Annotated[tuple[Share, Share], IN_ORDER] = (0.05, 1.0)
    "Range of the units' leak rates, log-uniform: memories from one step to some seconds."
    connectivity: Share = 0.1
    "Share of the units that a unit is connected to."
    position_scaling: Positive = 4.0
    "Input weights of positions, scaled to [-1, 1]."
    input_scaling: Positive = 1.5
    "Input weights of all other inputs."
    ridge: Positive = 3.0
    noise: NotNegative = 0.0
    "Standard deviation of the noise on the scaled inputs in training."
    washout: Annotated[int, Field(ge=0, le=10**6)] = 0
    "Samples at the start of each run that are left out of the regression."
    reaction: Seconds = 0.0
    """Reaction time [s] of the logged driver: the levers are shifted by it. 0 performs best, since the
    reservoir's memory represents the delay."""
    forgetting: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    """Forgetting factor of recursive least squares over the rows in the order of the runs; 1.0 gives the
    batch solution, None (the default) computes it at once."""
    matched: bool = True
    """Whether each lever's mean square is matched to the demonstrations' (`readout.variance_matched`). Where
    drivers push the lever from end to end, the ridge readout alone steers too little."""
    seed: Seed = 0

    def check_runs(self, runs: Sequence[Run]) -> None:
        """Raise SettingsError as `rows_to_learn`."""
        rows_to_learn(runs, self.reaction, self.washout)


class ReservoirPilot:
    """One reservoir for all boats, with a state (n, units) that is zero where a boat starts its run."""

    kind: ClassVar[str] = "reservoir"

    def __init__(self, senses: Sequence[str], weights: dict[str, Array]) -> None:
        """weights: centre, scale (d,), W (units, units), Win (units, d), bias, leak (units,), Wout (units, 2)
        and out (2,).

        ValueError where their shapes do not agree.
        """
        self.senses = tuple(senses)
        self._weights = {name: np.asarray(weights[name], dtype=np.float64) for name in _NAMES}
        self._check_shapes()
        w = self._weights
        # The matrix is sparse, and a sparse sum has one order whatever the number of boats.
        self._recurrent = csr_array(w["W"])
        # Boats are rows, so the input matrix is transposed; it includes the scaling of the inputs.
        self._input = np.ascontiguousarray((w["Win"] / w["scale"]).T)
        self._constant = w["bias"] - (w["centre"] / w["scale"]) @ w["Win"].T
        self.reset(0)

    def reset(self, n: int) -> None:
        """Set the number of boats to n and all states to zero."""
        self.state = np.zeros((checked_count(n), len(self._constant)))

    def reset_boats(self, mask: Array) -> None:
        """Set the states of the boats of `mask` (n,) to zero."""
        self.state[np.asarray(mask, dtype=bool)] = 0.0

    def keep(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,)."""
        self.state = self.state[boats]

    def act(self, observation: Array) -> Array:
        """Levers (n, 2) from the observation (n, d); advances the states by one step."""
        seen = checked(observation, self.senses, len(self.state))
        drive = np.ascontiguousarray((self._recurrent @ self.state.T).T)
        drive += times(seen, self._input)
        drive += self._constant
        np.tanh(drive, out=drive)
        drive -= self.state
        drive *= self._weights["leak"]
        self.state += drive
        levers = times(self.state, self._weights["Wout"])
        levers += self._weights["out"]
        return np.minimum(np.maximum(levers, LOWEST), HIGHEST)

    def settings(self) -> dict[str, Any]:
        """The senses."""
        return {"senses": list(self.senses)}

    def weights(self) -> dict[str, Array]:
        """Return the weights, as given to the constructor."""
        return self._weights

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "ReservoirPilot":
        """The pilot of `settings()` and `weights()`."""
        return cls(settings["senses"], weights)

    def _check_shapes(self) -> None:
        d, units = len(self.senses), len(self._weights["bias"])
        shapes = ((d,), (d,), (units, units), (units, d), (units,), (units,), (units, 2), (2,))
        for name, shape in zip(_NAMES, shapes, strict=True):
            if self._weights[name].shape != shape:
                raise ValueError(f"{name} has the shape {self._weights[name].shape}, {shape} is needed")


_NAMES = ("centre", "scale", "W", "Win", "bias", "leak", "Wout", "out")


@one_thread()
def fit_reservoir(runs: Sequence[Run], settings: ReservoirSettings | None = None) -> ReservoirPilot:
    """Return a pilot with a readout fitted by ridge regression to `runs`.

    UserError for a missing column, SettingsError where no row is left or the regression has no solution.
    """
    settings = settings or ReservoirSettings()
    matrices, states, levers = states_of(runs, settings)
    moments = Moments.of(states, levers)
    if settings.forgetting is None:
        readout = ridge_readout(moments, settings.ridge)
    else:
        online = RecursiveReadout(settings.units, settings.ridge, settings.forgetting)
        for row in zip(np.concatenate(states), np.concatenate(levers), strict=True):
            online.learn(*row)
        readout = online.readout
        refuse_diverged([readout], "raise forgetting or ridge")
    if settings.matched:
        readout = variance_matched(readout, moments)
    return ReservoirPilot(settings.senses, {**matrices, "Wout": readout[:-1], "out": readout[-1]})


def states_of(
    runs: Sequence[Run], settings: ReservoirSettings
) -> tuple[dict[str, Array], list[Array], list[Array]]:
    """Return a reservoir's matrices, and for each run states (T, units) and levers (T, 2) of the regression.

    These are the rows after the washout whose levers are demonstrations.
    """
    observations, levers, rows = examples(runs, settings.senses, settings.reaction, settings.washout)
    centre, scale = _scaling(observations, settings.senses)
    rng = np.random.default_rng(settings.seed)
    matrices = _matrices(reservoir_node(settings, rng))
    inputs = [(observation - centre) / scale for observation in observations]
    inputs = [x + settings.noise * rng.standard_normal(x.shape) for x in inputs]
    states = [x[kept] for x, kept in zip(states_along(matrices, inputs), rows, strict=True)]
    levers = [y[kept] for y, kept in zip(levers, rows, strict=True)]
    return {"centre": centre, "scale": scale, **matrices}, states, levers


def states_along(matrices: dict[str, Array], inputs: Sequence[Array]) -> list[Array]:
    """Return the states (T, units) along the scaled inputs (T, d) of each run, from zero, in one batch.

    x ← x + leak (tanh(W x + Win u + bias) − x) (Jaeger and others 2007).
    """
    longest_first = np.argsort([-len(run) for run in inputs], kind="stable")
    lengths = np.array([len(inputs[i]) for i in longest_first])
    recurrent, leak = np.ascontiguousarray(matrices["W"].T), matrices["leak"]
    states = np.zeros((lengths[0], len(inputs), len(leak)))
    for row, i in enumerate(longest_first):
        states[: lengths[row], row] = inputs[i] @ matrices["Win"].T + matrices["bias"]
    state = np.zeros(states.shape[1:])
    for t in range(lengths[0]):
        going = int(np.searchsorted(-lengths, -t))
        now = state[:going]
        now += leak * (np.tanh(now @ recurrent + states[t, :going]) - now)
        states[t, :going] = now
    return [states[: len(run), row] for run, row in zip(inputs, np.argsort(longest_first), strict=True)]


def untrained_reservoir(
    rng: np.random.Generator, settings: ReservoirSettings | None = None
) -> ReservoirPilot:
    """Return a pilot of the same size with a readout of zeros, to measure its speed."""
    settings = settings or ReservoirSettings()
    d = len(settings.senses)
    reservoir = reservoir_node(settings, rng)
    readout = {"Wout": np.zeros((settings.units, 2)), "out": np.zeros(2)}
    neutral = {"centre": np.zeros(d), "scale": np.ones(d)}
    return ReservoirPilot(settings.senses, {**neutral, **_matrices(reservoir), **readout})


def reservoir_node(settings: ReservoirSettings, rng: np.random.Generator) -> Any:
    """Draw a reservoirpy Reservoir: every unit receives all inputs; leak rates are log-uniform.

    SettingsError where no unit is connected to another.
    """
    import reservoirpy
    from scipy.sparse.linalg import ArpackError

    _remove_cache(reservoirpy)
    low, high = np.log(np.maximum(settings.leak, 1e-6))
    gains = [
        settings.position_scaling if name in POSITION else settings.input_scaling for name in settings.senses
    ]
    reservoir = reservoirpy.nodes.Reservoir(
        units=settings.units,
        lr=np.exp(rng.uniform(low, high, settings.units)),
        sr=settings.spectral_radius,
        input_scaling=np.array(gains),
        input_connectivity=1.0,
        rc_connectivity=settings.connectivity,
        Win=reservoirpy.mat_gen.uniform,
        bias=reservoirpy.mat_gen.uniform,
        input_dim=len(settings.senses),
        seed=rng,
    )
    try:
        reservoir.initialize(np.zeros((1, len(settings.senses))))
    except ArpackError as error:
        raise SettingsError(
            f"connectivity: {settings.connectivity:g} connects too few of {settings.units} units; raise "
            "connectivity"
        ) from error
    return reservoir


def _remove_cache(reservoirpy: Any) -> None:
    """Remove the empty folder that reservoirpy leaves in the temporary directory when it is imported.

    It is the cache of its data sets, and made again where one is read.
    """
    folder = Path(getattr(reservoirpy, "_TEMPDIR", ""))
    if folder.name.startswith("reservoirpy-temp-"):
        with suppress(OSError):  # gone already, or in use
            folder.rmdir()


def _matrices(reservoir: Any) -> dict[str, Array]:
    """The arrays of an initialised reservoirpy Reservoir, dense."""
    dense = {name: getattr(reservoir, name) for name in ("W", "Win", "bias")}
    dense = {name: value.toarray() if hasattr(value, "toarray") else value for name, value in dense.items()}
    return {**dense, "bias": np.ravel(dense["bias"]), "leak": reservoir.lr}


def _scaling(observations: Sequence[Array], senses: Sequence[str]) -> tuple[Array, Array]:
    """Return centre and scale (d,) that map the observations to [-1, 1], north and east by one scale."""
    everything = np.concatenate(observations)
    low, high = everything.min(axis=0), everything.max(axis=0)
    centre, scale = 0.5 * (low + high), np.maximum(0.5 * (high - low), 1e-9)
    position = np.isin(senses, POSITION)
    if position.any():
        scale[position] = scale[position].max()
    angles = np.isin(senses, ANGLES)
    centre[angles], scale[angles] = 0.0, 1.0
    return centre, scale
