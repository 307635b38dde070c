"""A sweep to which values or draws are added keeps its trials, and other settings are refused."""

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
import yaml
from swamp_rl.experiments.sweep.run import run_sweep
from swamp_rl.experiments.sweep.store import Trial

from swamp_rl.errors import UserError
from tests.support.sweep_pools import PoolHere

UNITS, SEED = "pilots.reservoir.options.units", "pilots.reservoir.options.seed"


def stand_in(job: str) -> str:
    """A value that depends on the options of the pilot."""
    options = json.loads(job)["experiment"]["pilots"]["reservoir"]["options"]
    value = 1.0 / (1.0 + options["units"] + 0.1 * options["seed"])
    return json.dumps({"value": value, "summary": {"success_rate": value, "wilson_95": [0.0, 1.0]}})


@pytest.fixture(autouse=True)
def no_training(monkeypatch: pytest.MonkeyPatch) -> None:
    @contextmanager
    def pool(*_: Any) -> Iterator[PoolHere]:
        yield PoolHere(stand_in, 1, 0)

    monkeypatch.setattr("swamp_rl.experiments.sweep.run.open_pool", pool)


def swept(folder: Path, out: str, **changes: Any) -> tuple[list[Trial], dict[str, Any]]:
    """The trials that were carried out now, and what the report holds of all."""
    entries = {"name": "s", "experiment": "smoke", "objective": {"pilot": "reservoir", "level": "calm"}}
    entries["parameters"] = {UNITS: {"grid": [10, 20]}, SEED: {"grid": [0, 1]}}
    (folder / "sweep.yaml").write_text(yaml.safe_dump(entries | changes, sort_keys=False))
    done: list[Trial] = []
    run_sweep(folder / "sweep.yaml", out=folder / out, tell=lambda trial, total: done.append(trial))
    found = json.loads((folder / out / "sweep.json").read_text())
    return done, {key: value for key, value in found.items() if key != "measured"}


def test_values_added_to_a_grid_are_tried_and_the_others_are_not_tried_again(tmp_path: Path) -> None:
    grown = {"parameters": {UNITS: {"grid": [5, 10, 20]}, SEED: {"grid": [0, 1, 2]}}}
    swept(tmp_path, "out")
    done, found = swept(tmp_path, "out", **grown)
    assert [(one.values[UNITS], one.values[SEED]) for one in done] == [
        (5, 0),
        (5, 1),
        (5, 2),
        (10, 2),
        (20, 2),
    ]
    assert found == swept(tmp_path, "anew", **grown)[1]


def test_draws_added_to_a_search_go_on_from_those_that_have_ended(tmp_path: Path) -> None:
    drawn = {"parameters": {UNITS: {"integers": [5, 50]}, SEED: {"choice": [0, 1, 2]}}, "batch": 3}
    swept(tmp_path, "out", trials=11, **drawn)
    done, found = swept(tmp_path, "out", trials=16, **drawn)
    assert [one.number for one in done] == [11, 12, 13, 14, 15]
    assert found == swept(tmp_path, "anew", trials=16, **drawn)[1]


def test_a_value_that_was_tried_is_not_dropped_without_a_word(tmp_path: Path) -> None:
    swept(tmp_path, "out")
    less = {"parameters": {UNITS: {"grid": [10]}, SEED: {"grid": [0, 1]}}}
    with pytest.raises(
        UserError, match=r'holds trial 3 .*"pilots.reservoir.options.units": 20.* no longer has'
    ):
        swept(tmp_path, "out", **less)
    assert len(swept(tmp_path, "out")[1]["trials"]) == 4


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"set": {"evaluation.episodes": 5}}, "experiment.evaluation.episodes: there 12, now 5"),
        (
            {"objective": {"pilot": "reservoir", "level": "severe"}},
            'sweep.objective.level: there "calm", now "sev',
        ),
    ],
)
def test_other_settings_of_a_sweep_are_refused_and_the_first_is_named(
    changes: dict[str, Any], message: str, tmp_path: Path
) -> None:
    swept(tmp_path, "out")
    with pytest.raises(UserError, match="holds trials of another sweep or of other settings") as refused:
        swept(tmp_path, "out", **changes)
    assert message in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize("plan", [None, "no json", '{"a": NaN}'])
def test_a_sweep_whose_stored_settings_are_damaged_is_refused_in_one_line(
    plan: str | None, tmp_path: Path
) -> None:
    swept(tmp_path, "out")
    with closing(sqlite3.connect(tmp_path / "out" / "trials.sqlite")) as store, store:
        store.execute("UPDATE plan SET plan = ?", (plan,))
    with pytest.raises(UserError, match="the plan in it is damaged") as refused:
        swept(tmp_path, "out")
    assert "\n" not in str(refused.value)


def test_the_figure_has_the_values_of_a_grid_as_labels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from matplotlib.axes import Axes

    labels: list[list[str]] = []
    monkeypatch.setattr(Axes, "set_xticks", lambda self, places, names=None, **_: labels.append(names))
    swept(tmp_path, "out")
    assert labels == [["10", "20"], ["0", "1"]]
