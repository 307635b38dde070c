"""The same sweep on a Ray cluster of two nodes on this machine, one of which is killed half-way."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest
from swamp_rl.experiments.fleet import diagnose_fleet
from swamp_rl.experiments.fleet.result import Fleet
from swamp_rl.experiments.sweep.run import run_sweep

from swamp_rl.errors import UserError
from swamp_rl.workers.cluster import RayPool
from tests.support import sweeps as sweep_trials
from tests.support.fleets import datasets, pretend
from tests.support.patience import PATIENCE
from tests.support.sweep_pools import PoolHere, summary_of, swept
from tests.support.sweeps import DRAWN, FORMULA, sweep_of

pytestmark = [
    pytest.mark.timed,
    pytest.mark.slow,
    pytest.mark.xdist_group("ray"),
]  # a cluster takes long to start: one for the whole module

MASS = {"effect": "mass", "parameter": "mass", "value": 62.0, "error": 0.2, "gain": 80.0}
FLEET = {f"boat{number}": {"causes": [MASS] if number % 2 else []} for number in range(6)}
LOOPBACK_ONLY = {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0", "RAY_USAGE_STATS_ENABLED": "0"}
SOON = {
    "RAY_worker_niceness": "0",  # 15 of itself, which on a busy machine is never
    "RAY_health_check_initial_delay_ms": "500",
    "RAY_health_check_period_ms": "500",
    "RAY_health_check_timeout_ms": "60000",  # a node that is dead refuses; one that is busy answers late
}


@pytest.fixture(scope="module")
def on_ray(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of what `tests.support.sweep_on_ray` found."""
    folder = tmp_path_factory.mktemp("ray")
    fixed = {"evaluation.episodes": 6, "pilots.reservoir.takeover": 0.0}
    parameters = {"pilots.reservoir.options.units": {"grid": [20, 60]}}
    (folder / "sweep.yaml").write_text(json.dumps(FORMULA | {"set": fixed, "parameters": parameters}))
    datasets(folder / "datasets", FLEET)
    asked = [sys.executable, "-m", "tests.support.sweep_on_ray", str(folder)]
    with subprocess.Popen(
        asked, env=os.environ | LOOPBACK_ONLY | SOON, stderr=subprocess.PIPE, text=True
    ) as running:
        try:
            _, error = running.communicate(timeout=3 * PATIENCE)  # three sweeps and a fleet
        finally:
            if running.poll() is None:
                family = [psutil.Process(running.pid), *psutil.Process(running.pid).children(recursive=True)]
                for process in family:
                    process.kill()
    assert running.returncode == 0, error
    return folder


def found(file: Path) -> dict[str, Any]:
    return json.loads(file.read_text())


def test_a_killed_nodes_trial_is_done_elsewhere_and_nothing_is_lost(on_ray: Path, tmp_path: Path) -> None:
    trials = swept(tmp_path, sweep_of(), PoolHere(sweep_trials.formula, 1, 0))
    killed = found(on_ray / "killed.json")
    assert sorted(one["attempts"] for one in killed["measured"].values()) == [1] * 8 + [2]
    assert {**killed, "measured": None} == summary_of(sweep_of(), trials)


def test_a_search_finds_the_same_on_a_cluster(on_ray: Path, tmp_path: Path) -> None:
    trials = swept(tmp_path, sweep_of(**DRAWN), PoolHere(sweep_trials.formula, 1, 0))
    assert {**found(on_ray / "search.json"), "measured": None} == summary_of(sweep_of(**DRAWN), trials)


def test_a_file_gives_the_same_results_on_a_cluster_and_in_processes(on_ray: Path, tmp_path: Path) -> None:
    run_sweep(on_ray / "sweep.yaml", out=tmp_path / "processes", workers=1)
    here, there = (found(folder / "sweep.json") for folder in (tmp_path / "processes", on_ray / "file"))
    assert [trial["summary"]["episodes"] for trial in here["trials"]] == [6, 6]
    assert {**there, "measured": None} == {**here, "measured": None}
    assert (on_ray / "file" / "sweep.png").read_bytes().startswith(b"\x89PNG")


def test_a_fleet_is_the_same_on_two_nodes_and_in_this_process(on_ray: Path, tmp_path: Path) -> None:
    here = diagnose_fleet(
        sorted((on_ray / "datasets").iterdir()), tmp_path / "here", pool=PoolHere(pretend, 1, 0)
    )
    there = Fleet.model_validate_json((on_ray / "fleet" / "fleet.json").read_text())
    assert [one.boats for one in there.shared] == [["boat1", "boat3", "boat5"]]
    assert there.model_dump() | {"measured": None} == here.model_dump() | {"measured": None}


@pytest.mark.parametrize("address", ["127.0.0.1:1", "ray://127.0.0.1:1", "127.0.0.1:99999"])
def test_where_no_cluster_answers_it_is_said_in_one_line(address: str) -> None:
    with pytest.raises(UserError, match=f"--ray {address}: no cluster answers") as error:
        RayPool(sweep_trials.formula, address)
    assert "\n" not in str(error.value)


def test_an_empty_address_is_no_cluster_and_starts_none(tmp_path: Path) -> None:
    for address in ("", " "):
        with pytest.raises(UserError, match="--ray is empty; give the address of a cluster"):
            run_sweep("reservoir_grid", out=tmp_path / "sweeps" / "out", ray=address)
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_that_no_cluster_takes_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no cluster answers"):
        run_sweep("reservoir_grid", out=tmp_path / "sweeps" / "out", ray="127.0.0.1:1")
    assert list(tmp_path.iterdir()) == []
