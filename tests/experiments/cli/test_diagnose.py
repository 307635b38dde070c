"""What `swamp-rl diagnose` prints of a diagnosis."""

from pathlib import Path

import pytest

from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture

pytestmark = pytest.mark.slow

GOLDEN = Path(__file__).parents[2] / "criticism" / "golden"


def test_the_value_of_the_boat_file_is_beside_the_one_that_replaces_it(call: Call) -> None:
    given = ("--boat", "swamp", "--self-trial", "0", "--out", "out")
    code, message, _ = call("diagnose", GOLDEN / "azimuth_lag", *given)
    assert code == 0
    (line,) = [line for line in message.splitlines() if "azimuth_lag: time constant" in line]
    assert line.endswith("; boat file 0.1)")
