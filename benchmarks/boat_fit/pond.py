"""Identify the Esso Osaka model ship from its pond tests: a table of docs/identify_boat.md.

    python -m benchmarks.boat_fit.pond ../shared/data/esso_osaka/random

The measured data are not part of the project; their licence is CC BY-NC-SA. The file to start from has the
ship's particulars; its hull, propeller and rudder coefficients are made 35 to 50 % wrong at random.
"""

import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
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


def main(source: Path) -> None:
    """Identify with and without the measured wind, and write the table."""
    published = load_boat("esso_osaka")
    found: list[list[str]] = []
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_yaml(folder / "start.yaml", spoiled(published))
        dataset = pond_dataset(source, folder / "pond", published)
        for name, ignore in (("measured", []), ("ignored", ["wind"])):
            made = identify_boat(dataset, folder / "start.yaml", folder / f"{name}.yaml", ignore=ignore)
            found += rows(made, published, name)
            print(f"{name}: {made.elapsed:.0f} s", flush=True)
            write_parts(DOCS / "identify_boat.md", {"pond": table([*HEAD, *_words(TRIVIAL)], found)})


def _words(names: Iterable[str]) -> list[str]:
    return [name.replace("_", " ") for name in names]


if __name__ == "__main__":
    main(Path(sys.argv[1]))
