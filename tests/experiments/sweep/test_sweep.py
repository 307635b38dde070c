"""A sweep tries every trial once, whatever fails meanwhile and however many work at it."""

import importlib.util
import json
import os
import random
import shlex
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
import yaml
from swamp_rl.experiments.cli.sweep import sweep as sweep_verb
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.sweep.propose import batches_of, propose
from swamp_rl.experiments.sweep.report import best_of, results, rows, write_report
from swamp_rl.experiments.sweep.run import checked, run_sweep
from swamp_rl.experiments.sweep.schema import Sweep, load_sweep, override
from swamp_rl.experiments.sweep.store import Trial, opened

from swamp_rl.errors import UserError
from swamp_rl.workers.processes import ProcessPool
from tests.support import sweeps as sweep_trials
from tests.support.patience import PATIENCE
from tests.support.sweep_pools import PoolHere, summary_of, swept
from tests.support.sweeps import DRAWN, sweep_of

pytestmark = [pytest.mark.slow, pytest.mark.timed]


COST = {"pilot": "reservoir", "level": "calm", "measure": "energy"}


@pytest.mark.parametrize(
    "changes", [{}, DRAWN, {**DRAWN, "sampler": "random"}], ids=["grid", "tpe", "random"]
)
def test_order_workers_and_interruptions_make_no_difference(changes: dict[str, Any], tmp_path: Path) -> None:
    sweep = sweep_of(**changes)
    alone = swept(tmp_path / "alone", sweep, PoolHere(sweep_trials.formula, 1, 0))
    assert sorted(alone) == list(range(sweep.trials or 9))
    for size, seed, stop in ((3, 1, 10**6), (8, 2, 10**6), (2, 3, 1), (3, 4, 4)):
        pool = PoolHere(sweep_trials.formula, size, seed)
        other = swept(tmp_path / f"{size}-{seed}", sweep, pool, stop_after=stop)
        assert summary_of(sweep, other) == summary_of(sweep, alone)


def test_values_that_are_refused_together_are_a_failed_trial_and_the_others_go_on(tmp_path: Path) -> None:
    def job(values: dict[str, Any]) -> str:
        if (values["a"], values["b"]) == (1, 0.5):
            raise UserError("a 1 does not go with b 0.5")
        return json.dumps(values)

    trials = swept(tmp_path / "s", sweep_of(), PoolHere(sweep_trials.formula, 2, 0), job)
    failed = [trial for trial in trials.values() if trial.error]
    assert [(trial.error, trial.attempts) for trial in failed] == [("a 1 does not go with b 0.5", 0)]
    assert sum(trial.value is not None for trial in trials.values()) == 8


@pytest.mark.parametrize("value", ["true", "it's", [64, "1e-3"]])
def test_the_command_of_the_best_trial_gives_a_shell_its_values_to_the_bit(value: Any) -> None:
    sweep = sweep_of(experiment="my pilots.yaml", parameters={"a.b": {"grid": [value]}})
    trial = Trial(0, {"a.b": value}, 1.0, None, None, 1, 1.0)
    words = shlex.split(results(sweep, [], {0: trial})["best"]["again"])
    assert words[:4] == ["swamp-rl", "run", "my pilots.yaml", "--set"]
    assert yaml.safe_load(words[4].removeprefix("a.b=")) == value


def test_a_grid_is_every_combination_once() -> None:
    (numbers,) = batches_of(sweep_of())
    tried = [tuple(values.values()) for values in propose(sweep_of(), numbers, {}).values()]
    assert sorted(tried) == [(a, b) for a in (0, 1, 2) for b in (0.0, 0.5, 1.0)]


def test_a_search_stays_in_its_ranges_and_finds_more_than_chance(tmp_path: Path) -> None:
    sweep = sweep_of(**{**DRAWN, "trials": 60})
    trials = swept(tmp_path / "tpe", sweep, PoolHere(sweep_trials.formula, 3, 0))
    for trial in trials.values():
        values = trial.values
        assert -1.0 <= values["a"] <= 2.0 and 0.01 <= values["b"] <= 10.0 and values["d"] in range(1, 10)
        assert values["c"] in ([1, 2], [3, 4], "none")
    value = [trials[number].value or 0.0 for number in sorted(trials)]
    assert np.mean(value[30:]) > np.mean(value[:10])  # the first ten of Optuna's sampler are by chance
    assert len({trial.values["a"] for trial in trials.values()}) == 60


def test_less_is_better_where_the_objective_says_so(tmp_path: Path) -> None:
    cost = sweep_of(objective={**COST, "least_success": 0.0})
    trials = swept(tmp_path / "cost", cost, PoolHere(sweep_trials.formula, 3, 0))
    best = best_of(cost, list(trials.values()))
    assert best is not None and best.value == min(trial.value or 0.0 for trial in trials.values())


def test_a_cost_ranks_trials_that_succeed_and_their_success_the_others(tmp_path: Path) -> None:
    def trial(number: int, success: float, cost: float | None) -> Trial:
        summary = {
            "success_rate": success,
            "wilson_95": [0.0, 1.0],
            "episodes": 10,
            "successes": 10 * success,
        }
        return Trial(number, {"a": number}, cost, summary, None, 1, 1.0)

    failed = Trial(5, {"a": 5}, None, None, "ValueError: never works", 3, 1.0)
    tried = [
        trial(0, 0.1, 3.0),
        trial(1, 0.9, 8.0),
        trial(2, 0.6, 5.0),
        trial(3, 0.0, None),
        trial(4, 1.0, 7.0),
    ]
    sweep = sweep_of(parameters={"a": {"grid": [0, 1, 2, 3, 4, 5]}}, objective=COST)
    assert [row[0] for row in table_of(sweep, [*tried, failed])] == ["5", "2", "3", "1", "4", "6"]
    assert best_of(sweep, tried) == tried[4] and best_of(sweep, tried[:1]) == tried[0]
    assert best_of(sweep, [tried[3], failed]) is None
    strict = sweep_of(objective={**COST, "least_success": 0.95})
    assert [row[0] for row in table_of(strict, tried)] == ["5", "2", "3", "1", "4"]
    write_report(tmp_path, sweep, [], {one.number: one for one in tried})
    page = (tmp_path / "sweep.md").read_text()
    assert "from a success of 90 % on" in page
    assert "come last, in the order of their success: 3 of 5, open circles" in page


def table_of(sweep: Sweep, trials: list[Trial]) -> list[list[str]]:
    found = results(sweep, [], {trial.number: trial for trial in trials})
    return rows(sweep, found["trials"], found["measured"])


@pytest.mark.parametrize("sampler", ["tpe", "random"])
def test_a_search_is_drawn_to_success_before_the_cost(tmp_path: Path, sampler: str) -> None:
    sweep = sweep_of(**{**DRAWN, "objective": COST, "sampler": sampler, "trials": 60})
    trials = swept(tmp_path / sampler, sweep, PoolHere(sweep_trials.seldom_is_cheap, 3, 0))
    success = [trials[number].summary["success_rate"] for number in range(60)]  # type: ignore[index]
    late, early = np.mean(success[30:]), np.mean(success[:10])
    assert late > 0.8 > early if sampler == "tpe" else late < 0.8


def test_a_least_success_beside_the_success_itself_is_refused() -> None:
    with pytest.raises(ValueError, match="least_success: is for other measures than success; drop the key"):
        sweep_of(objective={**COST, "measure": "success", "least_success": 0.5})


def test_what_fails_is_tried_again_and_then_recorded_as_failed(tmp_path: Path) -> None:
    trials = swept(tmp_path / "s", sweep_of(retries=2), PoolHere(sweep_trials.always_fails, 2, 0))
    assert [trial.attempts for trial in trials.values()] == [1, 1, 1, 3, 3, 3, 1, 1, 1]
    assert {trial.error for trial in trials.values()} == {None, "ValueError: never works"}
    write_report(tmp_path, sweep_of(), [], trials)
    assert "| failed: ValueError: never works |" in (tmp_path / "sweep.md").read_text()
    assert json.loads((tmp_path / "sweep.json").read_text())["failed"] == 3


@pytest.mark.parametrize(("measure", "columns"), [("success", "b"), ("energy", "b | energy")])
def test_the_table_has_success_once(tmp_path: Path, measure: str, columns: str) -> None:
    sweep = sweep_of(objective={"pilot": "reservoir", "level": "calm", "measure": measure})
    write_report(tmp_path, sweep, [], swept(tmp_path / "s", sweep, PoolHere(sweep_trials.formula, 1, 0)))
    assert f"| trial | a | {columns} | success, percent |" in (tmp_path / "sweep.md").read_text()


def test_trials_are_counted_from_one_wherever_they_are_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    trials = swept(tmp_path / "s", sweep_of(), PoolHere(sweep_trials.formula, 1, 0))

    def carried_out(*asked: Any) -> Path:
        write_report(tmp_path, sweep_of(), [], trials)
        for trial in trials.values():
            asked[-1](trial, len(trials))
        return tmp_path

    monkeypatch.setattr("swamp_rl.experiments.sweep.run.run_sweep", carried_out)
    sweep_verb("formula.yaml")
    lines = capsys.readouterr().out.splitlines()
    listed = [line.split(" (")[0] for line in lines]
    assert "): objective " in lines[0]
    found, page = json.loads((tmp_path / "sweep.json").read_text()), (tmp_path / "sweep.md").read_text()
    assert listed[0] == "trial 1 of 9" and listed[8] == "trial 9 of 9"
    numbers = [one["trial"] for one in found["trials"]]
    assert numbers == [int(key) for key in found["measured"]] == [*range(1, 10)]
    best = found["best"]["trial"]
    assert found["trials"][best - 1]["value"] == found["best"]["value"]
    assert f"The best, trial {best}, in full" in page and f"| {best} |" in page


@pytest.mark.parametrize("dies", [False, True], ids=["an exception", "a dead process"])
def test_processes_take_up_what_failed_or_was_lost(dies: bool, tmp_path: Path) -> None:
    (tmp_path / "notes").mkdir()

    def job(values: dict[str, Any]) -> str:
        return json.dumps({**values, "notes": str(tmp_path / "notes"), "dies": dies})

    sweep = sweep_of(parameters={"a": {"grid": [0, 1]}, "b": {"grid": [0.0]}}, retries=1)
    with ProcessPool(sweep_trials.first_time_fails, 2) as pool:
        trials = swept(tmp_path / "s", sweep, pool, job)
    assert [(trial.attempts, trial.error) for trial in trials.values()] == [(2, None)] * 2
    here = swept(tmp_path / "here", sweep, PoolHere(sweep_trials.formula, 1, 0))
    assert summary_of(sweep, trials) == summary_of(sweep, here)


def test_killed_at_any_moment_the_same_command_goes_on_and_loses_nothing(tmp_path: Path) -> None:
    asked = [sys.executable, "-m", "tests.support.sweeps", str(tmp_path)]
    kept: dict[int, Trial] = {}
    chance = random.Random(1)
    for lines in (1, 3):
        with subprocess.Popen(asked, stdout=subprocess.PIPE, text=True) as running:
            assert running.stdout is not None
            heard = [int(running.stdout.readline()) for _ in range(lines)]
            time.sleep(chance.uniform(0.0, 0.3))
            workers = psutil.Process(running.pid).children(recursive=True)
            running.kill()
        assert psutil.wait_procs(workers, timeout=PATIENCE)[1] == [], "workers outlive their sweep"
        if (tmp_path / "trials.sqlite").exists():
            with opened(tmp_path, sweep_of().model_dump(mode="json")) as store:
                now = store.trials()
            assert set(heard) <= now.keys() and kept.items() <= now.items()
            kept = now
    subprocess.run(asked, check=True, stdout=subprocess.DEVNULL)
    with opened(tmp_path, sweep_of().model_dump(mode="json")) as store:
        ended = store.trials()
    assert kept.items() <= ended.items(), "a trial that had ended was done again"
    unbroken = swept(tmp_path / "unbroken", sweep_of(), PoolHere(sweep_trials.formula, 1, 0))
    assert summary_of(sweep_of(), ended) == summary_of(sweep_of(), unbroken)


def test_a_sweep_does_not_go_on_with_a_boat_file_that_has_changed_since(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: Any) -> None:
        raise KeyboardInterrupt

    boat = tmp_path / "mine.yaml"
    boat.write_text("extends: swamp\nname: mine\n")
    file = tmp_path / "sweep.yaml"
    entries = {"name": "s", "experiment": "smoke", "set": {"boat": str(boat)}}
    entries |= {"parameters": {"pilots.reservoir.options.units": {"grid": [10, 20]}}}
    entries |= {"objective": {"pilot": "reservoir", "level": "calm"}}
    file.write_text(yaml.safe_dump(entries))
    monkeypatch.setattr("swamp_rl.experiments.sweep.run.carry_on", stopped)
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            run_sweep(file, out=tmp_path / "out", workers=1)
    boat.write_text("extends: swamp\nname: mine\nmass: 70.0\n")
    with pytest.raises(UserError, match="other settings"):
        run_sweep(file, out=tmp_path / "out", workers=1)


def test_a_full_disk_is_not_taken_for_another_sweep(tmp_path: Path) -> None:
    full = sqlite3.connect(":memory:")
    full.execute("PRAGMA max_page_count = 1")
    with pytest.raises(UserError) as caught, opened(tmp_path, {"seed": 0}):
        full.execute("CREATE TABLE more (name TEXT)")
    assert str(caught.value) == f"{tmp_path}/trials.sqlite: database or disk is full; free some room"


def test_a_plan_that_is_not_utf8_is_refused_in_one_line(tmp_path: Path) -> None:
    with opened(tmp_path, {"seed": 0}):
        pass
    with closing(sqlite3.connect(tmp_path / "trials.sqlite")) as damaged, damaged:
        damaged.execute("UPDATE plan SET plan = CAST(X'ff' AS TEXT)")
    with pytest.raises(UserError, match="Could not decode to UTF-8"), opened(tmp_path, {}):
        pass


def test_another_sweep_or_a_second_process_is_kept_out_of_a_folder(tmp_path: Path) -> None:
    with opened(tmp_path, {"seed": 0}) as store:
        store.add(Trial(0, {"a": 1}, 0.5, None, None, 1, 0.1))
        with pytest.raises(UserError, match="another sweep at work"), opened(tmp_path, {"seed": 0}):
            pass
    with pytest.raises(UserError, match="trials of another sweep"), opened(tmp_path, {"seed": 1}):
        pass
    with opened(tmp_path, {"seed": 0}) as store:
        assert store.trials()[0].values == {"a": 1}
    (tmp_path / "trials.sqlite").write_bytes(b"something else" * 100)
    with pytest.raises(UserError, match="not a database"), opened(tmp_path, {"seed": 0}):
        pass


def test_the_journal_is_gone_before_the_file_is_closed_whose_last_fsync_may_be_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    journal, there = tmp_path / "trials.sqlite-journal", []

    class Watched(sqlite3.Connection):
        def close(self) -> None:
            there.append(journal.exists())
            super().close()

    connect = sqlite3.connect
    monkeypatch.setattr(sqlite3, "connect", lambda *given, **named: connect(*given, **named, factory=Watched))
    with opened(tmp_path, {"seed": 0}) as store:
        store.add(Trial(0, {"a": 1}, 0.5, None, None, 1, 0.1))
        assert journal.exists(), "SQLite itself no longer keeps it: removing it can go"
    assert there == [False]


def test_a_sweep_with_a_spent_journal_in_its_folder_goes_on_with_all_trials(tmp_path: Path) -> None:
    journal = tmp_path / "trials.sqlite-journal"
    with opened(tmp_path, {"seed": 0}) as store:
        for number in range(3):
            store.add(Trial(number, {"a": 1}, 0.5, None, None, 1, 0.1))
        spent = journal.read_bytes()
    journal.write_bytes(spent)
    with opened(tmp_path, {"seed": 0}) as store:
        assert list(store.trials()) == [0, 1, 2]
        store.add(Trial(3, {"a": 1}, 0.5, None, None, 1, 0.1))
    with opened(tmp_path, {"seed": 0}) as store:
        assert list(store.trials()) == [0, 1, 2, 3]
    assert not journal.exists()


def test_a_folder_that_holds_something_else_is_let_be(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match="is no earlier sweep"), opened(tmp_path, {}):
        pass
    assert os.listdir(tmp_path) == ["notes.txt"]


def test_a_parameter_of_the_sweep_cannot_be_set_as_well(tmp_path: Path) -> None:
    file = tmp_path / "sweep.yaml"
    swept = {"parameters": {"evaluation.episodes": {"grid": [1, 2]}}}
    file.write_text(json.dumps(sweep_trials.FORMULA | swept))
    with pytest.raises(UserError, match="is one of the sweep's parameters, and set as well"):
        checked(load_sweep(file), ["evaluation.episodes=3"])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"set": {"evaluation.episods": 3}}, "set: evaluation.episods=3: evaluation.episods: unknown key"),
        ({"parameters": {"evaluation.episodes": {"grid": [1, 0]}}}, "parameters: evaluation.episodes=0: "),
    ],
)
def test_a_wrong_value_of_the_sweep_is_reported_the_sweep(
    changes: dict[str, Any], message: str, tmp_path: Path
) -> None:
    file = tmp_path / "sweep.yaml"
    file.write_text(json.dumps(sweep_trials.FORMULA | changes))
    sweep = load_sweep(file)
    with pytest.raises(UserError) as refused:
        checked(sweep, [override(key, value) for key, value in sweep.set.items()])
    assert str(refused.value).startswith(f"sweep {sweep.name}: {message}")


@pytest.mark.parametrize("name", ["reservoir_grid", "reservoir_search"])
def test_the_sweeps_that_come_along_are_sound_and_leave_the_main_jobs_episodes_unseen(name: str) -> None:
    sweep = load_sweep(name)
    seen = checked(sweep, [override(key, value) for key, value in sweep.set.items()]).evaluation
    kept = load_experiment(sweep.experiment).evaluation
    assert seen.seed + seen.episodes <= kept.seed


@pytest.mark.parametrize(
    "value", [1e-05, 0.1 + 0.2, 3, True, None, "calm", [64, 64], 1e300, "1e-3", [0.1, "x"]]
)
def test_values_reach_the_experiment_with_every_bit(value: Any) -> None:
    key, _, text = override("a.b", value).partition("=")
    assert (key, yaml.safe_load(text)) == ("a.b", value)


WRONG: dict[str, dict[str, Any]] = {
    "exactly one of": {"parameters": {"a": {"grid": [1], "choice": [2]}}},
    "number of draws as trials": {"parameters": {"a": {"choice": [1, 2]}}},
    "make it a choice": {"trials": 3},
    "grid: 0.5 is there twice; name each value once": {"parameters": {"a": {"grid": [0.5, 1.0, 0.5]}}},
    "the upper end 1.0 must be more": {"parameters": {"a": {"uniform": [2.0, 1.0]}}, "trials": 3},
    "did you mean 'uniform'": {"parameters": {"a": {"unifrom": [2.0, 1.0]}}, "trials": 3},
    "must be more than 0": {"parameters": {"a": {"log_uniform": [0.0, 1.0]}}, "trials": 3},
    "objective.pilot: no pilot 'nobody'": {"objective": {"pilot": "nobody", "level": "calm"}},
    "name one of calm": {"objective": {"pilot": "ppo", "level": "storm"}},
    "did you mean 'episodes'": {"parameters": {"evaluation.episode": {"grid": [1]}}},
    "pilots.reservoir.options": {"parameters": {"pilots.reservoir.options.size": {"grid": [1]}}},
}


@pytest.mark.parametrize("message", WRONG)
def test_a_wrong_sweep_is_refused_in_one_line_before_any_work(message: str, tmp_path: Path) -> None:
    file = tmp_path / "sweep.yaml"
    file.write_text(json.dumps(sweep_trials.FORMULA | WRONG[message]))
    with pytest.raises(UserError, match=message) as error:
        checked(load_sweep(file), [])
    assert "\n" not in str(error.value)
    assert os.listdir(tmp_path) == ["sweep.yaml"]


def test_drawn_values_without_optuna_name_the_extra_and_leave_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = importlib.util.find_spec
    monkeypatch.setattr(
        "importlib.util.find_spec", lambda name, *more: None if name == "optuna" else there(name, *more)
    )
    with pytest.raises(UserError, match=r"swamp-rl\[sweep\]"):
        run_sweep("reservoir_search", out=tmp_path / "out")
    assert list(tmp_path.iterdir()) == []
