"""The effect `rudder_hull_force` on the pond, at the boat file's numbers and at the ends of published ones.

    python -m benchmarks.esso_osaka.rudder ../shared/data/esso_osaka

No number is fitted. Writes a table into docs/esso_osaka.md: errors of windows of 30 s in the measured wind,
and of the figures of the circles.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.esso_osaka.pond_tests import rms
from benchmarks.esso_osaka.sway import FIGURES
from benchmarks.esso_osaka.terms import circles, windows
from benchmarks.esso_osaka.wind import with_effects
from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, PropellerRudder, load_boat
from swamp_rl.effects import LIBRARY, parse_effects
from swamp_rl.runs import Run
from swamp_rl.runs.free_running import import_free_running

NAME = "rudder_hull_force"
KINDS = {"random": "random", "turning": "circles", "zigzag": "zig-zags"}


def with_force(boat: Boat, a_h: float, x_h: float) -> Boat:
    """The boat with the effect on its rudder."""
    entry = {"effect": NAME, "thruster": boat.thruster_names[0], "a_h": a_h, "x_h": x_h}
    return with_effects(boat, parse_effects([entry], NAME, boat.thruster_names))


def tried(boat: Boat) -> list[tuple[float, float]]:
    """a_H and x'_H of the boat file, and the greatest a_H of the search with both ends of its x'_H."""
    (main,) = boat.thrusters
    assert isinstance(main, PropellerRudder)
    force, place = (LIBRARY[NAME].parameter(name).search for name in ("a_h", "x_h"))
    assert force and place
    return [(main.rudder.a_h, main.rudder.x_h), (force.high, place.high), (force.high, place.low)]


def rudder_table(boat: Boat, runs: Mapping[str, Sequence[Run]]) -> str:
    """A row a pair of numbers."""
    rows = []
    for a_h, x_h in tried(boat):
        other = with_force(boat, a_h, x_h)
        errors = [f"{rms(np.concatenate(windows(other, runs[kind]))):.3f}" for kind in KINDS]
        off = np.median(np.abs(circles(other, runs["turning"])), axis=1)
        rows.append([f"{a_h:.3g}", f"{x_h:.3g}", *errors, *(f"{100 * value:.0f} %" for value in off)])
    return table(["a_H", "x'_H", *(f"{kind}, m" for kind in KINDS.values()), *FIGURES], rows)


def main() -> None:
    """Write the table into the document from the folder of measured data."""
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    data, boat = Path(sys.argv[1]), load_boat("esso_osaka")
    runs = {
        kind: [import_free_running(path, boat, repair=True) for path in sorted((data / kind).glob("*.csv"))]
        for kind in KINDS
    }
    write_parts(DOCS / "esso_osaka.md", {"rudder": rudder_table(boat, runs)})


if __name__ == "__main__":
    main()
