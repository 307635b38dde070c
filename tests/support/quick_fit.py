"""`identify boat` in seconds: two numbers, of commands as they are logged."""

from pathlib import Path

import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit import identify
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.boat_fit.wiring import Wiring
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.criticism.data.run_set import RunSet


def fit_thrust_alone(monkeypatch: pytest.MonkeyPatch, start: Path) -> None:
    """Let `identify boat` fit the thrust of the start file alone, without a search of the wiring."""

    def few(boat: object, positions: bool) -> tuple[object, ...]:
        every = free_numbers(load_boat(start), positions)
        return tuple(one for one in every if "thrust_quadratic" in one.name)

    def as_logged(run_set: RunSet, noise: object, positions: bool) -> Wiring:
        x = free_boat(run_set.boat, identify.free_numbers(run_set.boat, positions)).start()
        return Wiring(run_set.boat, (), 0.0, x)

    monkeypatch.setattr(identify, "free_numbers", few)
    monkeypatch.setattr(identify, "search_wiring", as_logged)
