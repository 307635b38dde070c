"""Wirings by equation error, which a start file with wrong numbers does not mislead."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat_fit import wiring
from swamp_rl.boat_fit.command_offset import command_offset
from swamp_rl.boat_fit.wiring import possible_changes, rewired, search_wiring
from swamp_rl.boat_fit.wiring_response import wiring_likelihoods
from swamp_rl.criticism.data.measurement_noise import noise_levels
from swamp_rl.criticism.data.run_set import RunSet, read_run_set
from swamp_rl.effects import LIBRARY, EffectEntry
from swamp_rl.simulator import parameters
from tests.support.from_scratch import written
from tests.support.sailing import sailed_dataset

WIRED = (
    EffectEntry(LIBRARY["channel_swap"], ("port", "starboard"), {}),
    EffectEntry(LIBRARY["throttle_reversed"], "port", {}),
)


def runs_of(folder: Path, effects: tuple[EffectEntry, ...] = ()) -> RunSet:
    """Runs of the twin with these effects, read with the twin's own file."""
    start = written(folder, "twin")
    boat = load_boat(start)
    sailed_dataset(folder / "runs", start, boat.model_copy(update={"effects": effects}))
    return read_run_set(folder / "runs", boat)


def wirings(boat: Boat) -> list[tuple[str, Boat]]:
    """The boat as it is and with each possible change, in words."""
    changes = possible_changes(boat)
    return [("none", boat), *((one[0], rewired(boat, [one])) for one in changes)]


def test_the_motion_speaks_for_the_commands_as_they_were_logged(tmp_path: Path) -> None:
    runs = runs_of(tmp_path)
    found = wiring_likelihoods(runs, [boat for _, boat in wirings(runs.boat)], command_offset(runs))
    assert found[0] > max(found[1:]) + wiring.LIKELIER


def test_the_motion_speaks_for_the_wiring_that_the_boat_had(tmp_path: Path) -> None:
    runs = runs_of(tmp_path, WIRED)
    truth = runs.boat.model_copy(update={"effects": (*runs.boat.effects, *WIRED)})
    others = [boat for _, boat in wirings(runs.boat)]
    true, *rest = wiring_likelihoods(runs, [truth, *others], command_offset(runs))
    assert true > max(rest) + wiring.LIKELIER


def test_a_wiring_that_the_motion_contradicts_is_not_taken_though_quick_fits_prefer_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = runs_of(tmp_path)

    def astray(run_set: RunSet, *given: list[np.ndarray]) -> tuple[None, SimpleNamespace, float]:
        reversed_port = parameters(run_set.boat)["throttle_sign"][0, 0] < 0.0
        return None, SimpleNamespace(x=given[3][0]), 1.0 if reversed_port else 1000.0

    monkeypatch.setattr(wiring, "fit_windows", astray)
    assert search_wiring(runs, noise_levels(runs)).changes == ()
