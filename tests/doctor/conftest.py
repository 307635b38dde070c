"""A twin and sound runs of it."""

import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.runs import Run
from tests.support.doctored import driven
from tests.support.from_scratch import written


@pytest.fixture(scope="package")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Boat:
    """A boat of two fixed thrusters."""
    return load_boat(written(tmp_path_factory.mktemp("boat"), "twin"))


@pytest.fixture(scope="package")
def sound(twin: Boat) -> list[Run]:
    """Its runs as `driven` has them."""
    return driven(twin, 0.25)
