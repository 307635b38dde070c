"""The hashes that a folder of results keeps of the runs that its pilots learned from."""

import subprocess
from pathlib import Path

import pytest
from swamp_rl.experiments.config.digests import digest, hashes, write_hashes

from swamp_rl.boat import load_boat
from swamp_rl.runs import Run, append_run, create_dataset
from swamp_rl.runs.schema import meta_of
from tests.support.runs import circling


def test_runs_from_elsewhere_are_checked_from_within_the_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    create_dataset(Path("runs"), meta_of(load_boat("swamp"), "swamp", 10.0, "measured"))
    append_run(Path("runs"), Run("one", circling()))
    results = Path("results") / "mine"
    results.mkdir(parents=True)
    assert write_hashes(Path("runs"), results) == digest(hashes(Path("runs")))
    check = ["sha256sum", "--check", "--quiet", "data.sha256"]
    subprocess.run(check, cwd=results, check=True)
    with Path("runs/dataset.yaml").open("a") as file:
        file.write("# changed\n")
    assert subprocess.run(check, cwd=results, capture_output=True).returncode == 1
