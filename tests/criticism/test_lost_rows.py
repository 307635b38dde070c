"""Commands and initial states at lost rows."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.synthetic.cases import write_runs

from swamp_rl.api import simulate
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import Gap, RunSet, read_run_set
from swamp_rl.criticism.data.windows import cut
from swamp_rl.criticism.inference.sandwich_covariance import sandwich_covariance
from swamp_rl.criticism.likelihood.finite_differences import parameter_jacobian
from swamp_rl.criticism.likelihood.initial_states import levels_and_slopes, smoothed_states
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.nuisance.command_timing import with_unlogged_commands
from swamp_rl.criticism.nuisance.lost_rows import (
    possible_commands,
    with_best_commands,
    with_relevant_gaps,
)
from swamp_rl.criticism.options import using
from swamp_rl.criticism.selection import continuation
from swamp_rl.criticism.selection.continuation import LAST, continuation_of, with_corrected_commands
from swamp_rl.errors import UserError
from tests.support.criticism import commands, driven

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

ROW = 150


def test_an_unlogged_command_between_two_equal_rows_is_found() -> None:
    given = np.stack([commands(0), commands(2)])
    given[1, ROW, :4] += 1.2
    sailed = driven([], given, 0.0, seed=11, name="swamp-thesis")
    read, measured = given.copy(), sailed.measured.copy()
    read[1, ROW], measured[1, [ROW, 260]] = given[1, ROW - 1], np.nan
    found = replace(sailed, commands=read, measured=measured)
    problem = Shooting(found, weights(found, noise_levels(found)), np.inf)
    at = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states(), fresh=True)
    again = with_unlogged_commands(problem, at)
    assert again is not None
    changed = np.flatnonzero((again.commands != read).any(axis=(0, 2)))
    assert list(changed) == [ROW]
    better = Shooting(again, problem.weight, np.inf)
    assert fit(better, Hypothesis(), np.zeros(0), at.states).chi2 < at.chi2 - 100.0
    assert (
        with_unlogged_commands(better, fit(better, Hypothesis(), np.zeros(0), at.states, fresh=True)) is None
    )


def test_commands_in_lost_rows_are_given_up_once_they_cannot_make_the_residual_noise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sailed = driven(
        [{"effect": "resistance", "scale": 1.1}], np.stack([commands(0), commands(2)]), 0.0, seed=11
    )
    measured = sailed.measured.copy()
    measured[:, [ROW, 260]] = np.nan
    found = replace(sailed, measured=measured)
    problem = Shooting(found, weights(found, noise_levels(found)), np.inf)
    at = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states(), fresh=True)
    rounds = list[int]()

    def counted(*given: Shooting) -> RunSet | None:
        rounds.append(1)
        return with_unlogged_commands(*given)

    monkeypatch.setattr(continuation, "with_unlogged_commands", counted)
    with using(nearly_noise=np.inf):
        assert with_corrected_commands(problem, at) == (problem, at)
    assert len(rounds) == 1


def test_a_standard_error_counts_that_the_command_in_lost_rows_is_unknown() -> None:
    """As a further parameter does: the number of the gap's rows after which it changed, equally likely."""
    given = np.zeros((1, 300, 8))
    given[:, :, 4:] = np.where(np.arange(300) < ROW, 0.5, 0.9)[None, :, None]
    sailed = driven([{"effect": "resistance", "scale": 1.2}], given, 1.0, seed=3)
    lost, measured = 4, sailed.measured.copy()
    measured[:, ROW - 2 : ROW + 2] = np.nan
    log = replace(sailed, measured=measured, gaps=(Gap(0, ROW - 2, lost),))
    resistance = Hypothesis((by_label(candidates(log.boat, 30.0))["resistance"],))
    continuation = continuation_of(log, weights(log, noise_levels(log)))
    at = continuation.fit(LAST, resistance, np.array([1.2]))
    problem = continuation.problem(LAST, resistance)
    (gap,) = problem.run_set.filled
    result = sandwich_covariance(problem, at)[0, 0]
    problem.run_set = replace(problem.run_set, filled=())
    known = sandwich_covariance(problem, at)[0, 0]

    base = problem.track(resistance, at.x, at.states)
    commands = problem.run_set.commands.copy()
    commands[0, int((commands[0, :, 4] == 0.5).sum()) - 1] = commands[0, -1]  # a row earlier
    moved = problem.with_commands(replace(problem.run_set, commands=commands))
    earlier = problem.standardised(moved.track(resistance, at.x, at.states) - base)
    by_x = parameter_jacobian(problem, resistance, at.x, at.states, base)
    slopes = np.concatenate([at.states_jacobian[0], by_x[0], earlier.reshape(-1, 1)], axis=1)
    information = slopes.T @ slopes
    alone = np.linalg.inv(information[:-1, :-1])[-1, -1]
    information[-1, -1] += 1.0 / np.var(np.arange(gap.rows + 1))
    assert result / known == pytest.approx(np.linalg.inv(information)[-2, -2] / alone, rel=0.05)
    assert result > 1.1 * known


def test_a_throttle_that_jumps_in_a_lost_row_of_a_run_of_ramps_is_not_interpolated() -> None:
    given = np.stack([commands(1), commands(2)])
    given[1, :, :4] = 0.3 * np.sin(0.05 * np.arange(given.shape[1]))[:, None]
    given[1, :ROW, 4:] *= 0.4
    sailed = driven([], given, 0.8, seed=5)
    log, measured = given.copy(), sailed.measured.copy()
    log[1, ROW] = 0.5 * (given[1, ROW - 1] + given[1, ROW + 1])
    measured[1, ROW] = np.nan
    found = replace(sailed, commands=log, measured=measured, gaps=(Gap(1, ROW, 1),))
    continuation = continuation_of(found, weights(found, noise_levels(found)))
    continuation.boat_file(LAST)
    filled = continuation.problem(LAST, Hypothesis()).run_set.commands
    assert filled[1, ROW, 4:] == pytest.approx(given[1, ROW, 4:], abs=0.02)
    smooth = replace(found, gaps=(Gap(1, ROW + 50, 1),))
    continuation = continuation_of(smooth, weights(smooth, noise_levels(smooth)))
    continuation.boat_file(LAST)
    assert np.array_equal(continuation.problem(LAST, Hypothesis()).run_set.commands, log)


@pytest.mark.parametrize("held", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("rows", [(ROW, ROW + 5), (ROW - 20, ROW, ROW + 5)])
@pytest.mark.parametrize("seed", range(3))
def test_commands_in_lost_rows_half_a_second_apart_are_both_found(
    held: float, rows: tuple[int, ...], seed: int
) -> None:
    """As of a lever thrown over and back: held is the share of its change that the log has in a lost row."""
    given = np.zeros((1, 300, 8))
    given[..., 4:] = 0.8
    given[0, :, :2] = -1.5
    given[0, : ROW - 20, :2] = 0.5
    given[0, ROW : ROW + 5, :2] = 1.5
    sailed = driven([], given, 0.0, seed=seed)
    gaps = tuple(Gap(0, row, 1) for row in rows)
    log, measured = given.copy(), sailed.measured.copy()
    for gap in gaps:
        log[0, gap.row] = (1.0 - held) * given[0, gap.row - 1] + held * given[0, gap.row]
        measured[0, gap.row] = np.nan
    found = replace(sailed, commands=log, measured=measured, gaps=gaps)
    weight = weights(found, noise_levels(found))
    read = with_best_commands(found, weight, gaps, Hypothesis(), np.zeros(0))
    np.testing.assert_allclose(read.commands, given, atol=1e-9)


def test_a_part_of_the_runs_has_their_gaps_and_copies_with_other_commands_have_none() -> None:
    log = driven([], np.stack([commands(run) for run in range(3)]), 0.0, seed=1)
    gaps = Gap(0, 10, 1), Gap(2, 20, 2)
    log = replace(log, gaps=gaps, filled=gaps)
    part, copies = log.subset([1, 2]), log.copies([2, 2], log.commands[[2, 2]])
    assert part.gaps == part.filled == (Gap(1, 20, 2),)
    assert copies.gaps == copies.filled == ()


@pytest.mark.parametrize(("period", "unknown"), [(6.0, True), (np.inf, False)])
def test_lost_rows_longer_than_commands_are_held_for_may_hide_a_change(
    tmp_path: Path, period: float, unknown: bool
) -> None:
    """Four seconds are lost between rows of equal commands, which a zig-zag changes every three seconds."""
    boat, time = load_boat("swamp-light"), 0.1 * np.arange(600)
    given = np.full((600, 8), 0.5)
    given[:, :4] = np.where(time % period < 0.5 * period, 0.3, -0.3)[:, None]
    given[550:, 4:] = 0.9
    sailed = simulate(boat, given)
    kept = np.ones(len(sailed.time), dtype=bool)
    kept[225:265] = kept[405] = False  # both rows beside are of the same side
    columns = {key: values[kept] for key, values in sailed.columns.items()}
    write_runs(tmp_path, "swamp-light", boat, [columns], "scripted", "csv", rate=10.0)
    gaps = read_run_set(tmp_path, boat).gaps
    assert gaps == ((Gap(0, 225, 40),) if unknown else ())


def test_smoothing_is_exact_on_a_parabola_and_on_a_line_through_two_samples() -> None:
    place = np.linspace(-1.0, 1.0, 9)
    values = (2.0 - 3.0 * place + 0.5 * place**2)[None, :, None]
    level, slope = levels_and_slopes(place, values, np.ones(values.shape, bool))
    assert (level[0, 0], slope[0, 0]) == pytest.approx((2.0, -3.0))
    two = np.isin(np.arange(9), [2, 6])[None, :, None]
    level, slope = levels_and_slopes(place, values, two)
    a, b = values[0, [2, 6], 0]
    assert (level[0, 0], slope[0, 0]) == pytest.approx(((a + b) / 2, b - a))
    level, slope = levels_and_slopes(place, values, np.zeros(values.shape, bool))
    assert (level[0, 0], slope[0, 0]) == (0.0, 0.0)


def test_the_initial_state_amid_lost_rows_is_interpolated() -> None:
    sailed = driven([], np.stack([commands(0), commands(2)]), 0.02, seed=3)
    measured = sailed.measured.copy()
    lost = slice(ROW, ROW + 40)
    measured[0, lost] = np.nan
    sparse = replace(sailed, measured=measured)
    problem = Shooting(sparse, weights(sparse, noise_levels(sparse)), np.inf)
    for first in (ROW + 1, ROW + 20, ROW + 38):
        window = replace(problem.windows, run=np.array([0]), first=np.array([first]), steps=np.array([50]))
        initial_states = smoothed_states(sparse, problem.weight, window)[0]
        across = [measured[0, ROW - 1], measured[0, ROW + 40]]
        place = (first - ROW + 1) / 41.0
        assert initial_states[:3] == pytest.approx(
            across[0][:3] + place * (across[1][:3] - across[0][:3]), abs=0.1
        )
        assert np.abs(initial_states[3:5]).max() < 2.0


def test_windows_end_at_a_short_gap_before_a_long_one() -> None:
    given = np.zeros((1, 400, 8))
    given[:, :, 4:] = np.where(np.arange(400) < ROW, 0.5, 0.9)[None, :, None]
    sailed = driven([], given, 1.0, seed=3)
    log = replace(sailed, gaps=(Gap(0, ROW - 2, 4), Gap(0, 250, 10)))
    weight = weights(log, noise_levels(log))
    relevant = with_relevant_gaps(log, weight)
    assert relevant.gaps == log.gaps
    windows = cut(relevant, weight, np.inf)
    assert list(windows.first + windows.steps) == [ROW - 3, 249, 399]


def test_windows_after_a_gap_begin_once_azimuths_no_longer_hang_on_the_lost_commands() -> None:
    given = np.zeros((1, 400, 8))
    swing = np.where(np.arange(400) < ROW, -1.2, 1.4)[:, None]
    given[0, :, :4], given[0, :, 4:] = swing * [1.0, 1.0, -1.0, -1.0], 0.6
    sailed = driven([], given, 1.0, seed=3)
    late = given.copy()
    late[:, ROW : ROW + 4] = given[:, ROW - 1, None]
    sailed.measured[:, ROW : ROW + 4] = np.nan
    losses = []
    for commands_read in (given, late):
        log = replace(sailed, commands=commands_read, gaps=(Gap(0, ROW, 4),))
        problem = Shooting(log, weights(log, noise_levels(log)), 20.0)
        losses.append(fit(problem, Hypothesis(), np.zeros(0), problem.initial_states()).chi2)
    assert losses[1] == pytest.approx(losses[0], abs=5.0)


def test_another_azimuth_in_a_gap_lies_on_the_shorter_way_round() -> None:
    log = driven([], np.stack([commands(2)]), 0.0, seed=1)
    log.commands[0, :ROW, 0], log.commands[0, ROW:, 0] = 3.0, -3.0
    half, _ = possible_commands(log, Gap(0, ROW, 1))[2]  # after the instants before and after the row
    assert half[0, 0] == pytest.approx(np.pi)


def test_runs_without_a_stretch_between_lost_commands_are_refused() -> None:
    sailed = driven([], np.stack([commands(0)]), 1.0, seed=3)
    log = replace(sailed, gaps=tuple(Gap(0, row, 8) for row in range(20, 390, 12)))
    with pytest.raises(UserError, match="so often that no 1"):
        cut(log, weights(log, noise_levels(log)), 5.0)
