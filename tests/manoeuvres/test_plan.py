"""Plan files are read strictly, and the one of paper 002 holds its tables."""

import math
from collections import Counter
from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.plan import load_plan

GOOD = """
name: mine
boat: swamp
trials:
  - {manoeuvre: zig-zag, angle_deg: [10.0, 20.0], heading_deg: [1.0, 20.0], throttle: [0.5, 0.6]}
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "plan.yaml"
    path.write_text(text)
    return path


def test_the_plan_of_the_paper_holds_52_trials_at_its_angles_and_speeds() -> None:
    trials = load_plan("ittc_swamp").singly
    assert Counter(trial.kind for trial in trials) == {"turning-circle": 12, "zig-zag": 40}
    circles = {
        (round(math.degrees(t.angle)), round(t.throttle, 3)) for t in trials if t.kind == "turning-circle"
    }
    assert circles == {(s * a, 0.6) for s in (1, -1) for a in (20, 30, 40, 50, 60)} | {
        (20, 0.45),
        (-20, 0.45),
    }
    zig_zags = [t for t in trials if t.kind == "zig-zag"]
    assert {round(t.throttle, 3) for t in zig_zags} == {0.3, 0.375, 0.45, 0.525, 0.6}
    assert {round(math.degrees(t.angle)) for t in zig_zags} == {10, 15, 20, 25, 30, 40, 50, 60}
    assert all(t.heading == t.angle and t.executes == 6 for t in zig_zags)


def test_an_entry_stands_for_every_pair_of_its_angles_and_throttles(tmp_path: Path) -> None:
    trials = load_plan(written(tmp_path, GOOD)).singly
    found = [(round(math.degrees(t.angle)), round(math.degrees(t.heading)), t.throttle) for t in trials]
    assert found == [(10, 1, 0.5), (10, 1, 0.6), (20, 20, 0.5), (20, 20, 0.6)]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("manoeuvre: zig-zag", "manoeuvre: waltz", "manoeuvre"),
        ("heading_deg", "headings", "did you mean 'heading_deg'"),
        ("heading_deg: [1.0, 20.0]", "turns: 2", "turns: zig-zag has no such key"),
        ("heading_deg: [1.0, 20.0]", "heading_deg: [1.0]", "one for each of angle_deg"),
        ("angle_deg: [10.0, 20.0]", "angle_deg: [0.0, 20.0]", "0 steers nowhere"),
        ("angle_deg: [10.0, 20.0], ", "", "angle_deg is missing"),
        ("angle_deg: [10.0, 20.0]", "angle_deg: [10.0, 200.0]", "90"),
        ("throttle: [0.5, 0.6]", "throttle: [0.5, 60.0]", "must be at most 1"),
        ("throttle: [0.5, 0.6]", "throttle: [0.5, 1.0e-320]", "throttle.1: must be at least 0.01"),
        ("throttle: [0.5, 0.6]", "rpm: [800.0]", "needs full_rpm"),
        (", throttle: [0.5, 0.6]", "", "either it or rpm"),
        ("throttle: [0.5, 0.6]", "throttle: []", "is empty"),
        ("name: mine", "name: mine\nspeed: 2", "unknown key"),
        ("boat: swamp", "", "boat: is missing"),
    ],
)
def test_what_a_plan_cannot_hold_is_one_line_with_file_and_key(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    path = written(tmp_path, GOOD.replace(old, new))
    with pytest.raises(UserError) as refused:
        load_plan(path)
    assert str(refused.value).startswith(f"{path}: ")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
    assert "more)" not in str(refused.value)
