"""`swamp-rl diagnose --next`: the designed trial is written, and wrong limits are refused in one line."""

from pathlib import Path

import pytest

from tests.support.command_line import Call, assert_complains


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--next", "1x1"], "4.96 m each way"),
        (["--next", "40x40ft"], "without a unit"),
        (["--seconds", "30"], "limits of --next"),
        (["--next", "40x40", "--seconds", "5"], "--seconds 5"),
        (["--next", "40x40", "--throttle", "2"], "--throttle 2"),
    ],
)
def test_wrong_limits_are_one_line_before_anything_is_read(
    call: Call, words: list[str], message: str
) -> None:
    assert_complains(call("diagnose", "nowhere", "--boat", "swamp", "--out", "a", *words), message)
    assert not Path("a").exists()
