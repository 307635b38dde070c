"""`swamp-rl fleet`: how it ends where no dataset could be diagnosed."""

from contextlib import nullcontext
from pathlib import Path

import pytest

from tests.support.command_line import Call, assert_complains
from tests.support.fleets import datasets, pretend
from tests.support.sweep_pools import PoolHere


def test_a_fleet_of_which_none_is_diagnosed_ends_with_1_and_keeps_its_report(call: Call) -> None:
    Path("empty").mkdir()
    code, message, _ = call("fleet", "empty", "--out", "out", "--workers", "1")
    assert code == 1
    assert "empty/dataset.yaml: is missing" in message
    assert "0 of 0 causes kept, 1 of 1 datasets not diagnosed" in message
    assert Path("out/fleet.json").is_file()


def test_a_dataset_that_is_no_folder_is_refused_in_one_line_before_anything_is_written(call: Call) -> None:
    Path("red").mkdir()
    assert_complains(call("fleet", "red", "nowhere", "--out", "out"), "nowhere: no such folder")
    assert not Path("out").exists()


def test_a_fleet_says_which_folder_is_a_boat(call: Call) -> None:
    for folder in ("boats/red", "boats/blue", "logs/red"):
        Path(folder).mkdir(parents=True)
    _, out, _ = call("fleet", "boats/red", "boats/blue", "--out", "one")
    assert out.splitlines()[0] == "diagnosing 2 datasets of 2 boats"
    _, out, _ = call("fleet", "boats/red", "boats/blue", "logs/red", "--out", "two")
    assert out.splitlines()[0] == "diagnosing 3 datasets of 2 boats by folder: boats (2), logs (1)"


def test_a_fleet_without_its_cluster_leaves_no_folder(call: Call) -> None:
    assert call("record-scripted", "--out", "red", "--count", "1")[0] == 0
    pytest.importorskip("ray", reason="Ray is not installed")
    for address, message in (("", "--ray is empty"), ("127.0.0.1:1", "no cluster answers")):
        assert_complains(call("fleet", "red", "--out", "out", "--ray", address), message)
    assert not Path("out").exists()


def test_a_fleet_that_ignores_an_unknown_measurement_is_refused_before_anything_is_written(
    call: Call,
) -> None:
    Path("red").mkdir()
    assert_complains(call("fleet", "red", "--ignore", "waves", "--out", "out"), "unknown measurement 'waves'")
    assert not Path("out").exists()


def test_a_fleet_with_an_unknown_boat_is_refused_before_anything_is_written(call: Call) -> None:
    for folder in ("boats/red", "boats/blue"):
        Path(folder).mkdir(parents=True)
    code, _, message = call("fleet", "boats/red", "boats/blue", "--boat", "swampy", "--out", "out")
    assert code == 2
    assert message.count("no boat file named 'swampy'") == 1
    assert not Path("out").exists()


def test_a_resumed_fleet_says_how_many_are_already_diagnosed(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = [str(path) for path in datasets(Path("in"), {"red": {"causes": []}, "blue": {"causes": []}})]
    monkeypatch.setattr(
        "swamp_rl.experiments.fleet.run.open_pool", lambda *asked: nullcontext(PoolHere(pretend, 1, 0))
    )
    assert "already diagnosed" not in call("fleet", *given, "--out", "out")[1]
    assert "  already diagnosed: 2 of 2\n" in call("fleet", *given, "--out", "out")[1]
    Path("in/red/run.csv").write_text("another run")
    changed = "made again, as the dataset, the boat, --ignore or the version changed: 1"
    assert f"  already diagnosed: 1 of 2; {changed}\n" in call("fleet", *given, "--out", "out")[1]


def test_a_fleet_says_the_causes_of_each_boat_as_it_is_diagnosed_and_the_boats_without(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    mass = {"effect": "mass", "parameter": "mass", "value": 62.0, "error": 0.2, "gain": 80.0, "unit": "kg"}
    given = [str(one) for one in datasets(Path("in"), {"red": {"causes": [mass]}, "blue": {"causes": []}})]
    monkeypatch.setattr(
        "swamp_rl.experiments.fleet.run.open_pool", lambda *asked: nullcontext(PoolHere(pretend, 1, 0))
    )
    lines = call("fleet", *given, "--out", "out")[1].splitlines()
    assert {"red: cause; mass", "blue: nothing_wrong"} <= set(lines)
    assert {"  red: mass", "  no cause of their own: blue"} <= set(lines)


def test_a_fleet_says_the_weather_of_a_dataset_and_which_were_not_diagnosed(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    wind = {"effect": "wind", "parameter": "speed", "value": 3.0, "error": 0.1, "gain": 80.0, "unit": "m/s"}
    told = {"red": {"causes": [wind]}, "blue": {"error": "too short"}}
    monkeypatch.setattr(
        "swamp_rl.experiments.fleet.run.open_pool", lambda *asked: nullcontext(PoolHere(pretend, 1, 0))
    )
    message = call("fleet", *map(str, datasets(Path("in"), told)), "--out", "out")[1]
    lines = message.splitlines()
    assert "red: cause; weather: wind" in lines
    assert "  not diagnosed, see above or fleet.html: blue" in lines
