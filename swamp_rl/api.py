"""Public functions on top of the library: simulate commands, carry out a manoeuvre, identify a boat."""

from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects.entries import is_number
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.files import validated
from swamp_rl.identification import elementary, yaw_model
from swamp_rl.identification.deduction import deduction_points, point_doubt
from swamp_rl.identification.estimate import Estimate
from swamp_rl.identification.motion import Motion, motions_of
from swamp_rl.identification.simulated import record_run
from swamp_rl.manoeuvres.analysis.analyse import analyse_run
from swamp_rl.manoeuvres.analysis.figure import Result
from swamp_rl.manoeuvres.execute import execute
from swamp_rl.manoeuvres.plan import Plan
from swamp_rl.manoeuvres.record import runs_of_trials
from swamp_rl.runs import Dataset, Run, read_dataset
from swamp_rl.runs.check import check_column
from swamp_rl.runs.table import Table
from swamp_rl.simulator.replay import replay
from swamp_rl.whole_number import whole_number

Model = Literal["yaw-model", "elementary", "thrust-deduction"]
LISTED = ("throttle", "rpm", "angle_deg", "heading_deg")
"Keys of a trial that are lists; a lone number is a list of one."
NOISELESS = np.zeros(6)
NEEDED = {
    "elementary": "runs straight ahead, or turns on the spot, with steps of thrust",
    "thrust-deduction": "straight runs of a steady speed, ahead and astern",
}


class Identified(NamedTuple):
    """A number of a boat with its 95 % interval; doubt: why the runs do not show it, None where they do."""

    name: str
    value: float
    low: float
    high: float
    unit: str
    doubt: str | None


def simulate(boat: Boat | str | Path, commands: Run | ArrayLike, step: float = 0.1, seed: int = 0) -> Run:
    """Simulate a boat with its effects under commands; return the run.

    - `boat`: a boat, or the name or path of its file.
    - `commands`: (T, 2K) for K thrusters in the boat file's order: K azimuths or rudder angles [rad], then K
      throttles [1], of a propeller with a rudder revolutions [rps]. Each row is held for `step` [s]; the
      boat starts at rest at the origin, heading north. Or a run: its commands are replayed from its first
      state at its own times.
    - `seed`: of random effects, such as gusts.

    The columns of the result are those of the run format, (T,) each. UserError if the commands are not those
    of this boat, or if a value is out of range, as in percent or degrees. The limits are the boat's for an
    array, with rows counted from 0; for a run they are those of any boat, with rows counted from 1.
    """
    vessel, seed = _loaded(boat), whole_number("simulate: seed", seed, 0)
    if isinstance(commands, Run):
        given = commands.columns
        named = {name: given[name] for name in _columns(vessel) if name in given}
        _refuse_out_of_range(named, given.get("time"), None, 1)
        return replay(vessel, commands)
    if not (is_number(step) and 0.0 < step <= 10.0):
        raise UserError(f"simulate: step must be above 0 and at most 10 s, not {step!r}")
    rows = _commands(vessel, commands, step)
    return record_run(vessel, rows, step, NOISELESS, np.random.default_rng(seed), "simulated")


def trial(
    manoeuvre: str, boat: Boat | str | Path = "swamp", seed: int = 0, **entry: Any
) -> list[tuple[Run, Result]]:
    """Simulate a sea trial in closed loop; return (run, result) for each angle and throttle.

    - `manoeuvre`: turning-circle, zig-zag, spiral, reverse-spiral, pull-out, stopping or straight.
    - `boat`: a boat, or the name or path of its file.
    - `entry`: keys of an entry of a plan file, such as throttle=0.6 (share of full), angle_deg=[20, 30]
      (degrees, positive: first to starboard).

    Each figure of a result has a unit, a value and a 95 % interval. UserError if a key is wrong or the boat
    cannot do the manoeuvre.
    """
    entry = {key: [value] if key in LISTED and is_number(value) else value for key, value in entry.items()}
    vessel = _loaded(boat)
    data = {"name": "asked", "boat": vessel.name, "seed": seed, "trials": [{"manoeuvre": manoeuvre, **entry}]}
    plan = validated("trial", Plan, data)
    done = execute(vessel, plan.singly, plan.place, plan.seed)
    return [(run, analyse_run(run, vessel)) for run in runs_of_trials(done, vessel, plan.seed)]


def identify(
    runs: Dataset | str | Path,
    model: Model = "yaw-model",
    boat: Boat | str | Path | None = None,
    smooth: float = 0.0,
) -> list[Identified]:
    """Identify parameters of a boat from recorded runs by the regressions of the papers
    (docs/identification.md).

    - `runs`: a dataset or its folder.
    - `model`: `yaw-model` (k_r, c_ru, c_rv, b_r), `elementary` (mass and quadratic drag in surge and yaw) or
      `thrust-deduction` (1 - t at each throttle of straight runs).
    - `boat`: a boat, or its name or file, in place of the dataset's; needed for a folder without
      dataset.yaml.
    - `smooth`: span of a quadratic smoother [s]; 0: none.

    The 95 % intervals contain the scatter of the method, not its bias. UserError if nothing can be
    identified.
    """
    if model not in get_args(Model):
        raise UserError(f"identify: unknown model {model!r}{nearest(str(model), get_args(Model))}")
    file = None if isinstance(boat, Boat) else boat
    dataset = runs if isinstance(runs, Dataset) else read_dataset(runs, file)
    vessel = dataset.boat if boat is None else _loaded(boat)
    motion = motions_of(dataset.runs, vessel, smooth)
    if model == "yaw-model":
        _, found = yaw_model.by_pseudo_inverse(motion, vessel.inertia_z)
        doubts = yaw_model.yaw_model_doubts(motion, found)
        return [_named(*one) for one in zip(yaw_model.NAMES, found, doubts, strict=True)]
    named = _deductions(motion, vessel) if model == "thrust-deduction" else _elementary(motion, vessel)
    if not named:
        raise UserError(f"identify: {dataset.folder} has no run for {model}; record {NEEDED[model]}")
    return named


def _loaded(boat: Boat | str | Path) -> Boat:
    return boat if isinstance(boat, Boat) else load_boat(boat)


def _deductions(motion: Motion, boat: Boat) -> list[Identified]:
    return [
        Identified(
            f"1 - t at throttle {one.throttle:.2f} {'ahead' if one.ahead else 'astern'}",
            one.factor,
            one.low,
            one.high,
            "1",
            point_doubt(one, boat),
        )
        for one in deduction_points(motion, boat)
    ]


def _elementary(motion: Motion, boat: Boat) -> list[Identified]:
    axes = {
        "surge": (elementary.identify_surge, elementary.surge_doubts),
        "yaw": (elementary.identify_yaw, elementary.yaw_doubts),
    }
    named = []
    for axis, (fit, doubts_of) in axes.items():
        if elementary.lacking(motion, axis) is None:
            found = fit(motion, boat)
            names = [f"{axis} {name}" for name in elementary.NAMES]
            named += [_named(*one) for one in zip(names, found, doubts_of(motion, found), strict=True)]
    return named


def _named(name: str, one: Estimate, doubt: str | None) -> Identified:
    return Identified(name, one.value, one.low, one.high, one.unit, doubt)


def _commands(boat: Boat, given: ArrayLike, step: float) -> NDArray[np.float64]:
    wanted = 2 * len(boat.thrusters)
    try:
        rows = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UserError(f"simulate: commands are not an array of numbers ({error})") from error
    if rows.ndim != 2 or rows.shape[1] != wanted or len(rows) < 2:
        raise UserError(
            f"simulate: commands must be (T, {wanted}), T at least 2, for {boat.name}'s thrusters "
            f"{', '.join(boat.thruster_names)}; they are {rows.shape}"
        )
    if not np.isfinite(rows).all():
        row, column = np.argwhere(~np.isfinite(rows))[0]
        raise UserError(f"simulate: commands: row {row}, column {column} is not a finite number")
    named = {name: rows[:, j] for name, j in _columns(boat).items()}
    _refuse_out_of_range(named, step * np.arange(len(rows), dtype=np.float64), boat, 0)
    return rows


def _columns(boat: Boat) -> dict[str, int]:
    """The place of each command in a row (2K,), by its column in a run; a fixed thruster has no azimuth."""
    angles, levels = zip(*(thruster.command_columns for thruster in boat.thrusters), strict=True)
    return {name: j for j, name in enumerate((*angles, *levels)) if name is not None}


def _refuse_out_of_range(
    columns: dict[str, NDArray[np.float64]], time: NDArray[np.float64] | None, boat: Boat | None, first: int
) -> None:
    """UserError for the first value that a dataset may not hold.

    time: (T,) [s] of the rows, if known; first: the number of the first.
    """
    numbers = first + np.arange(max(map(len, columns.values()), default=0))
    table = Table(columns if time is None else columns | {"time": time}, numbers)
    for name in columns:
        for fault in check_column("simulate: commands", name, table, boat):
            raise UserError(str(fault))
