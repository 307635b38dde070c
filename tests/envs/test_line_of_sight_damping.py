"""The line-of-sight pilot's damping follows the boat, so that it passes the gates with boats of any kind."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.line_of_sight_damping import suited

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import KINDS, Kind
from swamp_rl.evaluation import drive
from swamp_rl.pilots.line_of_sight import DAMPING, LineOfSightPilot, LineOfSightSettings
from tests.support.from_scratch import BOATS, written
from tests.support.new_boats import SIZES, new_boat

STEP = 0.1


def outcomes(boat: Boat) -> set[str]:
    """How three episodes of the pilot in calm water end."""

    def make(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
        return GatesVectorEnv(n, boat=boat, observation=senses, step=STEP)

    return set(drive(suited(LineOfSightPilot(), boat, STEP), make, 3_000_000 + np.arange(3)).outcome)


@pytest.mark.parametrize(
    ("kind", "length"),
    [
        pytest.param(kind, length, marks=[] if (kind, length) == ("azimuth", 1.2) else pytest.mark.slow)
        for kind in KINDS
        for length in SIZES
    ],
)
def test_it_passes_the_gates_with_boats_of_every_kind_and_size(
    tmp_path: Path, kind: Kind, length: float
) -> None:
    assert outcomes(new_boat(tmp_path, kind, length)) == {"success"}


@pytest.mark.slow
@pytest.mark.parametrize("name", BOATS)
def test_it_passes_the_gates_with_boats_written_from_nothing(tmp_path: Path, name: str) -> None:
    assert outcomes(load_boat(written(tmp_path, name))) == {"success"}


def test_the_damping_of_swamp_is_the_tuned_one() -> None:
    assert suited(LineOfSightPilot(), load_boat("swamp"), STEP).settings()["damping"] == DAMPING


def test_a_damping_that_is_given_stays() -> None:
    given = LineOfSightPilot(LineOfSightSettings(damping=0.7))
    assert suited(given, load_boat("swamp"), STEP) is given
