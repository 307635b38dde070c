"""Stored runs with a known truth: verdict, names and numbers of `diagnose` alone.

`python -m benchmarks.blind.golden tests/criticism/golden` writes them. A case with a `reason` is one that
the diagnosis gets wrong today.
"""

import json
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from swamp_rl.criticism import report
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.errors import UserError
from swamp_rl.runs import inspect_dataset
from tests.support.from_scratch import BOATS

pytestmark = pytest.mark.slow

FOLDER = Path(__file__).parent / "golden"
CASES: dict[str, dict[str, Any]] = yaml.safe_load((FOLDER / "golden.yaml").read_text())
# those that are diagnosed again with another BLAS kernel: a verdict or a means of each kind
KERNELS = ("clean_plain_receiver", "mass", "pair_wind_thruster", "lost_rows", "wind_by_run")
FAR = 4.0  # standard errors that a number may lie from the truth
WIDE = 2.0  # times the Cramér-Rao bound that a standard error may be
LARGEST_SET = 6
POINTED = 4  # missing forces, of which one must go with the right variable
MOST_BYTES = 3_000_000
Json = dict[str, Any]


def marked(name: str) -> Any:
    """The case, expected to fail where the diagnosis is known to be wrong."""
    reason = CASES[name].get("reason")
    marks = [pytest.mark.xfail(reason=reason, strict=True)] if reason else []
    return pytest.param(name, marks=[*marks, *([pytest.mark.numerical] if name in KERNELS else [])])


@pytest.mark.parametrize("name", [marked(name) for name in CASES])
def test_the_diagnosis_of_a_golden_case_is_its_truth(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth = CASES[name]
    monkeypatch.setattr(report, "write_report", lambda *given: None)  # has tests of its own
    if truth["verdict"] == "refused":
        with pytest.raises(UserError, match=truth["refused"]):
            diagnosed(name, tmp_path)
        return
    result = diagnosed(name, tmp_path)
    assert result["verdict"] == truth["verdict"], answer_of(result)
    if truth["verdict"] == "indistinguishable":
        (rivals,) = result["indistinguishable"]
        assert label_of(truth) in rivals
        assert len(rivals) <= LARGEST_SET
        assert result["separating_trial"]
        return
    if "outside" in truth:
        wanted = set(truth["outside"]["variables"])
        assert wanted & {one["variable"].replace(" ", "_") for one in result["leftover"][:POINTED]}
        return
    assert sorted(cause["effect"] for cause in result["causes"]) == effects_of(truth), answer_of(result)
    for cause in truth.get("causes", []):
        holds_the_numbers(cause, named(result, cause["effect"]))
    for number, run in enumerate(truth.get("by_run", [])):
        for effect, values in run.items():
            found = named(result, effect)
            assert found["scope"] == "run"
            holds(values, found["groups"][f"run_{number}"])
    if "wander" in truth:
        sizes = [result["wandering"][name]["standard_deviation"] for name in ("north", "east")]
        assert 0.5 < math.sqrt(np.mean(np.square(sizes))) / truth["wander"] < 2.0


def diagnosed(name: str, out: Path) -> Json:
    """What `diagnosis.json` holds of a case; no library may warn meanwhile."""
    with warnings.catch_warnings():
        for kind in (RuntimeWarning, UserWarning):
            warnings.simplefilter("error", kind)
        diagnose(FOLDER / name, boat_of(name), out / "answer")
    data: Json = json.loads((out / "answer" / "diagnosis.json").read_text())
    return data


def boat_of(name: str) -> str | Path:
    """The boat file beside the runs of a case, or a known name."""
    boat: str = CASES[name]["boat"]
    return FOLDER / name / boat if boat.endswith(".yaml") else boat


def effects_of(truth: Json) -> list[str]:
    """The names of all that is wrong, in order."""
    own = {effect for run in truth.get("by_run", []) for effect in run}
    return sorted([*(cause["effect"] for cause in truth.get("causes", [])), *own])


def label_of(truth: Json) -> str:
    """All that is wrong as a hypothesis is labelled, with its thrusters."""
    return " + ".join(" ".join([c["effect"], *c.get("thruster", [])]) for c in truth["causes"])


def answer_of(result: Json) -> str:
    """The answer in a line."""
    names = [cause["effect"] for cause in result["causes"]]
    return f"{result['verdict']}: {names}, {result['indistinguishable']}"


def named(result: Json, effect: str) -> Json:
    """The cause of that name."""
    (found,) = (cause for cause in result["causes"] if cause["effect"] == effect)
    return dict(found)


def holds_the_numbers(truth: Json, cause: Json) -> None:
    """The right thruster, every number near its truth, and known about as well as it can be."""
    if "thruster" in truth:
        assert cause["thruster"] == truth["thruster"]
    holds({name: number["truth"] for name, number in truth["numbers"].items()}, cause["parameters"])
    for name, number in truth["numbers"].items():
        if "bound" in number:
            assert cause["parameters"][name]["standard_error"] < WIDE * number["bound"], name


def holds(values: dict[str, float], parameters: Json) -> None:
    """Every number lies within some standard errors of its truth."""
    for name, value in values.items():
        number = parameters[name]
        away = number["value"] - value
        away = math.remainder(away, 2.0 * math.pi) if number["unit"] == "rad" else away
        assert abs(away) < FAR * number["standard_error"], f"{name}: {number['value']} for {value}"


def test_every_golden_dataset_is_sound_scripted_and_all_of_them_are_small() -> None:
    folders = {path.parent.name for path in FOLDER.glob("*/dataset.yaml")}
    assert folders == set(CASES)
    for name in CASES:
        faults = inspect_dataset(FOLDER / name).faults
        assert not [fault for fault in faults if fault.column != "time"]  # rows are lost
        assert yaml.safe_load((FOLDER / name / "dataset.yaml").read_text())["source"] == "scripted"
    assert sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()) < MOST_BYTES


@pytest.mark.parametrize("name", [name for name in CASES if CASES[name]["boat"].endswith(".yaml")])
def test_a_boat_beside_its_runs_is_that_of_the_other_tests(name: str) -> None:
    assert yaml.safe_load(Path(boat_of(name)).read_text()) == BOATS[name]
