"""A diagnosis as disturbances to train among: its numbers, its doubt, and never beyond an effect's bounds."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import truncnorm

from envs.batched import GatesVectorEnv
from swamp_rl.boat import load_boat
from swamp_rl.criticism.posterior import write_posterior
from swamp_rl.effects import load_disturbances
from swamp_rl.errors import UserError
from swamp_rl.files import read_yaml
from swamp_rl.simulator import parameters

BOAT = load_boat("swamp")


def estimate(value: float, doubt: float, unit: str = "1") -> dict[str, Any]:
    return {"value": value, "standard_error": doubt, "unit": unit}


def diagnosis(folder: Path, *causes: dict[str, Any]) -> Path:
    empty: dict[str, Any] = {
        name: [] for name in ("indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    }
    found = empty | {"verdict": "cause", "causes": list(causes), "separating_trial": None}
    path = folder / "diagnosis.json"
    path.write_text(json.dumps(found | {"noise": {}, "adequacy": {}, "elapsed_s": 1.0}))
    return path


CURRENT = {
    "effect": "current",
    "parameters": {"north": estimate(0.2, 0.02, "m/s"), "east": estimate(-0.1, 0.03, "m/s")},
}
WEAK = {"effect": "thruster_gain", "thruster": "bs", "parameters": {"gain": estimate(0.02, 0.05)}}


def test_what_is_drawn_has_the_mean_and_the_standard_error_of_the_diagnosis(tmp_path: Path) -> None:
    write_posterior(diagnosis(tmp_path, CURRENT), tmp_path / "found.yaml")
    level = load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)
    record = parameters(BOAT, 20_000)
    level.apply(record, np.random.default_rng(0).random((20_000, level.draw_count)))
    for field, value, doubt in (("current_north", 0.2, 0.02), ("current_east", -0.1, 0.03)):
        assert record[field].mean() == pytest.approx(value, abs=4.0 * doubt / np.sqrt(20_000))
        assert record[field].std() == pytest.approx(doubt, rel=0.03)


def test_nothing_is_drawn_beyond_the_bounds_of_an_effect(tmp_path: Path) -> None:
    write_posterior(diagnosis(tmp_path, WEAK), tmp_path / "found.yaml")
    level = load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)
    record = parameters(BOAT, 2_000)
    level.apply(record, np.linspace(0.0, np.nextafter(1.0, 0.0), 2_000)[:, None])
    gains = record["thruster_gain"][:, BOAT.thruster_names.index("bs")]
    assert 0.0 <= gains.min() < 1e-9 and np.all(np.diff(gains) >= 0.0)
    assert 0.2 < gains.max() <= 0.02 + 5.0 * 0.05
    assert np.median(gains) == pytest.approx(truncnorm.median(-0.4, 5.0, 0.02, 0.05), abs=1e-4)


def test_the_start_and_the_other_effects_of_a_level_stay(tmp_path: Path) -> None:
    write_posterior(diagnosis(tmp_path, CURRENT), tmp_path / "found.yaml", among="severe")
    found, severe = read_yaml(tmp_path / "found.yaml"), load_disturbances("severe", BOAT.thruster_names)
    effects = [entry["effect"] for entry in found["effects"]]
    assert effects == [entry.effect.name for entry in severe.entries]
    assert found["effects"][0]["north"] == {"normal": [0.2, 0.02, 0.1, pytest.approx(0.3)]}
    assert found["start"] == read_yaml(Path("configs/disturbances/severe.yaml"))["start"]
    boats = GatesVectorEnv(3, disturbances=tmp_path / "found.yaml")
    boats.reset(seed=1)
    assert len({boats.fleet.params["current_north"][i] for i in range(3)}) == 3


def test_a_file_that_is_no_diagnosis_and_one_without_causes_are_refused(tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text('{"verdict": "cause"}')
    for path, told in (("other.json", "causes"), ("none.json", "cannot be read")):
        with pytest.raises(UserError, match=told):
            write_posterior(tmp_path / path, tmp_path / "found.yaml")
    with pytest.raises(UserError, match="names no cause"):
        write_posterior(diagnosis(tmp_path), tmp_path / "found.yaml")


@pytest.mark.parametrize(
    ("numbers", "told"),
    [
        ([0.0, 1.0], "normal must be"),
        ([0.0, 0.0, -1.0, 1.0], "normal must be"),
        ([9.0, 1.0, -1.0, 1.0], "3 deviations"),
        ([0.5, 1.0, -1.0, 2.0], "out of range"),
    ],
)
def test_a_normal_distribution_that_makes_no_sense_is_refused(numbers: list[float], told: str) -> None:
    entry = {"effect": "thruster_gain", "thruster": "bs", "gain": {"normal": numbers}}
    with pytest.raises(UserError, match=told):
        load_disturbances([entry], BOAT.thruster_names)
