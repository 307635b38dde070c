"""`swamp-rl vehicle` and `swamp-rl helm`, and what they say of wrong input."""

from pathlib import Path

import pytest

from swamp_rl.link import helm as driving
from swamp_rl.link.vehicle import Conduct
from swamp_rl.runs import read_dataset
from tests.support.command_line import Call, assert_complains
from tests.support.link import own_network, served, vehicle_of
from tests.support.patience import PATIENCE, until

pytestmark = pytest.mark.timed

VOYAGES = 10  # a machine too busy to hear enough telemetry in a row is given so many
BROKEN = "rows without a fault follow one another"


def test_a_pilot_drives_a_served_vehicle_and_its_log_is_a_dataset(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(driving, "PATIENCE", PATIENCE)  # the vehicle may wait long for a processor
    vehicle = vehicle_of(Conduct(), own_network().text)
    with served(vehicle, speed=1.0):
        for number in range(VOYAGES):
            code, message, refused = call(
                *("helm", "line-of-sight", "--link", vehicle.addresses.text),
                *("--seconds", "2", "--log", f"log-{number}"),
            )
            if BROKEN not in refused:
                break
        until(lambda: not any(module.runs(0) for module in vehicle.modules), "the vehicle's pumps are off")
    assert code == 0 and "99th percentile" in message
    assert len(read_dataset(tmp_path / f"log-{number}").runs[0].time) >= 10


@pytest.mark.parametrize(
    "north, line",
    [
        (0.0, "began 0 m from the start of the course\n"),
        (
            30.0,
            "began 30 m from the start of the course, beyond gate green and gate red\n",
        ),
    ],
)
def test_a_helm_says_where_the_boat_began(
    call: Call, monkeypatch: pytest.MonkeyPatch, north: float, line: str
) -> None:
    monkeypatch.setattr(driving, "PATIENCE", PATIENCE)
    vehicle = vehicle_of(Conduct(), own_network().text)
    vehicle.state[0, 0] = north
    with served(vehicle, speed=1.0):
        found = call("helm", "line-of-sight", "--link", vehicle.addresses.text, "--seconds", "1")
        until(lambda: not any(module.runs(0) for module in vehicle.modules), "the vehicle's pumps are off")
    assert f"0 of 2 gates passed; {line}" in found[1]


def test_a_vehicle_writes_a_log_that_is_imported(call: Call, tmp_path: Path) -> None:
    address = own_network().text
    code, message, _ = call("vehicle", "swamp", "--address", address, "--seconds", "1", "--log", "v.log")
    assert code == 0 and "ignored: none" in message
    assert call("runs", "import", "v.log", "--from", "telemetry", "--out", "runs")[0] == 0
    run = read_dataset(tmp_path / "runs").runs[0]
    assert {"azimuth_bs", "throttle_sp", "applied_throttle_bp"} <= set(run.columns)
    assert_complains(call("vehicle", "--address", address, "--log", "v.log"), "v.log: already exists")


@pytest.mark.parametrize("words", [("helm", "line-of-sight"), ("record", "--out", "runs", "--port", "0")])
def test_a_vehicle_that_does_not_answer_is_one_line(
    call: Call, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    monkeypatch.setattr(driving, "PATIENCE", 0.2)
    assert_complains(call(*words, "--link", own_network().text), "no telemetry for 0.2 s")
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    "words, part",
    [
        (("--link", "pier"), "pier: is not the address of a vehicle"),
        (("--link", "127.0.0.0/24", "--boat", "esso_osaka"), "do not reverse"),
        (("--link", "127.0.0.0/24", "--boat", "swamp", "--boat", "swamp-light"), "give one --boat"),
        (("--link", "127.0.0.0/24", "--disturbances", "severe"), "leave out --disturbances"),
        (("--link", "127.0.0.0/24", "--pilot", "missing"), "leave out --pilot"),
        (("--origin", "44.3,9.1"), "give --link too"),
        (("--link", "127.0.0.0/24", "--origin", "95,9"), "--origin 95,9"),
        (("--link", "127.0.0.0/24", "--course", "nowhere"), "nowhere"),
    ],
)
def test_a_recorder_at_a_link_refuses_in_one_line(call: Call, words: tuple[str, ...], part: str) -> None:
    assert_complains(call("record", "--out", "runs", "--port", "0", *words), part)
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    "words, parts",
    [
        (("helm", "line-of-sight", "--link", "127.0.0.1"), ("127.0.0.1: is not the address of a vehicle",)),
        (("helm", "line-of-sight", "--link", "nowhere/24"), ("is not the address of a vehicle",)),
        (("helm", "line-of-sight", "--boat", "esso_osaka"), ("thrusters.main", "do not reverse")),
        (("helm", "missing"), ("missing",)),
        (("helm", "line-of-sight", "--origin", "95,9"), ("--origin 95,9",)),
        (("vehicle", "--address", "127.0.0.1:70000"), ("is not the address of a vehicle",)),
        (("vehicle", "--address", "192.0.2.1:29680"), ("cannot be served",)),
        (("vehicle", "esso_osaka"), ("thrusters.main",)),
    ],
)
def test_wrong_input_is_one_line(call: Call, words: tuple[str, ...], parts: tuple[str, ...]) -> None:
    assert_complains(call(*words), *parts)


def test_an_existing_log_is_refused_before_anything_is_driven(call: Call, tmp_path: Path) -> None:
    (tmp_path / "log").mkdir()
    (tmp_path / "link").symlink_to("nowhere")
    (tmp_path / "file").write_text("mine")
    assert_complains(call("helm", "line-of-sight", "--log", "log"), "log: already exists")
    assert_complains(call("helm", "line-of-sight", "--log", "link"), "link: already exists")
    assert_complains(call("helm", "line-of-sight", "--log", "file/log"), "file/log", "is not a folder")
