"""Reconstruction of commands between the rows of a slow log."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import Gap, RunSet
from swamp_rl.criticism.inference.sandwich_covariance import sandwich_covariance
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.nuisance.command_timing import command_changes, interpolated_at
from swamp_rl.criticism.nuisance.switching_times import promised_gain, share_equations
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection.backward_elimination import Selection, fit_by_continuation
from swamp_rl.criticism.selection.beam_search import beam_search
from swamp_rl.criticism.selection.command_reconstruction import (
    fit_switching_times,
    interpolated,
    is_refuted,
    other_commands,
    reconstruction_on_whole_runs,
)
from swamp_rl.criticism.selection.continuation import LAST, continuation_of
from swamp_rl.criticism.selection.model_selection import select_model
from tests.support.criticism import DT, SECONDS, driven, gauss_markov_noise, simulated_runs

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

Array = NDArray[np.float64]

ONE = np.array([1.0])

EVERY = 5  # rows of the truth to one of the log


def moving(run: int) -> np.ndarray:
    """(T, 8) commands that always move."""
    time = np.arange(round(SECONDS / DT)) * DT
    swing = 0.6 * np.sin(2 * np.pi * time / (14.0 + 3 * run))
    beat = 0.5 + 0.3 * np.sin(2 * np.pi * time / (11.0 + 2 * run) + run)
    return np.concatenate([np.outer(swing, [1, 1, -1, -1]), np.outer(beat, np.ones(4))], axis=1)


def logged(held: bool, every: int = EVERY) -> RunSet:
    """Runs of a boat with less thrust, whose log has one row of so many; held: the commands stood between."""
    given = np.stack([moving(run) for run in range(3)])
    if held:
        given = np.repeat(given[:, ::every], every, axis=1)
    sailed = driven([{"effect": "thrust_scale", "scale": 0.8}], given, 0.0, seed=4)
    slow = replace(sailed, commands=given[:, ::every], measured=sailed.measured[:, ::every], dt=DT * every)
    return replace(slow, lengths=np.full(3, slow.commands.shape[1]))


def test_interpolated_commands_lie_between_two_rows_and_turn_the_shorter_way() -> None:
    row = logged(held=False)
    commands = row.commands.copy()
    commands[0, 3, 0], commands[0, 4, 0] = 3.0, -3.0
    half = interpolated(replace(row, commands=commands), 0.5).commands
    assert half[0, 3, 0] == pytest.approx(np.pi)
    assert half[0, :-1, 5] == pytest.approx((commands[0, :-1, 5] + commands[0, 1:, 5]) / 2)
    assert half[:, -1] == pytest.approx(commands[:, -1])


@pytest.mark.parametrize("held", [False, True])
def test_commands_that_moved_between_rows_are_interpolated_and_held_ones_are_not(held: bool) -> None:
    log = logged(held)
    names = ("thrust_scale", "command_delay", "yaw_damping")
    instances = [instance for instance in candidates(log.boat, SECONDS) if instance.effect.name in names]
    read, _, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert found.adequate
    (scale,), *others = (x for _, x in found.winner.hypothesis.parts(found.winner.x))
    assert found.winner.hypothesis.instances[0].label == "thrust_scale"
    assert scale == pytest.approx(0.8, abs=0.02)
    # Between rows the commands are not linear to the last digit: what that leaves may be fitted, of no size.
    assert all(x == pytest.approx(1.0, abs=0.01) for x in others)
    assert np.array_equal(read.commands, log.commands) == held


def test_no_faster_actuator_stands_for_moving_commands_however_long_the_search_was() -> None:
    log = logged(held=False, every=2)
    names = ("thrust_scale", "command_delay", "azimuth_lag", "pump_lag")
    instances = [instance for instance in candidates(log.boat, SECONDS) if instance.effect.name in names]
    with using(total_budget=1.0):
        read, _, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert found.adequate and found.winner.hypothesis.label == "thrust_scale"
    assert found.winner.x == pytest.approx([0.8], abs=0.002)
    assert not np.array_equal(read.commands, log.commands)


def jumping(run: int, seconds: float = SECONDS, held: int = 23) -> np.ndarray:
    """(T, 8) commands that switch between the rows of the log, after so many steps."""
    rows = round(seconds / DT)
    rng = np.random.default_rng(run)
    levels = rng.uniform([-0.8, -0.8, 0.2, 0.0], [0.8, 0.8, 1.0, 1.0], (rows // held + 1, 4))
    step = np.arange(rows) // held
    return levels[step][:, [0, 0, 1, 1, 2, 2, 3, 3]]


def switched(
    effect: dict[str, object],
    runs: int = 3,
    seconds: float = SECONDS,
    first: int = 0,
    seed: int = 5,
    held: int = 23,
) -> tuple[Array, RunSet]:
    """Commands (R, T, 8) that switch between the rows of the log, and the log of a boat with an effect."""
    given = np.stack([jumping(first + run, seconds, held) for run in range(runs)])
    sailed = driven([effect], given, 1.0, seed=seed)
    log = replace(sailed, commands=given[:, ::EVERY], measured=sailed.measured[:, ::EVERY], dt=DT * EVERY)
    return given, replace(log, lengths=np.full(runs, log.commands.shape[1]))


@pytest.mark.parametrize("budget", [2e7, 1.0])
def test_commands_that_switch_between_two_rows_get_their_switching_times(budget: float) -> None:
    given, log = switched({"effect": "resistance", "scale": 1.5})
    names = ("resistance", "command_delay", "yaw_damping")
    instances = [instance for instance in candidates(log.boat, SECONDS) if instance.effect.name in names]
    with using(total_budget=budget):
        read, _, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert found.adequate
    assert found.winner.hypothesis.label == "resistance"
    true = given.reshape(3, -1, EVERY, 8).mean(axis=2)[:, 8:]  # later than what no window sees
    moved = log.commands[:, 8:] != true
    assert moved.any()
    error, before = (np.abs(one.commands[:, 8:] - true)[moved].mean() for one in (read, log))
    assert error < 0.4 * before


def test_a_long_run_shows_the_instant_of_each_step_though_first_estimates_go_too_far() -> None:
    given, log = switched({"effect": "resistance", "scale": 1.5}, 1, 80.0)
    weight = weights(log, noise_levels(log))
    continuation = continuation_of(log, weight)
    resistance = Hypothesis((by_label(candidates(log.boat, SECONDS))["resistance"],))
    held = continuation.fit(LAST, resistance, ONE)
    with using(reconstruction_hopeless=1e3):
        made = reconstruction_on_whole_runs(continuation, held, log)
    assert made is not None
    wider = continuation_of(made, weight)
    at = wider.at(LAST, fit_by_continuation(wider, resistance, ONE))
    assert at.chi2 < 1.3 * continuation.problems[LAST].samples < 0.02 * held.chi2
    true = given.reshape(1, -1, EVERY, 8).mean(axis=2)
    error, before = (np.abs(one.commands - true).mean() for one in (made, log))
    assert error < 0.5 * before


def test_a_long_run_has_as_many_instants_to_its_length_as_its_windows_have() -> None:
    _, log = switched({"effect": "resistance", "scale": 1.0}, 1, 100.0, held=8)
    problem = Shooting(log, weights(log, noise_levels(log)), math.inf)
    at = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states(), fresh=True)
    _, made, _ = fit_switching_times(problem, at, log, 0.0)
    assert made.chi2 < 1.2 * problem.samples < 0.1 * at.chi2


@pytest.mark.parametrize("scale", [0.6, 1.5])
def test_an_effect_keeps_its_size_although_instants_beside_the_boat_file_could_stand_for_it(
    scale: float,
) -> None:
    """How fast the boat begins to turn tells of its inertia, and when the commands changed."""
    _, log = switched({"effect": "yaw_inertia", "scale": scale}, seconds=80.0)
    names = ("yaw_inertia", "azimuth_lag")
    instances = [instance for instance in candidates(log.boat, 80.0) if instance.effect.name in names]
    read, continuation, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert read.instants is not None and found.adequate and found.stage >= LAST
    assert found.winner.hypothesis.label == "yaw_inertia"
    error = sandwich_covariance(continuation.problems[LAST], continuation.at(LAST, found.winner))[0, 0] ** 0.5
    assert found.winner.x == pytest.approx([scale], abs=3.0 * error)
    assert error < 0.05


def test_moved_commands_need_to_save_no_more_than_the_effect_that_they_replace() -> None:
    log = logged(held=False)
    continuation = continuation_of(log, weights(log, noise_levels(log)))
    known = by_label(candidates(log.boat, SECONDS))
    less = fit_by_continuation(continuation, Hypothesis((known["thrust_scale"],)), np.array([0.8]))
    both = Hypothesis((known["thrust_scale"], known["yaw_damping"]))
    more = fit_by_continuation(continuation, both, np.array([0.8, 1.0]))
    with using(reconstruction_gain=1e6):
        assert reconstruction_on_whole_runs(continuation, less, log) is None
        assert reconstruction_on_whole_runs(continuation, less, log, instead=more) is not None


def test_a_delay_of_a_part_of_a_row_is_estimated_as_it_is_in_a_slow_log() -> None:
    """A delay that mixed two commands over a row of 0.5 s was longer by as much as commands one row later."""
    delay = 0.68
    given = np.repeat(np.stack([jumping(run) for run in range(3)])[:, ::EVERY], EVERY, axis=1)
    sailed = driven([{"effect": "command_delay", "delay": delay}], given, 1.0, seed=8)
    log = replace(sailed, commands=given[:, ::EVERY], measured=sailed.measured[:, ::EVERY], dt=DT * EVERY)
    log = replace(log, lengths=np.full(3, log.commands.shape[1]))
    names = ("command_delay", "azimuth_lag")
    instances = [instance for instance in candidates(log.boat, SECONDS) if instance.effect.name in names]
    read, _, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert found.adequate and found.winner.hypothesis.label == "command_delay"
    assert found.winner.x == pytest.approx([delay], abs=0.02)
    assert np.array_equal(read.commands, log.commands)


def test_estimates_scatter_as_their_standard_errors_with_fitted_instants_say() -> None:
    """Without the uncertainty of the instants these are too small by half or more."""
    resistance = Hypothesis((by_label(candidates(load_boat("swamp"), SECONDS))["resistance"],))
    away = []
    for run in range(8):
        log = switched(
            {"effect": "resistance", "scale": 1.5}, runs=1, seconds=40.0, first=run, seed=100 + run
        )[1]
        weight = weights(log, noise_levels(log))
        held = continuation_of(log, weight)
        with using(reconstruction_hopeless=1e9):
            made = reconstruction_on_whole_runs(held, held.fit(LAST, resistance, ONE), log)
        assert made is not None
        errors = []
        for one in (made, replace(made, instants=None)):
            continuation = continuation_of(one, weight)
            at = continuation.fit(LAST, resistance, ONE)
            errors.append(sandwich_covariance(continuation.problem(LAST, resistance), at)[0, 0] ** 0.5)
        away.append((at.x[0] - 1.5) / np.array(errors))
    result, without = np.sqrt(np.mean(np.square(away), axis=0))
    assert 0.5 < result < 1.6
    assert without > 2.0


def test_nothing_is_wrong_with_a_boat_whose_commands_switch_between_the_rows_of_long_runs() -> None:
    """Middle windows need reconstructed commands, and whole runs better instants than these show."""
    log = switched({"effect": "resistance", "scale": 1.0}, 2, 80.0)[1]
    names = ("resistance", "command_delay", "yaw_damping")
    instances = [instance for instance in candidates(log.boat, 80.0) if instance.effect.name in names]
    _, _, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert not found.winner.hypothesis.instances
    assert found.adequate and found.stage >= LAST


def test_commands_that_only_creep_have_no_instants_to_fit() -> None:
    given = np.full((1, round(SECONDS / DT), 8), 0.2)
    given[..., 4:] += np.linspace(0.0, 0.4, given.shape[1])[:, None]
    log = driven([{"effect": "resistance", "scale": 1.5}], given, 0.0, 3)
    continuation = continuation_of(interpolated(log, 0.5), weights(log, noise_levels(log)))
    held = continuation.fit(LAST, Hypothesis(), np.zeros(0))
    with warnings.catch_warnings(), using(reconstruction_hopeless=1e9, reconstruction_gain=-1e9):
        warnings.simplefilter("error")
        made = reconstruction_on_whole_runs(continuation, held, log)
    assert made is not None and np.isfinite(made.commands).all()


def test_a_run_without_a_change_of_commands_has_standard_errors_as_if_commands_were_logged() -> None:
    steady = driven(
        [{"effect": "resistance", "scale": 1.5}], np.full((1, round(SECONDS / DT), 8), 0.4), 0.0, 3
    )
    weight = weights(steady, noise_levels(steady))
    resistance = Hypothesis((by_label(candidates(steady.boat, SECONDS))["resistance"],))
    errors = []
    for one in (steady, interpolated(steady, 0.5)):
        continuation = continuation_of(one, weight)
        at = continuation.fit(LAST, resistance, ONE)
        errors.append(float(sandwich_covariance(continuation.problem(LAST, resistance), at)[0, 0]))
    assert errors[1] == pytest.approx(errors[0], rel=1e-6)


def test_a_command_that_changes_within_a_row_acts_from_that_instant_on() -> None:
    given, log = switched({"effect": "resistance", "scale": 1.5})
    true = given.reshape(3, -1, EVERY, 8)
    change = command_changes(log)
    moved = np.abs(change).argmax(axis=2)[..., None]
    late = np.take_along_axis(true.mean(axis=2) - true[:, :, 0], moved, axis=2)
    of = np.take_along_axis(change, moved, axis=2)
    shares = np.divide(late, of, out=np.zeros_like(late), where=np.abs(of) > 1e-9)[..., 0]
    restored = interpolated_at(log, change, shares)
    assert restored.commands_of_parts[:, :-EVERY] == pytest.approx(given[:, :-EVERY], abs=1e-9)
    weight = weights(log, noise_levels(log))
    resistance = Hypothesis((by_label(candidates(log.boat, SECONDS))["resistance"],))
    held, right = (
        adequacy(problem, fit(problem, resistance, np.array([1.5]), problem.initial_states()))
        for problem in (Shooting(one, weight, math.inf) for one in (replace(restored, within=None), restored))
    )
    assert right.adequate
    assert right.worst < held.worst


def test_a_drifting_clock_is_named_although_commands_switch_between_two_rows() -> None:
    _, log = switched({"effect": "clock_drift", "rate": -0.03})
    names = ("clock_drift", "centre_of_gravity", "azimuth_lag")
    instances = [instance for instance in candidates(log.boat, SECONDS) if instance.effect.name in names]
    _, _, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert found.adequate and found.winner.hypothesis.label == "clock_drift"
    assert found.winner.x == pytest.approx([-0.03], abs=0.002)


def test_an_effect_that_short_windows_do_not_need_gives_way_to_commands_that_moved() -> None:
    log = logged(held=False)
    continuation = continuation_of(log, weights(log, noise_levels(log)))
    known = by_label(candidates(log.boat, SECONDS))
    both = Hypothesis((known["thrust_scale"], known["yaw_damping"]))
    winner = continuation.fit(LAST, both, np.array([0.8, 1.01]))
    found = Selection(winner, True, LAST, [], [], [], [])
    with using(clearly=1e3):
        moved, (kept, _), _ = next(other_commands(continuation, found, log, spent=True))
    assert kept.label == "thrust_scale"
    with using(clearly=1e5):
        assert next(other_commands(continuation, found, log, spent=True))[1][0] == Hypothesis()
    true = np.stack([moving(run) for run in range(3)]).reshape(3, -1, EVERY, 8).mean(axis=2)
    error, before = (np.abs(one.commands - true).mean() for one in (moved, log))
    assert error < 0.2 * before


def test_commands_that_move_all_the_time_move_within_a_row_too() -> None:
    log, given = logged(held=False), np.stack([moving(run) for run in range(3)])
    true = given.reshape(3, -1, EVERY, 8)[:, :-1]
    change = command_changes(log)
    # a command held for a fifth of the row lags behind a straight line by a tenth
    restored = interpolated_at(log, change, np.full(change.shape[:2], 0.4))
    parts = restored.commands_of_parts.reshape(3, -1, EVERY, 8)[:, :-1]
    assert parts.mean(axis=2) == pytest.approx(restored.commands[:, :-1])
    held = np.abs(log.commands[:, :-1, None] - true).max()
    assert np.abs(parts - true).max() < 0.1 * held


@pytest.mark.parametrize(("held", "lost"), [(False, 0), (False, 12), (True, 0)])
def test_whole_runs_show_by_what_share_commands_moved_between_rows(held: bool, lost: int) -> None:
    log = logged(held, every=2)
    if lost:
        measured, rows = log.measured.copy(), slice(80, 80 + lost)
        measured[1, rows] = np.nan
        log = replace(log, measured=measured, gaps=(Gap(1, rows.start, lost),))
    continuation = continuation_of(log, weights(log, noise_levels(log)))
    scale = by_label(candidates(log.boat, SECONDS))["thrust_scale"]
    at = continuation.fit(LAST, Hypothesis((scale,)), np.array([0.8]))
    moved = reconstruction_on_whole_runs(continuation, at, log)
    assert (moved is None) == held
    if moved:
        # of the two steps of a row the second has half of the change
        assert moved.commands == pytest.approx(interpolated(log, 0.25).commands, abs=0.002)


def test_commands_that_moved_and_positions_that_wander_are_distinguished_together() -> None:
    log = logged(held=False)
    wander = gauss_markov_noise(np.random.default_rng(8), log.measured[..., :2].shape, 0.4, 4.0)
    measured = log.measured.copy()
    measured[..., :2] += wander
    log = replace(log, measured=measured)
    names = ("thrust_scale", "yaw_damping")
    instances = [instance for instance in candidates(log.boat, SECONDS) if instance.effect.name in names]
    read, _, found = select_model(log, weights(log, noise_levels(log)), instances, None)
    assert found.adequate
    (scale,), *others = (x for _, x in found.winner.hypothesis.parts(found.winner.x))
    assert scale == pytest.approx(0.8, abs=0.02)
    assert all(x == pytest.approx(1.0, abs=0.01) for x in others)  # as above
    assert read.gauss_markov is not None and not np.array_equal(read.commands, log.commands)


def test_other_commands_are_refuted_by_whole_runs_that_the_logged_ones_explain() -> None:
    log = logged(held=True)
    weight = weights(log, noise_levels(log))
    instances = [instance for instance in candidates(log.boat, SECONDS) if instance.label == "thrust_scale"]
    right, wrong = (continuation_of(one, weight) for one in (log, interpolated(log, 1.0)))
    found = beam_search(right, instances, None)
    whole = replace(found, winner=right.at(LAST, found.winner), stage=LAST)
    assert found.adequate and is_refuted(right, whole, wrong)
    assert not is_refuted(right, replace(whole, adequate=False), wrong)
    worse = replace(whole, winner=wrong.fit(LAST, found.winner.hypothesis, found.winner.x))
    assert not is_refuted(wrong, worse, right)


def test_a_search_for_faster_actuators_is_not_repeated_with_the_same_commands() -> None:
    runs = simulated_runs([{"effect": "azimuth_lag", "time_constant": 0.107}])
    continuation = continuation_of(runs, weights(runs, noise_levels(runs)))
    lag = by_label(candidates(runs.boat, SECONDS))["azimuth_lag"]
    winner = continuation.fit(LAST, Hypothesis((lag,)), np.array([0.107]))
    nothing = fit_by_continuation(continuation, Hypothesis(), np.zeros(0))
    assert nothing.chi2 < fit_by_continuation(continuation, Hypothesis((lag,)), winner.x).chi2 + 9.0
    found = Selection(winner, True, LAST, [], [], [], [])
    attempts = other_commands(continuation, found, runs, spent=False)
    assert not any(np.array_equal(other.commands, runs.commands) for other, _, _ in attempts)


def test_normal_equations_promise_about_what_fitted_switching_times_save() -> None:
    _, log = switched({"effect": "resistance", "scale": 1.5})
    problem = Shooting(log, weights(log, noise_levels(log)), 5.0)
    resistance = Hypothesis((by_label(candidates(log.boat, SECONDS))["resistance"],))
    at = fit(problem, resistance, ONE, problem.initial_states(), fresh=True)
    change = command_changes(log)
    shares = np.zeros(change.shape[:2])
    promised = promised_gain(share_equations(problem, at, change, shares, 0.0))
    _, made, _ = fit_switching_times(problem, at, log, 0.0)
    saved = at.chi2 - made.chi2
    assert saved > 500.0
    assert 0.5 * saved < promised < 2.0 * saved
    with using(instants_reach=1e-9):
        given_up = fit_switching_times(problem, at, log, 0.0, None, made.chi2, costs=True)[1]
    assert given_up.chi2 == pytest.approx(at.chi2, rel=1e-3)
