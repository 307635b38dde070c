"""`swamp-rl boat new` and `boat check`, as a newcomer calls them in an empty folder."""

import json
import shlex
from pathlib import Path

import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat.estimate import KINDS
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture

SIZES = ["--length", 1.2, "--breadth", 0.5, "--mass", 30, "--thrust", 40]


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_boat_is_written_under_its_name_and_checked(call: Call, kind: str) -> None:
    code, message, _ = call("boat", "new", "skiff", "--kind", kind, *SIZES)
    assert (code, [path.name for path in Path().iterdir()]) == (0, ["skiff.yaml"])
    assert "skiff.yaml" in message and load_boat("skiff.yaml").name == "skiff"
    code, message, _ = call("boat", "check", "skiff.yaml")
    assert code == 0
    for part in (
        "assumed",
        "top speed",
        "throttle 1.0",
        "turning circle at +",
        "turning circle at -",
        "stopping",
    ):
        assert part in message


def test_the_command_that_checks_a_new_boat_can_be_pasted(call: Call) -> None:
    _, message, _ = call("boat", "new", "skiff", "--kind", "outboard", *SIZES, "--out", "my skiff.yaml")
    words = shlex.split(message.splitlines()[0].partition("check it with: ")[2])
    assert words == ["swamp-rl", "boat", "check", "my skiff.yaml"]


def test_the_check_writes_a_report_with_its_figures(call: Call) -> None:
    assert call("boat", "check", "swamp", "--out", "checked")[0] == 0
    report = Path("checked/check.md").read_text(encoding="utf-8")
    for picture in ("straight.png", "circles.png", "stopping.png"):
        assert Path("checked", picture).stat().st_size > 1000
        assert picture in report
    assert "| mass | 58 |" in " ".join(report.split())
    assert "measured" in report
    assert call("boat", "check", "swamp", "--out", "checked")[0] == 0  # an earlier report is replaced
    Path("other").mkdir()
    Path("other/mine.txt").write_text("mine")
    assert_complains(call("boat", "check", "swamp", "--out", "other"), "not an earlier result")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["skiff", "--kind", "sail", *SIZES], "--kind sail"),
        (["../skiff", "--kind", "azimuth", *SIZES], "a boat's name has letters"),
        (["jölle", "--kind", "azimuth", *SIZES], "a boat's name has letters from A to Z or a to z"),
        (
            ["skiff", "--kind", "azimuth", *SIZES, "--out", "skiff.txt"],
            "end the name in .yaml or .yml",
        ),
        (["skiff", "--kind", "azimuth", *SIZES[:-1], -4], "--thrust -4"),
        (["skiff", "--kind", "azimuth", *SIZES, "--top-speed", 0], "--top-speed 0"),
        (["skiff", "--kind", "azimuth", *SIZES, "--top-speed", 60], "--top-speed 60: is a Froude number of"),
        (["skiff", "--kind", "azimuth", *SIZES[:-1], 1e9], "thrust / weight is"),
        (["skiff", "--kind", "azimuth", *SIZES, "--draught", 5], "draught"),
        (
            ["skiff", "--kind", "azimuth", *SIZES, "--draught", 1e-9],
            "--draught 1e-09: must be a number above 0",
        ),
        (["skiff", "--kind", "propeller-rudder", *SIZES, "--draught", 0.02], "mass / (water_density length"),
        (["skiff", "--kind", "azimuth"], "--length"),
    ],
)
def test_what_cannot_be_a_boat_is_one_line_and_leaves_nothing(
    call: Call, words: list[object], message: str
) -> None:
    assert_complains(call("boat", "new", *words), message)
    assert list(Path().iterdir()) == []


def test_an_existing_file_is_not_replaced(call: Call) -> None:
    Path("skiff.yaml").write_text("mine")
    assert_complains(call("boat", "new", "skiff", "--kind", "azimuth", *SIZES), "skiff.yaml: already exists")
    assert Path("skiff.yaml").read_text() == "mine"


def test_every_fault_of_a_file_is_reported_at_once(call: Call) -> None:
    Path("odd.yaml").write_text("extends: swamp\nmass: heavy\nhull: {c_d: -1.0}\ncolour: red\n")
    code, _, error = call("boat", "check", "odd.yaml")
    assert code == 2
    assert [part in error for part in ("mass", "hull.c_d", "colour")] == [True] * 3
    assert len(error.splitlines()) == 3


def test_the_thrust_of_a_large_boat_has_no_exponent(call: Call) -> None:
    sizes = ("--length", 15, "--breadth", 5, "--mass", 40000, "--thrust", 60000)
    call("boat", "new", "tug", "--kind", "azimuth", *sizes)
    assert "thrust at rest: 60000 N, 0.153 of the weight" in call("boat", "check", "tug.yaml")[1]


def test_the_check_of_an_unstable_boat_names_the_yaw_damping_that_makes_it_stable(call: Call) -> None:
    call("boat", "new", "skiff", "--kind", "outboard", *SIZES)
    message = call("boat", "check", "skiff.yaml")[1]
    assert "straight-line stability at full ahead: unstable" in message
    limit = float(message.partition("below hull.n_r ")[2].split()[0])
    Path("finned.yaml").write_text(f"extends: ./skiff.yaml\nname: finned\nhull: {{n_r: {1.1 * limit}}}\n")
    assert "at full ahead: stable" in call("boat", "check", "finned.yaml")[1]


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize(
    ("kind", "length", "breadth", "mass", "thrust"),
    [("azimuth", 5, 2, 900, 800), ("propeller-rudder", 20, 5, 60_000, 12_000)],
)
def test_nothing_is_wrong_with_a_large_boat_about_its_own_runs(
    call: Call, kind: str, length: float, breadth: float, mass: float, thrust: float
) -> None:
    sizes = f"--length {length} --breadth {breadth} --mass {mass} --thrust {thrust}"
    call("boat", "new", "own", "--kind", kind, *sizes.split())
    record = "record-scripted --boat own.yaml --disturbances calm --out runs --count 3"
    call(*record.split(" "))
    call("diagnose", "runs", "--boat", "own.yaml", "--out", "diagnosis")
    assert json.loads(Path("diagnosis/diagnosis.json").read_text())["verdict"] == "nothing_wrong"


def test_sizes_that_no_boat_has_are_reported_once_with_the_options_to_check(call: Call) -> None:
    sizes = ["--length", 3, "--breadth", 1.2, "--mass", 350000, "--thrust", 1100]
    result = call("boat", "new", "skiff", "--kind", "waterjet", *sizes)
    assert_complains(result, "draught / length is 63.2; that of boats is within [0.005, 0.6]; check --length")
    assert result[2].count("check") == 1
