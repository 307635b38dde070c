"""Identify the Esso Osaka model ship from its pond tests: two tables of docs/identify_boat.md.

    python -m benchmarks.boat_fit.pond ../shared/data/esso_osaka/random

The measured data are not part of the project; their licence is CC BY-NC-SA. One start file has the published
coefficients of hull, propeller and rudder made 35 to 50 % wrong at random; the other is a template that `boat
new` writes from the particulars. --start: one of them alone.
"""

import argparse
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import boat_file
from swamp_rl.boat.mapping import boat_mapping
from swamp_rl.boat_fit.identify import errors_on, identify_boat
from swamp_rl.boat_fit.result import Identification
from swamp_rl.criticism.report.evidence import TRIVIAL
from swamp_rl.files import write_yaml
from swamp_rl.runs import append_run, create_dataset
from swamp_rl.runs.free_running import import_free_running
from swamp_rl.runs.schema import DatasetMeta

SEED = 7
WRONG = (0.6, 0.65, 1.4, 1.5)  # factors
WAKE = 0.4  # w_P0 of a slender hull, in place of 0.614
PARTICULARS = {"length": 3.0, "breadth": 0.489, "draught": 0.201, "mass": 244.6, "thrust": 3.53}
"""[m, kg] of the table published with the data; bollard pull [N] 0.78 · 0.3278 ρ n² D⁴ of its t_P, K_T(0) and
D = 0.084 m at the 16.67 revolutions a second of the fastest tests.
"""
HEAD = ["wind", "horizon, s", "start", "identified", "published"]
SPOILED = {
    (): ("inertia_z", "added_mass_surge", "added_mass_sway", "added_inertia_yaw"),
    ("hull",): ("x_vr", "y_v", "y_r", "n_v", "n_r", "c_d", "c_ry", "c_rn"),
    ("resistance",): ("x_0_ahead", "x_0_astern"),
    ("propeller",): ("k_t", "astern_thrust", "side_force", "yaw_moment", "wake_tau"),
    ("rudder",): ("a_h", "flow_lever", "gamma_p", "gamma_n", "k_x", "k_x_astern"),
}


def spoiled(boat: Boat) -> dict[str, Any]:
    """The boat file with wrong coefficients; the moment of inertia of a gyradius of a quarter length."""
    rng, whole = np.random.default_rng(SEED), boat_mapping(boat)
    for place, keys in SPOILED.items():
        own = place in (("propeller",), ("rudder",))
        section = whole["thrusters"][0] if own else whole
        for key in place:
            section = section[key]
        for key in keys:
            values = np.atleast_1d(section[key]["value"])
            wrong = [float(value * rng.choice(WRONG)) for value in values]
            value = wrong if isinstance(section[key]["value"], list) else wrong[0]
            section[key] |= {"value": value, "provenance": "assumed", "source": "made wrong"}
    whole["inertia_z"]["value"] = boat.mass * (0.25 * boat.length) ** 2
    whole["thrusters"][0]["propeller"]["wake_zero"] |= {"value": WAKE, "provenance": "assumed"}
    return whole | {"name": "start"}


def of_particulars(_: Boat) -> dict[str, Any]:
    """The boat file that `boat new` writes from PARTICULARS."""
    return boat_file("start", "propeller-rudder", **PARTICULARS)


WINDS = {"measured": [], "ignored": ["wind"]}  # what is left out of the runs
STARTS: dict[str, tuple[Callable[[Boat], dict[str, Any]], list[str]]] = {
    "coefficients": (spoiled, ["measured", "ignored"]),
    "particulars": (of_particulars, ["measured"]),
}
"""Name of the table's part of the page, after `pond`; start file and winds."""


def pond_dataset(source: Path, folder: Path, boat: Boat) -> Path:
    """The random pond tests as a dataset."""
    runs = [import_free_running(path, boat) for path in sorted(source.glob("*.csv"))]
    about = {"mass": boat.mass, "draught": boat.draught, "water_density": boat.water_density}
    create_dataset(folder, DatasetMeta(vehicle="esso_osaka", sample_rate=10.0, source="measured", **about))
    for run in runs:
        append_run(folder, run)
    return folder


def rows(found: Identification, published: Boat, wind: str) -> list[list[str]]:
    """Errors [m] by horizon."""
    of_published = errors_on(found.data.held_out, published)
    return [
        [
            wind,
            f"{was.horizon_s:g}",
            *(f"{value:.3f}" for value in (was.boat_file, now.boat_file, theirs.boat_file)),
            *(f"{getattr(now, name):.3f}" for name in TRIVIAL),
        ]
        for was, now, theirs in zip(found.before, found.after, of_published, strict=True)
    ]


def write_errors(start: str, dataset: Path, folder: Path, published: Boat) -> None:
    """Identify from one of STARTS, and write its table."""
    content, winds = STARTS[start]
    path, found = folder / f"{start}.yaml", list[list[str]]()
    write_yaml(path, content(published))
    for wind in winds:
        made = identify_boat(dataset, path, folder / f"{start}_{wind}.yaml", ignore=WINDS[wind])
        found += rows(made, published, wind)
        print(f"{start}, wind {wind}: {made.elapsed:.0f} s", flush=True)
    write_parts(DOCS / "identify_boat.md", {f"pond {start}": table([*HEAD, *_words(TRIVIAL)], found)})


def main() -> None:
    """Identify from each start file, and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source", type=Path)
    parser.add_argument("--start", choices=STARTS, nargs="+", default=list(STARTS))
    asked = parser.parse_args()
    published = load_boat("esso_osaka")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        dataset = pond_dataset(asked.source, folder / "pond", published)
        for start in asked.start:
            write_errors(start, dataset, folder, published)


def _words(names: Iterable[str]) -> list[str]:
    return [name.replace("_", " ") for name in names]


if __name__ == "__main__":
    main()
