"""`swamp-rl fleet`: how it ends where no dataset could be diagnosed."""

from pathlib import Path

from tests.support.command_line import Call


def test_a_fleet_of_which_none_is_diagnosed_ends_with_1_and_keeps_its_report(call: Call) -> None:
    code, said, _ = call("fleet", "nowhere", "--out", "out", "--workers", "1")
    assert code == 1
    assert "0 of 0 causes kept, 1 of 1 datasets not diagnosed" in said
    assert Path("out/fleet.json").is_file()
