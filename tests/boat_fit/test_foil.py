"""The fit of the foils of thrusters to runs of a boat that has them."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat_fit.fit import fit_boat
from swamp_rl.boat_fit.hypothesis import LIKENESS, free_boat
from swamp_rl.boat_fit.identify import numbers_of
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import read_run_set
from tests.support.from_scratch import written
from tests.support.sailing import sailed_dataset

FREE = ("hull.y_v", "hull.n_r", "thrusters.bow.thrust_quadratic", "thrusters.stern.thrust_quadratic")


def ferry(folder: Path, name: str, area: float, gamma: float) -> Boat:
    """The ferry of 1.8 t with a foil at each of its azimuth thrusters, as the file `name`."""
    written(folder, "ferry")
    foil = f"foil: {{area: {area}, aspect_ratio: 1.5, gamma: {gamma}}}"
    names = [thruster.name for thruster in load_boat(folder / "ferry.yaml").thrusters]
    lines = "\n".join(f"  {one}: {{{foil}}}" for one in names)
    (folder / f"{name}.yaml").write_text(f"extends: ferry.yaml\nthrusters:\n{lines}\n")
    return load_boat(folder / f"{name}.yaml")


def test_area_and_straightening_of_the_foils_are_found_within_their_intervals(tmp_path: Path) -> None:
    truth, start = ferry(tmp_path, "truth", 0.12, 0.5), ferry(tmp_path, "start", 0.07, 0.9)
    sailed_dataset(tmp_path / "runs", tmp_path / "start.yaml", truth, low=0.3, steered=0.7, seconds=120.0)
    runs = read_run_set(tmp_path / "runs", start)
    numbers = tuple(one for one in free_numbers(start) if ".foil." in one.name or one.name in FREE)
    hypothesis = free_boat(start, numbers)
    made = fit_boat(runs, weights(runs, noise_levels(runs)), hypothesis, hypothesis.start())
    found = {one.number.name: one for one in numbers_of(made)}
    for thruster in truth.thrusters:
        for name, value in (("area", 0.12), ("gamma", 0.5)):
            one = found[f"thrusters.{thruster.name}.foil.{name}"]
            assert abs(one.value - value) < 4.0 * one.standard_error, one.number.name
            assert one.shown


def test_foils_of_equal_thrusters_are_correlated_beforehand(tmp_path: Path) -> None:
    start = ferry(tmp_path, "start", 0.07, 0.9)
    hypothesis = free_boat(start, tuple(one for one in free_numbers(start) if one.field == "foil_area"))
    covariance = np.linalg.inv(hypothesis.prior_precision)
    assert covariance[0, 1] / covariance[0, 0] == pytest.approx(LIKENESS)


def test_a_boat_without_foils_has_no_number_of_one() -> None:
    assert not [one.name for one in free_numbers(load_boat("swamp")) if "foil" in one.name]
