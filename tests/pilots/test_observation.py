"""An observation that a pilot cannot act on is one clear line, whatever the kind of the pilot."""

from collections.abc import Callable

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots import Pilot
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.gru import GRUSettings, fit_gru
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.reservoir import fit_reservoir
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.takeover import TakeoverPilot
from tests.support.steering_runs import RUNS, SMALL

SENSES = ("north", "east", "cos_heading", "sin_heading")
PILOTS: dict[str, Callable[[], Pilot]] = {
    "line-of-sight": LineOfSightPilot,
    "scripted": lambda: ScriptedPilot(0),
    "reservoir": lambda: fit_reservoir(RUNS, SMALL),
    "cloning": lambda: fit_cloning(RUNS, CloningSettings(senses=SENSES, epochs=1)),
    "gru": lambda: fit_gru(RUNS, GRUSettings(senses=SENSES, epochs=1)),
    "takeover": lambda: TakeoverPilot(ScriptedPilot(0), fit_reservoir(RUNS, SMALL), 1.0),
}


@pytest.mark.parametrize("kind", PILOTS)
def test_a_wrong_shape_and_values_that_are_no_numbers_are_refused(kind: str) -> None:
    pilot = PILOTS[kind]()
    d = len(pilot.senses)
    pilot.reset(2)
    for wrong in (np.zeros(d), np.zeros((2, d + 1)), np.zeros((2, d, 1))):
        with pytest.raises(UserError, match=rf"the observation is .*\(n, {d}\) is needed"):
            pilot.act(wrong)
    with pytest.raises(UserError, match="not an array of numbers"):
        pilot.act([["ahead"] * d] * 2)  # type: ignore[arg-type]
    lost = np.zeros((2, d))
    lost[1, 0] = np.nan
    with pytest.raises(UserError, match=f"boat 1: {pilot.senses[0]} is not a finite number"):
        pilot.act(lost)
    assert np.isfinite(pilot.act(np.zeros((2, d)))).all()


@pytest.mark.parametrize("kind", ["scripted", "reservoir", "gru", "takeover"])
def test_a_pilot_with_states_asks_for_a_reset_for_the_number_of_boats(kind: str) -> None:
    pilot = PILOTS[kind]()
    with pytest.raises(UserError, match=r"of 3 boats, the pilot was reset for none; call reset\(3\) first"):
        pilot.act(np.zeros((3, len(pilot.senses))))


@pytest.mark.parametrize("kind", PILOTS)
def test_a_number_of_boats_that_cannot_be_is_refused_and_the_pilot_goes_on(kind: str) -> None:
    pilot = PILOTS[kind]()
    pilot.reset(2)
    for n in (-1, 1.5, "two", None, True):
        with pytest.raises(UserError, match="reset: n must be a whole number of at least 0, not "):
            pilot.reset(n)  # type: ignore[arg-type]
    assert pilot.act(np.zeros((2, len(pilot.senses)))).shape == (2, 2)
