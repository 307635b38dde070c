"""`swamp-rl record` as it is started and stopped: by hand, and by a crash in the middle of a run."""

import json
import re
import signal
import subprocess
import threading
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect

from swamp_rl.files import write_yaml
from swamp_rl.link.vehicle import Conduct
from swamp_rl.runs import read_dataset
from swamp_rl.teleop import server
from tests.support.command_line import COMMAND, Call, assert_complains
from tests.support.command_line import call as call  # the fixture
from tests.support.driving import aim
from tests.support.link import own_network, served, vehicle_of
from tests.support.patience import PATIENCE, until
from tests.support.web import hear

pytestmark = [pytest.mark.slow, pytest.mark.timed]


@contextmanager
def started(folder: Path, *more: str) -> Iterator[tuple["subprocess.Popen[str]", list[str], str]]:
    """A recorder in a process of its own, its lines so far, and its address."""
    words = ["record", "--out", str(folder), "--course", "camogli", "--port", "0", "--scripted", *more]
    process = subprocess.Popen([COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert process.stdout is not None
    # A first start compiles, which takes a while.
    guard = threading.Timer(PATIENCE, process.kill)
    guard.start()
    lines = []
    try:
        for line in process.stdout:
            lines.append(line)
            if "drive at" in line:
                break
        guard.cancel()
        yield process, lines, re.findall(r"http\S+", lines[-1])[0]
    finally:
        guard.cancel()
        process.kill()
        process.wait()


def stopped(process: "subprocess.Popen[str]", how: signal.Signals) -> tuple[int, str]:
    process.send_signal(how)
    out, _ = process.communicate(timeout=PATIENCE)
    return process.returncode, out


def listens(address: str) -> bool:
    try:
        urllib.request.urlopen(address, timeout=PATIENCE).close()
    except OSError:
        return False
    return True


def drive_for_rows(host: str, table: Path, wanted: int, then: Callable[[], object]) -> None:
    """Drive until so many rows are in the run's table, then do something while still connected."""
    with connect(f"ws://{host}/socket", origin=f"http://{host}") as socket:
        while not table.exists() or table.read_text().count("\n") <= wanted:
            seen = json.loads(socket.recv(timeout=PATIENCE))
            if seen["type"] != "frame":
                continue
            assert seen["phase"] != "ended", seen["outcome"]
            angle = aim(*seen["pose"], seen["velocity"][2], seen["passed"])
            socket.send(json.dumps({"type": "command", "throttle": 1.0, "angle": angle}))
        then()


def test_boats_are_named_after_their_files_whatever_the_case_of_the_suffix(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_yaml("Twin.YAML", {"extends": "swamp", "name": "twin"})
    names: list[str] = []
    monkeypatch.setattr(server, "serve", lambda hub, *given: names.extend(hub.session.berths))
    boats = ("--boat", "swamp", "--boat", "Twin.YAML", "--boat", "./Twin.YAML")
    assert call("record", "--out", "runs", "--port", "0", *boats)[0] == 0
    assert names == ["swamp", "Twin", "Twin 2"]


def test_a_root_is_no_folder_of_runs_but_the_working_directory_may_be(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "serve", lambda *given: None)
    assert_complains(call("record", "--out", "runs/..", "--port", "0"), "runs/..: is a folder above")
    assert call("record", "--out", ".", "--port", "0")[0] == 0
    assert Path("dataset.yaml").is_file()


def test_a_recorder_killed_in_a_run_marks_it_at_the_next_start_and_ends_by_interrupt(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    with started(folder) as (process, _, address):
        host = address.split("/")[2]
        assert b"<canvas" in urllib.request.urlopen(address, timeout=PATIENCE).read()
        drive_for_rows(
            host, folder / "unfinished" / "run-0001.csv", 8, lambda: stopped(process, signal.SIGKILL)
        )
    with started(folder) as (process, result, _):
        assert "run-0001: never finished, taken into the dataset" in result[0]
        assert stopped(process, signal.SIGINT) == (0, f"{folder}: 0 runs, 1 interrupted\n")
    dataset = read_dataset(folder)
    assert dataset.meta.source == "scripted"
    (run,) = dataset.runs
    assert run.meta.outcome == "interrupted" and len(run.time) >= 8


def test_a_recorder_interrupted_in_a_run_tells_of_it_at_its_end(tmp_path: Path) -> None:
    folder, ended = tmp_path / "runs", list[tuple[int, str]]()
    with started(folder) as (process, _, address):
        drive_for_rows(
            address.split("/")[2],
            folder / "unfinished" / "run-0001.csv",
            3,
            lambda: ended.append(stopped(process, signal.SIGINT)),
        )
    ((code, result),) = ended
    last = result.splitlines()[-1]  # before it, a busy machine may tell that the driver sends too much
    assert (code, last) == (0, f"{folder}: 0 runs, 1 unfinished run to be stored at the next start")


@pytest.mark.parametrize("first", [signal.SIGTERM, signal.SIGHUP], ids=["terminated", "terminal closed"])
def test_a_recorder_asked_twice_to_end_ends_in_order(tmp_path: Path, first: signal.Signals) -> None:
    folder = tmp_path / "runs"
    with started(folder) as (process, _, address):
        host = address.split("/")[2]
        with connect(f"ws://{host}/socket", origin=f"http://{host}") as socket:
            socket.recv(timeout=PATIENCE)
            process.send_signal(first)
            until(lambda: not listens(address), "the recorder heeds the first signal")
            code, arguments = stopped(process, signal.SIGINT)
    word = {signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}[first]
    assert (code, arguments) == (128 + first, f"{folder}: 0 runs\nswamp-rl: {word}; ended in order\n")


def push(socket: ClientConnection, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """Hold the throttle, where the vehicle is ready, until a frame is wanted; that frame.

    A run that a busy machine ends before is discarded, once, and another begun.
    """
    before = ""

    def drive(message: dict[str, Any]) -> bool:
        nonlocal before
        if message["type"] != "frame" or wanted(message):
            return message["type"] == "frame"
        if message["phase"] == "ended":
            # Frames sent before the act arrives repeat the phase; a second act would discard the next run.
            if before != "ended":
                socket.send(json.dumps({"type": "act", "act": "discard"}))
        else:
            throttle = 0.0 if message["trouble"] else 1.0
            socket.send(json.dumps({"type": "command", "throttle": throttle, "angle": 0.0}))
        before = message["phase"]
        return False

    return hear(socket, drive)


def test_a_page_drives_a_served_vehicle_and_neither_its_end_nor_the_vehicles_goes_unnoticed(
    tmp_path: Path,
) -> None:
    folder, vehicle = tmp_path / "runs", vehicle_of(Conduct(), own_network().text)
    with served(vehicle, speed=1.0):
        with started(folder, "--link", vehicle.addresses.text) as (process, _, address):
            host = address.split("/")[2]
            with connect(f"ws://{host}/socket", origin=f"http://{host}") as socket:
                push(socket, lambda seen: seen["phase"] == "run" and seen["velocity"][0] > 0.1)
                push(socket, lambda _: bool(vehicle.commands()[4:].any()))
            until(lambda: not vehicle.commands()[4:].any(), "the vehicle stops when the page has gone")
            with connect(f"ws://{host}/socket", origin=f"http://{host}") as socket:
                # Of a run without a row there is nothing to accept: it would not be ended, but ready again.
                push(
                    socket,
                    lambda seen: (
                        seen["phase"] == "run" and seen["time"] > 0.0 and bool(vehicle.commands()[4:].any())
                    ),
                )
                vehicle.dead.update(vehicle.addresses.sensors)
                last = hear(
                    socket,
                    lambda seen: seen["type"] == "frame" and "No telemetry" in (seen["trouble"] or ""),
                )
                assert (last["phase"], last["outcome"]) == ("ended", "link_lost")
                assert last["levers"] == [0.0, 0.0]
                socket.send(json.dumps({"type": "act", "act": "accept"}))
                hear(socket, lambda message: message["type"] == "accepted")
                vehicle.dead.clear()
                push(socket, lambda seen: seen["phase"] == "run")
            unfinished = ", 1 unfinished run to be stored at the next start"
            ends = [
                (0, f"{folder}: 1 run{more}\n") for more in ("", unfinished)
            ]  # before its first row, or after
            assert stopped(process, signal.SIGINT) in ends
        until(lambda: not any(module.runs(0) for module in vehicle.modules), "the vehicle's pumps are off")
    dataset = read_dataset(folder)
    assert dataset.meta.source == "scripted" and vehicle.addresses.text in str(dataset.meta.notes)
    assert dataset.runs[0].meta.model_dump()["link"] == vehicle.addresses.text
    assert dataset.runs[0].meta.outcome == "link_lost" and len(dataset.runs[0].time) > 1
