"""The offset of the clocks of commands and receiver, of either sign, under any wiring."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit import wiring
from swamp_rl.boat_fit.command_offset import command_offset
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.boat_fit.wiring import Wiring, less_advanced, search_wiring
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.criticism.data.measurement_noise import noise_levels
from swamp_rl.criticism.data.run_set import RunSet, read_run_set
from swamp_rl.simulator import parameters
from tests.support.from_scratch import written
from tests.support.sailing import sailed_dataset


def stamped_late(runs: RunSet, seconds: float) -> RunSet:
    """The runs with their commands stamped so much later than they were, first and last ones held."""
    rows = np.arange(runs.commands.shape[1]) - round(seconds / runs.dt)
    return replace(runs, commands=runs.commands[:, np.clip(rows, 0, runs.commands.shape[1] - 1)])


def wired_runs(folder: Path, seconds: float) -> RunSet:
    """Runs whose port and starboard commands are exchanged and whose port command has the other sign."""
    written(folder, "twin")
    (folder / "truth.yaml").write_text(
        "extends: twin.yaml\neffects:\n  - {effect: channel_swap, thruster: [port, starboard]}\n"
        "  - {effect: throttle_reversed, thruster: port}\n"
    )
    sailed_dataset(folder / "runs", folder / "twin.yaml", load_boat(folder / "truth.yaml"), seconds=seconds)
    return read_run_set(folder / "runs", load_boat(folder / "twin.yaml"))


@pytest.fixture(scope="module")
def wired(tmp_path_factory: pytest.TempPathFactory) -> RunSet:
    return wired_runs(tmp_path_factory.mktemp("wired"), 60.0)


@pytest.mark.parametrize("seconds", [-1.5, -0.7, 0.7, 1.5])
def test_the_offset_is_found_whatever_the_wiring(wired: RunSet, seconds: float) -> None:
    own = command_offset(wired)
    assert abs(own) <= 0.5  # of the actuators' lags
    assert command_offset(stamped_late(wired, seconds)) - own == pytest.approx(-seconds, abs=0.31)


def test_runs_of_one_command_have_no_offset(wired: RunSet) -> None:
    assert command_offset(replace(wired, commands=np.full_like(wired.commands, 0.3))) == 0.0


def test_a_thrust_that_is_linear_in_the_level_is_no_offset(tmp_path: Path) -> None:
    """A boat of first order in surge and yaw under a slow speed profile and slow turns, without noise."""
    boat, dt, rows = load_boat(written(tmp_path, "twin")), 0.1, 800
    phase = np.pi * dt * np.arange(rows) / 20.0
    level, apart = 0.6 * np.abs(np.sin(phase)), 0.15 * np.sin(2.0 * phase)
    motion = np.zeros((rows, 6))
    for row in range(rows - 1):
        heading, (speed, _, rate) = motion[row, 2], motion[row, 3:]
        change = [speed * np.cos(heading), speed * np.sin(heading), rate]
        motion[row + 1] = motion[row] + dt * np.array(
            [*change, 1.2 * level[row] - 0.8 * speed, 0.0, 2.0 * apart[row] - 0.6 * rate]
        )
    commands = np.column_stack([np.zeros((rows, 2)), level + apart, level - apart])[None]
    runs = RunSet(boat, dt, ("run",), commands, motion[None], np.array([rows]))
    assert abs(command_offset(runs)) <= 0.2


def test_a_row_lost_at_the_beginning_or_the_end_of_a_run_does_not_move_the_offset(wired: RunSet) -> None:
    measured = wired.measured.copy()
    measured[:, 1] = np.nan
    measured[np.arange(len(measured)), wired.lengths - 2] = np.nan
    assert command_offset(replace(wired, measured=measured)) == pytest.approx(command_offset(wired), abs=0.11)


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [-1.5, 1.5])
def test_wiring_and_offset_are_found_together(tmp_path: Path, seconds: float) -> None:
    runs = stamped_late(wired_runs(tmp_path, 12.0), seconds)
    found = search_wiring(runs, noise_levels(runs))
    assert len(found.changes) == 2
    if seconds > 0.0:
        assert found.advance == pytest.approx(seconds, abs=0.2)
    else:
        assert found.advance == 0.0


def test_the_search_for_the_wiring_fits_to_two_minutes_of_long_runs(
    wired: RunSet, monkeypatch: pytest.MonkeyPatch
) -> None:
    fitted = list[float]()

    def quick(run_set: RunSet, *given: object) -> tuple[None, SimpleNamespace, float]:
        fitted.append(float(run_set.lengths.sum()) * run_set.dt)
        return None, SimpleNamespace(x=given[3][0]), 1.0

    monkeypatch.setattr(wiring, "fit_windows", quick)
    long = replace(
        wired.subset([0]),
        commands=np.tile(wired.commands[:1], (1, 20, 1)),
        measured=np.tile(wired.measured[:1], (1, 20, 1)),
        lengths=20 * wired.lengths[:1],
    )
    search_wiring(long, noise_levels(wired))
    assert max(fitted) == pytest.approx(120.0, rel=0.2)


def test_an_exchange_of_equal_commands_takes_no_place_among_the_wirings_that_are_fitted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    boat = load_boat(written(tmp_path, "ferry"))
    rows = 300
    angles, levels = np.sin(0.05 * np.arange(rows)), np.full(rows, 0.5)
    commands = np.stack([angles, angles, levels, levels], axis=1)[None]
    measured = np.random.default_rng(0).standard_normal((1, rows, 6))
    runs = RunSet(boat, 0.1, ("run",), commands, measured, np.array([rows]))
    glance = {(1, 1): 9000.0, (-1, 1): 8000.0, (1, -1): 1250.0, (-1, -1): 953.0}
    whole = glance | {(1, -1): 300.0, (-1, -1): 716.0}

    def quick(run_set: RunSet, *given: Any) -> tuple[None, SimpleNamespace, float]:
        bow, stern = np.sign(parameters(run_set.boat)["azimuth_sign"][0]).astype(int)
        chi2 = (glance if given[4] == 1 else whole)[bow, stern]
        return None, SimpleNamespace(x=given[3][0]), chi2

    monkeypatch.setattr(wiring, "fit_windows", quick)
    found = search_wiring(runs, noise_levels(runs))
    assert found.changes == ("the azimuth of stern has the other sign",)


def test_commands_are_taken_no_earlier_than_a_fit_needs(wired: RunSet) -> None:
    numbers = free_numbers(wired.boat)
    delay = [number.name for number in numbers].index("effects.command_delay.delay")
    x = free_boat(wired.boat, numbers).start()
    x[delay] = 0.27
    found = less_advanced(Wiring(wired.boat, (), 0.61, x), numbers, 0.1)
    assert (found.advance, found.x[delay]) == pytest.approx((0.41, 0.07))
    x[delay] = 0.09  # less than a row
    assert less_advanced(Wiring(wired.boat, (), 0.61, x), numbers, 0.1).advance == 0.61
    x[delay] = 0.35  # a delay that the log has beside no advance stays
    assert less_advanced(Wiring(wired.boat, (), 0.0, x), numbers, 0.1).x[delay] == 0.35
