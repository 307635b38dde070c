"""Which term of the model serves the ship's circles and its windows of 30 s alike.

    python -m benchmarks.esso_osaka.terms ../shared/data/esso_osaka

Each is fitted to both in the measured wind, to half of the random runs and the circles of one month, and
judged on the other half, the other month and the zig-zags.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel
from scipy.optimize import least_squares
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.sway import FIGURES, errors
from benchmarks.esso_osaka.wind import HORIZON
from benchmarks.esso_osaka.windows import errors_at_end
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
from swamp_rl.criticism.likelihood.prediction_error import change
from swamp_rl.runs import Run
from swamp_rl.runs.free_running import import_free_running

Array = NDArray[np.float64]
Numbers = Mapping[str, float]

DERIVATIVES = {f"hull {name}": (0.76, 1.24) for name in ("x_vr", "y_v", "y_r", "n_v", "n_r")}  # 12 %, twice
LEVERS = {"hull c_ry": (0.05, 1.5), "hull c_rn": (0.05, 1.6)}
AIR = {f"wind {name}": (0.1, 2.0) for name in ("c_x", "c_y", "c_n")}
# Part, number and what the table calls it: a multiple of the boat file's, or 1 and its number where the file
# has none; with the bounds of the fit.
TERMS: dict[str, dict[str, tuple[float, float]]] = {
    "nothing": {},
    "sway drag": {"hull c_d": (0.0, 2.0)},
    "levers of the cross-flow drag": LEVERS,
    "coefficients of the wind": AIR,
    "levers and coefficients of the wind": LEVERS | AIR,
    "sway drag and coefficients of the wind": {"hull c_d": (0.0, 2.0)} | AIR,
    "hull derivatives": DERIVATIVES,
    "hull derivatives and levers": DERIVATIVES | LEVERS,
    "flow straightening that depends on drift": {"rudder drift_slope slope": (-1.0, 5.0)},
    "flow straightening and its lever": {
        "rudder gamma_p": (0.2, 2.5),
        "rudder gamma_n": (0.2, 2.5),
        "rudder flow_lever": (0.3, 2.0),
    },
    "rudder's force on the hull": {"rudder a_h": (0.0, 2.5), "rudder x_h": (0.0, 2.0)},
    "wake in drift": {"propeller wake_tau": (-1.0, 3.0), "propeller wake_c_p": (-2.0, 4.0)},
    "side force of the propeller": {"propeller side_share share": (0.7, 1.3)},
}
DIFFERENCE = 0.02  # of the finite differences, more than the steps of a figure that is read off a track
EVALUATIONS = 10
Halves = list[tuple[list[Run], list[Run]]]


def boat_with(boat: Boat, numbers: Numbers) -> Boat:
    """The boat with each number as in TERMS."""
    for key, value in numbers.items():
        where, name = key.split()[:2]
        if where in ("hull", "wind"):
            boat = boat.model_copy(update={where: _changed(getattr(boat, where), name, value)})
            continue
        (thruster,) = boat.thrusters
        part = {where: _changed(getattr(thruster, where), name, value)}
        boat = boat.model_copy(update={"thrusters": (thruster.model_copy(update=part),)})
    return boat


def _changed(part: BaseModel, name: str, value: float) -> BaseModel:
    """A part of the boat file with one number as in TERMS."""
    own = getattr(part, name)
    return part.model_copy(update={name: value * own if own else value - 1.0})


def windows(boat: Boat, runs: Sequence[Run]) -> list[Array]:
    """Of each run, position errors [m] at the end of its windows in the measured wind."""
    return [errors_at_end(boat, run, HORIZON, True) for run in runs]


def circles(boat: Boat, runs: Sequence[Run]) -> Array:
    """(figures, turns) by how much of the measured value each figure is off [1]."""
    return np.stack(list(errors(boat, runs).values())) / 100.0


def fitted(
    boat: Boat, term: Mapping[str, tuple[float, float]], random: list[Run], turning: list[Run]
) -> Numbers:
    """A term's numbers by least squares: windows and circles weigh alike, in units of the boat file's."""
    if not term:
        return {}

    def parts(one: Boat) -> list[Array]:
        return [np.concatenate(windows(one, random)), circles(one, turning).ravel()]

    units = [np.linalg.norm(part) for part in parts(boat)]

    def residual(x: Array) -> Array:
        made = parts(boat_with(boat, dict(zip(term, x, strict=True))))
        return np.concatenate([part / unit for part, unit in zip(made, units, strict=True)])

    low, high = np.array(list(term.values())).T
    found = least_squares(
        residual, np.ones(len(term)), bounds=(low, high), diff_step=DIFFERENCE, max_nfev=EVALUATIONS
    )
    return dict(zip(term, map(float, found.x), strict=True))


def halves(random: Sequence[Run], turning: Sequence[Run]) -> Halves:
    """Every other random run with the circles of one month."""
    months = sorted({run.name.split("-")[1] for run in turning})
    return [
        (list(random[i::2]), [run for run in turning if run.name.split("-")[1] == month])
        for i, month in enumerate(months)
    ]


def judged(boat: Boat, boats: Sequence[Boat], both: Halves, zigzags: Sequence[Run]) -> list[str]:
    """Cells of a term's row: held-out windows of each kind, and the circles' figures; boats: the boat as
    fitted to each half.
    """
    others = list(reversed(both))
    kinds = [[runs for runs, _ in others], [runs for _, runs in others], [list(zigzags)] * len(boats)]
    cells = []
    for kind in kinds:
        runs = [run for part in kind for run in part]
        before = windows(boat, runs)
        after = [made for one, part in zip(boats, kind, strict=True) for made in windows(one, part)]
        names = [run.name for made, run in zip(after, runs, strict=True) for _ in made]
        block = np.unique(names, return_inverse=True)[1]
        joined = [np.concatenate(each)[:, None] for each in (before, after)]
        paired = change(joined[0], joined[1], block, np.random.default_rng(0))
        assert paired is not None  # several runs of each kind
        low, high = paired.ci95
        cells.append(f"{paired.after:.3f} ({-high:+.3f} to {-low:+.3f})")
    off = np.concatenate([circles(one, part) for one, (_, part) in zip(boats, others, strict=True)], axis=1)
    return [*cells, *(f"{100 * value:.0f} %" for value in np.median(np.abs(off), axis=1))]


def terms_table(boat: Boat, random: Sequence[Run], turning: Sequence[Run], zigzags: Sequence[Run]) -> str:
    """A row a term, with its numbers in both halves."""
    both, rows = halves(random, turning), []
    for name, term in TERMS.items():
        numbers = [fitted(boat, term, *half) for half in both]
        shown = "; ".join(f"{key.split()[-1]} {' / '.join(f'{n[key]:.2f}' for n in numbers)}" for key in term)
        rows.append([name, shown, *judged(boat, [boat_with(boat, n) for n in numbers], both, zigzags)])
        print(rows[-1], flush=True)
    head = ["term", "values, by half", "random, m", "circles, m", "zig-zags, m", *FIGURES]
    return table(head, rows)


def main() -> None:
    """Write the table into the document from the folder of measured data."""
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    data, boat = Path(sys.argv[1]), load_boat("esso_osaka")
    random, turning, zigzags = (
        [import_free_running(path, boat, repair=True) for path in sorted((data / kind).glob("*.csv"))]
        for kind in ("random", "turning", "zigzag")
    )
    write_parts(DOCS / "esso_osaka.md", {"terms": terms_table(boat, random, turning, zigzags)})


if __name__ == "__main__":
    main()
