"""A file of printed figures with one value that no source prints: refused by its entry, or predicted."""

import copy
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml
from swamp_rl.printed_figures.diagnose import study_of
from swamp_rl.printed_figures.predict import misfits, predicted
from swamp_rl.printed_figures.schema import read_figures

BOAT = load_boat("swamp-thesis")
COMMON = {"group": "all", "mass": 58.0, "value": 0.8, "error": 0.1, "source": "made up"}
TOWED = {"manoeuvre": "towed", "speed": 1.0, "throttle": 0.6, "figure": "one_minus_t"}
BOLLARD = {"manoeuvre": "bollard", "throttle": 1.0, "figure": "pull", "thrusters": ["bs", "bp"]}
GOOD: dict[str, Any] = {
    "name": "made",
    "description": "",
    "fit": [["all"]],
    "exchange": {"all": "all"},
    "loads": [{"mass": 48.0, "draught": 0.115, "inertia_z": 6.0, "source": "x"}],
    "particulars": [
        {"effect": "thrust_deduction", "parameter": "low", "value": 0.9, "error": 0.1, "source": "y"}
    ],
    "figures": [
        COMMON | TOWED | {"depth_over_draught": 4.0},
        COMMON | BOLLARD | {"water_density": 1001.0, "limit": "at_least", "reading": "r", "mass": 48.0},
    ],
}
MISSING = object()
HOSTILE: tuple[Any, ...] = (
    *(MISSING, "A" * 5000, {"a": 1}),
    *(-1, 0, 1e-320, 1e300),
)


def substituted(data: Any, value: Any) -> Iterator[Any]:
    """Copies of the file in each of which the value stands at another key."""
    for key in list(data) if isinstance(data, dict) else range(len(data)):
        changed = copy.copy(data)
        if value is not MISSING:
            changed[key] = value
        else:
            del changed[key]
        yield changed
        if isinstance(data[key], dict | list):
            for inner in substituted(data[key], value):
                changed = copy.copy(data)
                changed[key] = inner
                yield changed


def off(path: Path) -> Any:
    """Each figure's difference from the boat file's, in its errors."""
    study = study_of(path, "swamp-thesis")
    figures = study.found.figures
    return misfits(figures, predicted(study.fleet, figures, Hypothesis(), np.zeros(0)))


def test_a_load_of_no_boat_is_refused_by_the_file_that_has_it(tmp_path: Path) -> None:
    write_yaml(tmp_path / "figures.yaml", GOOD | {"loads": [GOOD["loads"][0] | {"draught": 1e-320}]})
    with pytest.raises(UserError, match=r"figures.yaml: the boat at 48 kg in water of 1001 kg/m3: .*draught"):
        study_of(tmp_path / "figures.yaml", "swamp-thesis")


def test_a_value_that_no_source_prints_is_refused_or_can_be_computed(tmp_path: Path) -> None:
    path = tmp_path / "figures.yaml"
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        for value in HOSTILE:
            for data in substituted(GOOD, value):
                write_yaml(path, data)
                try:
                    assert np.isfinite((off(path) ** 2).sum())
                except UserError as error:
                    lines = str(error).split("\n")
                    odd = [
                        line for line in lines if not (line.startswith(f"{path}: ") and line.isprintable())
                    ]
                    assert not odd


@pytest.mark.parametrize(
    ("figure", "message"),
    [
        ({k: v for k, v in TOWED.items() if k != "throttle"}, "throttle is missing; add it"),
        (TOWED | {"throttle": 0.0}, "throttle: must be at least 0.01, not 0.0"),
        (TOWED | {"value": 1e300}, "value: must be at most 1e\\+09, not 1e\\+300"),
        (TOWED | {"error": 1e-320}, "error: must be at least 1e-09, not 1e-320"),
        ({"manoeuvre": "zig-zag", "throttle": 0.6, "angle_deg": 0, "figure": "first_overshoot"}, "angle_deg"),
    ],
)
def test_a_figure_from_which_nothing_follows_is_refused_by_its_key(
    figure: dict[str, Any], message: str, tmp_path: Path
) -> None:
    write_yaml(tmp_path / "figures.yaml", GOOD | {"exchange": {}, "figures": [COMMON | figure]})
    with pytest.raises(UserError, match=rf"figures 1 \([^)]*\): {message}"):
        read_figures(tmp_path / "figures.yaml", BOAT)
