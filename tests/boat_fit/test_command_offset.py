"""The offset of the clocks of commands and receiver, of either sign, under any wiring."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit.command_offset import command_offset
from swamp_rl.boat_fit.wiring import search_wiring
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet, read_run_set
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


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [-1.5, 1.5])
def test_wiring_and_offset_are_found_together(tmp_path: Path, seconds: float) -> None:
    runs = stamped_late(wired_runs(tmp_path, 30.0), seconds)
    found = search_wiring(runs, weights(runs, noise_levels(runs)))
    assert len(found.changes) == 2
    if seconds > 0.0:
        assert found.advance == pytest.approx(seconds, abs=0.2)
    else:
        assert found.advance == 0.0
