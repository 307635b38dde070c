"""`identify boat` on runs of a hidden boat: its numbers, its wiring, its file, and what it refuses."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit import identify
from swamp_rl.boat_fit.boat_file import Fitted
from swamp_rl.boat_fit.diverging import implausible_fit
from swamp_rl.boat_fit.fit import (
    fit_boat,
    fit_windows,
    likeliest,
    lost_freedom,
    soft_weights,
    sound_fit,
)
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.boat_fit.identify import identify_boat, numbers_of
from swamp_rl.boat_fit.pieces import split
from swamp_rl.boat_fit.report import next_runs, not_better, summary
from swamp_rl.boat_fit.wiring import Wiring
from swamp_rl.boat_numbers.numbers import COMPASS, free_numbers, without_compass
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters
from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture
from tests.support.from_scratch import written
from tests.support.hidden_boat import HIDDEN, hidden, start_runs
from tests.support.sailing import sailed_dataset

WIRED = (
    HIDDEN
    + """  - {effect: channel_swap, thruster: [port, starboard]}
  - {effect: throttle_reversed, thruster: port}
"""
)
SATURATED = "  - {effect: thruster_efficiency_curve, thruster: all, at_100: 0.6}\n"
FIVE = 1  # place of the horizon of 5 s among those of the report


def by_name(fitted: list[Fitted]) -> dict[str, Fitted]:
    return {one.number.name: one for one in fitted}


def test_a_hidden_boat_is_found_within_its_intervals(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN.replace("effects", "x_g: 0.02\neffects") + SATURATED)
    hypothesis = free_boat(runs.boat, free_numbers(runs.boat))
    made = fit_boat(runs, weights(runs, noise_levels(runs)), hypothesis, hypothesis.start())
    found = by_name(numbers_of(made))
    truth = {
        "hull.n_r": -0.11,
        "hull.c_d": 1.3,
        "resistance.x_0_ahead": -0.09,
        "x_g": 0.02,
        "added_mass_sway": -10.0,
        "effects.throttle_dead_band.below.port": 0.1,
        "thrusters.starboard.thrust_quadratic": 7.0,
        "effects.thruster_efficiency_curve.at_100.starboard": 0.6,
    }
    for name, value in truth.items():
        assert abs(found[name].value - value) < 4.0 * found[name].standard_error, name
    assert found["hull.n_r"].shown and found["x_g"].shown
    assert found["effects.thruster_efficiency_curve.at_100.starboard"].shown


def test_runs_without_noise_leave_the_common_factor_of_mass_and_forces_to_its_prior(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, "extends: twin.yaml\nname: hidden\nhull: {n_r: -0.11}\n", count=1, noise=0.0)
    numbers = free_numbers(runs.boat)
    hypothesis = free_boat(runs.boat, numbers)
    made = fit_boat(runs, weights(runs, noise_levels(runs)), hypothesis, hypothesis.start())
    mass = by_name(numbers_of(made))["mass"]
    assert abs(mass.x) < 2.0 * mass.sd
    assert mass.sd > 0.3 * mass.number.sd


def test_a_thruster_that_was_idle_gets_the_thrust_of_its_equal(tmp_path: Path) -> None:
    both = "thrusters: {port: {thrust_quadratic: 6.0}, starboard: {thrust_quadratic: 6.0}}\n"
    truth, start = hidden(tmp_path, "extends: twin.yaml\nname: hidden\n" + both), tmp_path / "twin.yaml"
    sailed_dataset(tmp_path / "runs", start, truth, count=1, low=0.0, idle=("starboard",))
    runs = read_run_set(tmp_path / "runs", load_boat(tmp_path / "twin.yaml"))
    numbers = tuple(one for one in free_numbers(runs.boat) if one.name.endswith("thrust_quadratic"))
    hypothesis = free_boat(runs.boat, numbers)
    made = fit_boat(runs, weights(runs, noise_levels(runs)), hypothesis, hypothesis.start())
    found = by_name(numbers_of(made))
    port, starboard = (found[f"thrusters.{name}.thrust_quadratic"] for name in ("port", "starboard"))
    assert port.value == pytest.approx(6.0, rel=0.05)
    assert 0.8 < (starboard.value - starboard.number.start) / (port.value - port.number.start) < 1.0
    assert port.standard_error < 0.2 * port.prior_sd < starboard.standard_error


@pytest.mark.slow
def test_the_file_beats_what_is_trivial_and_says_which_numbers_the_runs_do_not_show(tmp_path: Path) -> None:
    truth = hidden(tmp_path, HIDDEN)
    sailed_dataset(tmp_path / "runs", tmp_path / "twin.yaml", truth, low=0.0, seconds=40.0)
    found = identify_boat(tmp_path / "runs", tmp_path / "twin.yaml", tmp_path / "new.yaml")
    assert "effects.heading_bias.bias" not in by_name(list(found.fitted))
    assert not_better(found.after) == []
    assert found.after[FIVE].boat_file < 0.3 * found.before[FIVE].boat_file
    assert load_boat(tmp_path / "new.yaml") == found.boat
    astern = by_name(list(found.fitted))["thrusters.port.astern_quadratic"]
    assert not astern.shown
    assert astern.value == pytest.approx(astern.number.start, abs=0.5 * astern.prior_sd)
    origin = found.boat.provenance["thrusters.port.astern_quadratic"]
    assert origin.provenance == "assumed" and "not identifiable from" in origin.source
    assert any("astern of port" in line and "astern_quadratic" in line for line in next_runs(found))


@pytest.mark.slow
def test_an_offset_of_the_compass_is_fitted_and_moves_no_other_number(tmp_path: Path) -> None:
    truth = hidden(tmp_path, HIDDEN + "  - {effect: heading_bias, bias: -0.0873}\n")
    sailed_dataset(tmp_path / "runs", tmp_path / "twin.yaml", truth, low=0.0)
    found = identify_boat(tmp_path / "runs", tmp_path / "twin.yaml", tmp_path / "new.yaml")
    numbers = by_name(list(found.fitted))
    expected = {
        "effects.heading_bias.bias": -0.0873,
        "effects.clock_offset.offset": 0.0,
        "effects.linear_drag.coefficient": 0.0,
        "resistance.x_0_ahead": -0.09,
        "hull.n_r": -0.11,
    }
    for name, value in expected.items():
        assert abs(numbers[name].value - value) < 4.0 * numbers[name].standard_error, name
    (line,) = [line for line in summary(found) if line.startswith("The compass")]
    assert "reads 5.0" in line or "reads 4.9" in line
    assert "too far counterclockwise" in line and "heading=HEADING - radians(-" in line


def test_an_offset_of_the_compass_that_only_short_windows_show_leaves_the_fit_as_without_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=2, seconds=40.0)
    begun = Wiring(runs.boat, (), 0.0, free_boat(runs.boat, without_compass(free_numbers(runs.boat))).start())
    wired, short, weather = identify.short_fitted(runs, begun, compass=False)
    alone = identify.fitted_boat(runs, wired, short, weather)
    shown = identify.short_fitted

    def as_if_seen(*given: Any, **asked: Any) -> tuple[Wiring, list[Fitted], list[str]]:
        wiring, found, weather = shown(*given, **asked)
        seen = [Fitted(one.number, 0.05, 0.01) if one.number.field == COMPASS else one for one in found]
        return wiring, seen, weather

    monkeypatch.setattr(identify, "short_fitted", as_if_seen)
    _, made = identify.with_compass_if_seen(runs, begun, positions=False)
    assert made.hypothesis.numbers == alone.hypothesis.numbers
    np.testing.assert_array_equal(made.fit.x, alone.fit.x)


def test_thrusters_that_the_start_file_has_on_the_other_side_are_named_with_its_places(
    tmp_path: Path,
) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=2)
    places = "thrusters: {port: {y: 0.15}, starboard: {y: -0.15}}\n"
    (tmp_path / "mirrored.yaml").write_text("extends: twin.yaml\nname: mirrored\n" + places)
    (change,) = identify.searched(replace(runs, boat=load_boat(tmp_path / "mirrored.yaml"))).changes
    assert change.startswith("port and starboard obey each other's commands, or each is at the other's place")
    assert identify.searched(runs).changes == ()


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_exchanged_and_flipped_channels_are_found_and_the_file_predicts_and_diagnoses(
    call: Call, tmp_path: Path
) -> None:
    truth = hidden(tmp_path, WIRED)
    sailed_dataset(tmp_path / "runs", tmp_path / "twin.yaml", truth, count=4)
    code, message, _ = call("identify", "boat", "runs", "--out", "new.yaml")  # from the dataset's boat
    assert code == 0
    assert "port and starboard obey each other's commands" in message
    assert "the throttle of port has the other sign" in message
    assert Path("new.html").read_text().count("<table>") == 3
    assert call("diagnose", "runs", "--boat", "new.yaml", "--out", "diagnosis")[0] == 0
    assert "nothing_wrong" in Path("diagnosis/diagnosis.json").read_text()


def test_a_fit_ends_no_farther_from_the_runs_than_the_start_file_wherever_it_begins(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, "extends: twin.yaml\nname: hidden\n", count=1, seconds=30.0)
    hypothesis, weight = free_boat(runs.boat, free_numbers(runs.boat)), weights(runs, noise_levels(runs))
    start, sd = hypothesis.prior()[0], hypothesis.prior()[1] ** -0.5
    low, high = hypothesis.bounds()
    far = np.clip(start + 2.0 * sd, low, high)
    _, lost, _ = fit_windows(runs, weight, 5.0, hypothesis, (far,), 1)
    problem, own, _ = fit_windows(runs, weight, 5.0, hypothesis, (start,), 1)
    x, states, _ = likeliest(problem, hypothesis, (far, start))
    kept = fit(problem, hypothesis, x, states, 1, fresh=True)
    assert kept.chi2 == pytest.approx(own.chi2)
    assert own.chi2 < lost.chi2


def test_a_window_in_which_the_boat_diverges_does_not_end_the_fit(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=1, seconds=60.0)
    hypothesis = free_boat(runs.boat, free_numbers(runs.boat))
    weight = weights(runs, noise_levels(runs))
    x = hypothesis.start()
    problem, begun, _ = fit_windows(runs, weight, 5.0, hypothesis, (x,), 1)
    states, others = begun.states.copy(), np.arange(len(begun.states)) != 2
    states[2, 5] = 1e8  # rad/s

    _, made, kept = sound_fit(problem, hypothesis, x, states, 3)
    half = problem.part(others).integrated_in(2 * problem.substeps)
    _, without, _ = sound_fit(half, hypothesis, x, states[others], 3)

    assert kept.tolist() == others.tolist()
    assert np.isfinite(made.covariance).all()
    assert (made.x != x).any() and made.chi2 == pytest.approx(without.chi2)


def test_where_a_boat_damps_too_fast_for_the_simulators_step_the_fit_takes_half_of_it(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=1, seconds=60.0)
    numbers = free_numbers(runs.boat)
    hypothesis = free_boat(runs.boat, numbers)
    weight, x = weights(runs, noise_levels(runs)), hypothesis.start()
    problem, begun, _ = fit_windows(runs, weight, 5.0, hypothesis, (x,), 1)
    record = parameters(runs.boat)[0]
    inertia = float(record["inertia_z"] - record["added_inertia_yaw"])
    damping = next(one for one in numbers if one.name == "effects.linear_yaw_damping.coefficient")
    fast = 4.0 * inertia * problem.substeps / problem.dt  # Runge and Kutta are unstable from 2.8 on
    x[numbers.index(damping)] = fast

    steps = problem.boat_steps
    before = steps[0]
    half, made, kept = sound_fit(problem, hypothesis, x, begun.states, 3)
    spent = steps[0] - before

    assert kept.all() and half.substeps == 2 * problem.substeps
    assert np.isfinite(made.covariance).all()

    sound_fit(problem.integrated_in(half.substeps), hypothesis, x, begun.states, 3)
    alone = steps[0] - before - spent
    assert spent < 1.3 * alone  # the fit that diverges ends at its first Jacobian


def test_a_fit_to_windows_goes_on_where_the_boats_a_difference_away_diverge(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=1, seconds=30.0)
    numbers = free_numbers(runs.boat)
    hypothesis, weight = free_boat(runs.boat, numbers), weights(runs, noise_levels(runs))
    record, x = parameters(runs.boat)[0], hypothesis.start()
    inertia = float(record["inertia_z"] - record["added_inertia_yaw"])
    damping = next(one for one in numbers if one.name == "effects.linear_yaw_damping.coefficient")
    x[numbers.index(damping)] = 2.4 * inertia / 0.05  # Runge and Kutta are unstable from 2.8 on
    soft = soft_weights(weight, runs.boat)

    _, made, chi2 = fit_windows(runs, soft, 5.0, hypothesis, (x,), 4)

    _, _, others = fit_windows(runs, soft, 5.0, hypothesis, (hypothesis.start(),), 4)
    assert chi2 < 2.0 * others
    assert (made.x != x).any()


def test_a_window_in_which_the_boat_diverges_counts_with_a_motion_that_stays_where_it_begins(
    tmp_path: Path,
) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=1, seconds=30.0)
    hypothesis, weight = free_boat(runs.boat, free_numbers(runs.boat)), weights(runs, noise_levels(runs))
    measured = runs.measured.copy()
    measured[0, 60:100, 5] = 1e8  # rad/s
    far = replace(runs, measured=measured)

    _, made, chi2 = fit_windows(far, weight, 5.0, hypothesis, (hypothesis.start(),), 1)

    assert len(made.states) < len(Shooting(far, weight, 5.0).windows.run)
    assert np.isfinite(made.covariance).all()
    assert made.chi2 < chi2 < np.inf


def test_a_fit_whose_covariance_is_infinite_keeps_its_noise(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=1, seconds=30.0)
    hypothesis = free_boat(runs.boat, free_numbers(runs.boat))
    weight = weights(runs, noise_levels(runs))
    problem, made, _ = fit_windows(runs, weight, 5.0, hypothesis, (hypothesis.start(),), 1)
    known = lost_freedom(problem, made, 1.0)
    lost = replace(
        made, normal=replace(made.normal, information=np.full_like(made.normal.information, np.nan))
    )
    assert 1.0 <= lost_freedom(problem, lost, 1.0) < known


def test_runs_are_held_out_whole_and_a_single_one_by_pieces(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN)
    by_runs, by_pieces = split(runs), split(runs.subset([0]))
    assert by_runs.by == "runs" and [name.split(",")[0] for name in by_runs.held_out.names] == ["run2"]
    assert by_pieces.by == "pieces"
    assert [len(part.lengths) for part in (by_pieces.training, by_pieces.held_out)] == [2, 1]
    total = by_pieces.training.lengths.sum() + by_pieces.held_out.lengths.sum()
    assert total == runs.lengths[0]
    assert np.isfinite(by_runs.training.commands).all()


@pytest.mark.parametrize("seconds", [30.0, 130.0, 250.0, 300.0, 350.0, 420.0, 900.0])
def test_of_one_run_of_any_length_about_a_third_is_held_out(tmp_path: Path, seconds: float) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=1)
    rows = round(seconds / runs.dt)
    longer = replace(
        runs,
        commands=np.pad(runs.commands, ((0, 0), (0, rows), (0, 0)), mode="edge"),
        measured=np.pad(runs.measured, ((0, 0), (0, rows), (0, 0)), mode="edge"),
        lengths=np.array([rows]),
    )
    data = split(longer)
    held = data.held_out.lengths.sum()
    assert 0.2 < held / (held + data.training.lengths.sum()) < 0.5


def test_runs_of_which_every_third_is_short_are_held_out_by_length(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=6, seconds=20.0)
    short = runs.lengths // 8
    data = split(replace(runs, lengths=np.where(np.arange(6) % 3 == 2, short, runs.lengths)))
    assert data.by == "lengths"
    held = data.held_out.lengths.sum()
    assert 0.2 < held / (held + data.training.lengths.sum()) < 0.5


def test_a_wind_that_is_left_out_and_the_axes_are_cut_with_their_run(tmp_path: Path) -> None:
    runs = start_runs(tmp_path, HIDDEN, count=1)
    wind = np.random.default_rng(0).uniform(0.0, 5.0, (*runs.commands.shape[:2], 3))
    data = split(replace(runs, ignored=wind, of_earth=(True,)))
    assert data.training.of_earth == (True, True) and data.held_out.of_earth == (True,)
    first, held, last = data.training.ignored[0], data.held_out.ignored[0], data.training.ignored[1]
    ends = [first[: data.training.lengths[0]], last[: data.training.lengths[1]]]
    whole = np.concatenate([ends[0], ends[1], held[: data.held_out.lengths[0]]])
    np.testing.assert_array_equal(whole, wind[0, : runs.lengths[0]])


def test_bad_input_is_refused_with_one_line_and_nothing_written(call: Call, tmp_path: Path) -> None:
    sailed_dataset(tmp_path / "runs", tmp_path / "twin.yaml", hidden(tmp_path, HIDDEN), count=1, seconds=12.0)
    before = sorted(path.name for path in tmp_path.iterdir())
    asked = ("identify", "boat", "runs", "--boat", "twin.yaml")
    for more, result in (
        (("--out", "twin.yaml"), "already exists"),
        (("--out", "new.txt"), "--out must end in .yaml or .yml"),
        (("--out", "NEW.YAML"), "; a fit needs 20 s or more"),
        (("--out", "new.yaml"), "; a fit needs 20 s or more"),
        (("--out", "new.yaml", "--holdout", "runs"), "nothing would be held out"),
    ):
        code, _, error = call(*asked, *more)
        assert code == 2 and result in error and error.strip().count("\n") == 0, error
    assert sorted(path.name for path in tmp_path.iterdir()) == before
    with pytest.raises(UserError, match="no such file"):
        identify_boat("runs", "none.yaml", "new.yaml")


def test_fitted_numbers_whose_boat_diverges_are_named_with_what_the_commands_reach(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth = hidden(tmp_path, HIDDEN)
    sailed_dataset(tmp_path / "runs", tmp_path / "twin.yaml", truth, low=0.0, high=0.5)
    unstable = {"hull.n_r": 60.0, "hull.n_v": 40.0}  # standard deviations from the start file
    numbers = without_compass(free_numbers(load_boat(tmp_path / "twin.yaml")))
    far = [Fitted(one, one.mean + unstable.get(one.name, 0.0) * one.sd, one.sd) for one in numbers]
    wired = Wiring(load_boat(tmp_path / "twin.yaml"), (), 0.0, np.zeros(len(numbers)))

    monkeypatch.setattr(identify, "searched", lambda *given: wired)
    monkeypatch.setattr(identify, "short_fitted", lambda *given: (wired, far, []))
    monkeypatch.setattr(identify, "fitted_boat", lambda *given: None)
    monkeypatch.setattr(identify, "numbers_of", lambda made: far)
    with pytest.raises(UserError) as refused:
        identify_boat(tmp_path / "runs", tmp_path / "twin.yaml", tmp_path / "new.yaml")

    (line,) = str(refused.value).splitlines()
    assert line.startswith(f"{tmp_path / 'runs'}: the fitted numbers are of no boat: simulated from")
    assert "its motion diverges" in line and "farthest from the start file: hull.n_r" in line
    assert "the runs reach of the limits of commands: throttle_port 0.4" in line
    assert not list(tmp_path.glob("new*"))


def test_fitted_numbers_that_no_boat_file_holds_are_named_with_what_to_do(tmp_path: Path) -> None:
    boat = load_boat(written(tmp_path, "twin"))
    far = [Fitted(one, one.mean + 9.0 * one.sd * (one.name == "x_g"), one.sd) for one in free_numbers(boat)]
    line = implausible_fit(Path("runs"), "x_g: is implausible", far)
    assert line.startswith("runs: the fitted numbers are of no boat: x_g: is implausible; farthest from")
    assert "start file: x_g 0 to " in line and "smaller `sd`" in line
