"""Blind cases that a search once answered wrongly, and why."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.blind.cases import written
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.diagnose import examine, prepared
from swamp_rl.criticism.model.candidates import Hypothesis, by_label
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.continuation import continuation_of

pytestmark = [pytest.mark.slow, pytest.mark.numerical]


def test_moved_commands_that_middle_windows_allow_and_whole_runs_do_not_hide_no_effect(
    tmp_path: Path,
) -> None:
    """An asymmetric drag in gate runs: beside instants of their own the boat file leaves noise in windows of
    20 s, but not in whole runs, which the effect explains by 5,700 of chi2."""
    data, _ = written(34120, "C", tmp_path)
    found = examine(read_run_set(data, load_boat("swamp")), None, np.random.default_rng(0)).diagnosis
    assert found.verdict == "cause" and [cause.effect for cause in found.causes] == ["drag_asymmetry"]
    port = found.causes[0].parameters["port"]
    assert port.value == pytest.approx(0.5517, abs=4.0 * port.standard_error)


def test_what_short_windows_explain_otherwise_is_found_by_a_second_effect(tmp_path: Path) -> None:
    """Shallow water with a lag of the azimuths: alone, a thrust deduction fits the shortest windows far
    better than either, and no second effect beside it leaves noise on longer ones."""
    data, _ = written(33054, "X", tmp_path)
    found = examine(read_run_set(data, load_boat("swamp-light")), None, np.random.default_rng(0)).diagnosis
    assert found.verdict == "cause"
    assert {cause.effect for cause in found.causes} == {"shallow_water", "azimuth_lag"}


def test_commands_between_rows_are_not_taken_for_faster_azimuths(tmp_path: Path) -> None:
    """A thrust loss across the flow in a log at 5 Hz: with moved commands it alone explains 18 more than with
    azimuths without a lag; a search with these commands adds the inertia."""
    data, _ = written(33188, "X", tmp_path)
    found = examine(read_run_set(data, load_boat("swamp")), None, np.random.default_rng(0)).diagnosis
    assert found.verdict == "cause"
    assert [cause.effect for cause in found.causes] == ["crossflow_thrust_loss"]


def test_a_dead_band_of_which_a_score_test_promises_half_is_not_named_as_an_efficiency_curve(
    tmp_path: Path,
) -> None:
    """A dead band of 0.4 % of the throttle: on whole runs it saves 4,800 of chi2, of which the derivative at
    no dead band promises 2,300, and its criterion is 32 below that of a curve."""
    data, _ = written(36171, "P", tmp_path)
    runs = read_run_set(data, load_boat("swamp"))
    known = prepared(runs)
    found = beam_search(continuation_of(runs, known.weight), known.instances, known.hull)
    assert found.winner.hypothesis.label == "throttle_dead_band bp"


def test_initial_states_of_a_steep_window_do_not_end_in_a_local_minimum(tmp_path: Path) -> None:
    """A sway of 0.14 m/s for one of 0.03 m/s turns the boat by 0.4 rad in 5 s: full steps from the smoothed
    states had led to a surge of -6 m/s."""
    data, _ = written(34243, "B", tmp_path)
    runs = read_run_set(data, load_boat("swamp"))
    known = prepared(runs)
    continuation = continuation_of(runs, known.weight)
    truth = Hypothesis((by_label(known.instances)["heading_bias"],))
    made = continuation.fit(0, truth, np.array([-0.1395]))
    assert made.chi2 < 1.05 * continuation.problems[0].samples
    assert np.abs(made.states[:, 3]).max() < 2.5
