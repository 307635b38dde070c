"""A whole experiment gives the same bits on one thread and on two."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from swamp_rl.one_thread import one_thread, threads
from swamp_rl.pilots.readout import Moments, ridge_readouts
from tests.support.tiny_experiment import content

EXPERIMENT = """
name: threads
boat: swamp
course: camogli
time_limit: 30.0
data: {record: {good: 4, failed: 0, disturbances: standard}}
pilots:
  scripted: {kind: scripted}
  reservoir: {kind: reservoir, options: {units: 300}}
  searched: {kind: reservoir-searched, options: {units: [150], spectral_radius: [0.2, 0.5], folds: 2}}
  cloning: {kind: cloning, options: {epochs: 3}}
  gru: {kind: gru, options: {epochs: 2}}
  dagger: {kind: dagger, options: {rounds: 1, runs: 1, trials: 4}}
  ppo:
    kind: ppo
    options: {decisions: 2048, boats: 16, horizon: 64, batch_size: 512, leg: 1}
  sac:
    kind: sac
    options: {decisions: 512, boats: 16, random: 128, updates: 2, leg: 16}
evaluation: {levels: [standard], episodes: 260, seed: 1, shown: 2}
"""
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("threads")]  # longest of all: begun early

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
RUN = """
from swamp_rl.experiments.studies.run import run_experiment
from tests.support.tiny_experiment import empty_figures
with empty_figures():
    run_experiment('threads.yaml', out='results')
"""


def results_on(count: int, folder: Path) -> dict[str, Any]:
    """All of a result that does not depend on when it came about, made by a process of so many threads."""
    folder.mkdir()
    (folder / "threads.yaml").write_text(EXPERIMENT)
    more = {"OMP_WAIT_POLICY": "passive", "PYTHONPATH": str(Path(__file__).parents[1])}
    environment = os.environ | dict.fromkeys(VARIABLES, str(count)) | more
    done = subprocess.run(
        [sys.executable, "-c", RUN], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return content(folder / "results")


@pytest.mark.timed
def test_every_pilot_and_table_has_the_same_bits_on_one_thread_and_on_two(tmp_path: Path) -> None:
    one, two = (results_on(count, tmp_path / str(count)) for count in (1, 2))
    assert sum(name.endswith("weights.safetensors") for name in one) == 8
    assert one.keys() == two.keys()
    assert [name for name in one if one[name] != two[name]] == []


def test_linear_algebra_has_one_thread_within_the_block_and_as_many_as_before_after_it() -> None:
    with threadpool_limits(2, "blas"):
        assert threads()["linear_algebra"] == 2
        with one_thread():
            assert threads()["linear_algebra"] == 1
            with one_thread(torch=True):
                assert (threads()["linear_algebra"], threads()["torch"]) == (1, 1)
            assert threads()["linear_algebra"] == 1
        assert threads()["linear_algebra"] == 2


def test_a_decorated_function_still_returns_what_it_does() -> None:
    rng = np.random.default_rng(0)
    moments = Moments.of([rng.normal(size=(50, 8))], [rng.normal(size=(50, 2))])
    [plain], [decorated] = ridge_readouts(moments, [1.0]), one_thread()(ridge_readouts)(moments, [1.0])
    np.testing.assert_allclose(plain, decorated, rtol=1e-9)
