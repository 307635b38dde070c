"""Pilots come back from the disk as they were, and a damaged or changed one is refused."""

import hashlib
import json
import os
import pickle
import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies

from swamp_rl.errors import UserError
from swamp_rl.pilots import Pilot, load_pilot, save_pilot
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.description import FittedOn, sealed
from swamp_rl.pilots.gru import GRUSettings, fit_gru
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.reservoir import ReservoirPilot, fit_reservoir
from swamp_rl.pilots.scripted import Habits, ScriptedPilot
from swamp_rl.pilots.store import describe_pilot
from swamp_rl.pilots.takeover import TakeoverPilot
from swamp_rl.replacement import WRITTEN
from tests.support.steering_runs import RUNS, SMALL

SENSES = ("north", "east", "cos_heading", "sin_heading")
PILOTS: dict[str, Callable[[], Pilot]] = {
    "scripted": lambda: ScriptedPilot(3, Habits(messy=0.5, reaction=(0.1, 0.2))),
    "reservoir": lambda: fit_reservoir(RUNS, SMALL),
    "cloning": lambda: fit_cloning(RUNS, CloningSettings(senses=SENSES, epochs=1)),
    "gru": lambda: fit_gru(RUNS, GRUSettings(senses=SENSES, epochs=1)),
    "takeover": lambda: TakeoverPilot(ScriptedPilot(5), fitted("reservoir"), 1.0),
}


@cache
def fitted(name: str) -> Pilot:
    """One of `PILOTS`, made for the first test that asks."""
    return PILOTS[name]()


def levers(pilot: Pilot) -> np.ndarray:
    """(40, 3, 2) levers for three boats that see something at random."""
    rng = np.random.default_rng(0)
    pilot.reset(3)
    return np.array([pilot.act(rng.normal(size=(3, len(pilot.senses)))) for _ in range(40)])


@pytest.mark.parametrize("kind", PILOTS)
def test_a_pilot_read_back_drives_bit_for_bit_alike(kind: str, tmp_path: Path) -> None:
    save_pilot(fitted(kind), tmp_path / kind)
    again = load_pilot(tmp_path / kind)
    assert (again.kind, again.senses) == (fitted(kind).kind, fitted(kind).senses)
    np.testing.assert_array_equal(levers(again), levers(fitted(kind)))
    names = {path.name for path in (tmp_path / kind).iterdir()}
    assert names == {WRITTEN, "pilot.json", "weights.safetensors"}


def test_an_earlier_pilot_is_replaced_and_another_folder_is_not(tmp_path: Path) -> None:
    save_pilot(fitted("scripted"), tmp_path / "pilot")
    save_pilot(fitted("reservoir"), tmp_path / "pilot")
    assert load_pilot(tmp_path / "pilot").kind == "reservoir"
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "one.txt").write_text("dear", encoding="utf-8")
    with pytest.raises(UserError, match="letters"):
        save_pilot(fitted("reservoir"), tmp_path / "letters")
    assert (tmp_path / "letters" / "one.txt").read_text(encoding="utf-8") == "dear"


def test_a_pilot_that_the_disk_has_no_room_for_is_one_clear_line_and_not_there(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, before[1]))
    try:
        with pytest.raises(UserError, match="pilot: File too large"):
            save_pilot(fitted("reservoir"), tmp_path / "pilot")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


def test_a_missing_pilot_is_reported_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"pilot.json: No such file"):
        load_pilot(tmp_path / "pilot")


def resealed(folder: Path, **changes: Any) -> None:
    """Change the description and seal it anew, as only a program that writes pilots does."""
    description = describe_pilot(folder).model_copy(update=changes)
    (folder / "pilot.json").write_text(sealed(description), encoding="utf-8")


def test_a_description_that_makes_no_pilot_is_reported_in_one_line_that_names_it(tmp_path: Path) -> None:
    bare = {"kind": "ppo", "senses": [], "hold": 1}
    spoilt: dict[str, dict[str, Any]] = {
        "'autopilot' is none of": {"kind": "autopilot"},
        "settings: senses: is missing": {"settings": {}},
        "centre has the shape": {"settings": {"senses": SENSES[1:]}},
        "two outputs": {"kind": "ppo", "settings": bare},
        "differ in the observation": {"senses": ("north",)},
        "settings: first: must be a mapping": {
            "kind": "takeover",
            "settings": {"first": "reservoir", "then": "ppo"},
        },
    }
    for number, (message, changes) in enumerate(spoilt.items()):
        folder = tmp_path / f"pilot-{number}"
        save_pilot(fitted("reservoir"), folder)
        resealed(folder, **changes)
        with pytest.raises(UserError, match=message) as error:
            load_pilot(folder)
        assert str(folder) in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "number", "message"),
    [("W", np.nan, "W holds"), ("Wout", np.inf, "Wout holds"), ("scale", 0.0, "scale must be above 0")],
)
def test_weights_that_give_no_levers_are_refused_by_their_name(
    name: str, number: float, message: str, tmp_path: Path
) -> None:
    class Spoilt(ReservoirPilot):
        def weights(self) -> dict[str, np.ndarray]:
            held = dict(super().weights())
            return held | {name: np.full_like(held[name], number)}

    pilot = fitted("reservoir")
    save_pilot(Spoilt.build(pilot.settings(), pilot.weights()), tmp_path)
    with pytest.raises(UserError, match=rf"weights.safetensors: {message}.*; train the pilot again"):
        load_pilot(tmp_path)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pilots") / "takeover"
    save_pilot(fitted("takeover"), folder)
    return folder


@contextmanager
def damaged(path: Path, content: bytes) -> Iterator[None]:
    whole = path.read_bytes()
    path.write_bytes(content)
    try:
        yield
    finally:
        path.write_bytes(whole)


@settings(max_examples=150)
@given(data=strategies.data(), name=strategies.sampled_from(["pilot.json", "weights.safetensors"]))
def test_one_flipped_bit_anywhere_is_refused_in_one_line(
    stored: Path, data: strategies.DataObject, name: str
) -> None:
    content = bytearray((stored / name).read_bytes())
    place = data.draw(strategies.integers(0, 8 * len(content) - 1))
    content[place // 8] ^= 1 << place % 8
    with damaged(stored / name, bytes(content)), pytest.raises(UserError, match="pilot") as error:
        load_pilot(stored)
    assert "\n" not in str(error.value)


@given(data=strategies.data(), name=strategies.sampled_from(["pilot.json", "weights.safetensors"]))
def test_a_truncated_or_lengthened_file_is_refused(
    stored: Path, data: strategies.DataObject, name: str
) -> None:
    whole = (stored / name).read_bytes()
    cut = whole[: data.draw(strategies.integers(0, len(whole) - 1))]
    for content in (cut, whole + b"\n"):
        with damaged(stored / name, content), pytest.raises(UserError, match=str(stored)):
            load_pilot(stored)
    load_pilot(stored)


@pytest.mark.parametrize("text", ["[]", "{}", "[" * 100_000, '{"kind": NaN}', "\ud800", '"kind"', "9" * 5000])
def test_json_that_is_no_description_is_refused(stored: Path, text: str) -> None:
    content = text.encode(errors="surrogatepass")
    with damaged(stored / "pilot.json", content), pytest.raises(UserError, match=r"pilot\.json"):
        load_pilot(stored)


def test_another_version_is_refused_by_its_number(stored: Path) -> None:
    description = (stored / "pilot.json").read_text(encoding="utf-8")
    later = description.replace('"version": 2', '"version": 3')
    with damaged(stored / "pilot.json", later.encode()), pytest.raises(UserError, match="of format 3, this"):
        load_pilot(stored)
    earlier = json.dumps({"kind": "reservoir", "settings": {}}).encode()
    with damaged(stored / "pilot.json", earlier), pytest.raises(UserError, match="of format 1, this reads"):
        load_pilot(stored)


class Trap:
    """Unpickled, it would make a folder."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self.path),)


def test_a_pickle_in_the_place_of_either_file_is_refused_and_not_executed(
    stored: Path, tmp_path: Path
) -> None:
    trap = pickle.dumps(Trap(tmp_path / "executed"))
    for name in ("pilot.json", "weights.safetensors"):
        with damaged(stored / name, trap), pytest.raises(UserError, match=name):
            load_pilot(stored)
    assert list(tmp_path.iterdir()) == []
    pickle.loads(trap)
    assert (tmp_path / "executed").is_dir(), "the trap itself must work"


def test_a_pilot_says_what_it_senses_by_what_it_normalises_and_what_it_was_fitted_on(tmp_path: Path) -> None:
    learned = FittedOn(dataset="0a" * 32, source="scripted", runs=("one", "two"))
    save_pilot(fitted("reservoir"), tmp_path / "pilot", learned)
    found = describe_pilot(tmp_path / "pilot")
    assert (found.fitted_on, found.senses) == (learned, SENSES)
    assert found.weights.normalisation == ("centre", "scale")
    assert found.weights.shapes["Wout"] == ("float64", fitted("reservoir").weights()["Wout"].shape)
    weights = (tmp_path / "pilot" / "weights.safetensors").read_bytes()
    assert found.weights.sha256 == hashlib.sha256(weights).hexdigest()


def test_a_pilot_that_comes_with_the_package_is_loaded_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert load_pilot("reservoir").kind == "reservoir"
    assert load_pilot("line-of-sight").kind == "line-of-sight"
    with pytest.raises(UserError, match=r"^reservor: no such folder, and .* did you mean 'reservoir'\?"):
        load_pilot("reservor")


def test_the_pilots_in_a_folder_of_results_are_named(tmp_path: Path) -> None:
    save_pilot(LineOfSightPilot(), tmp_path / "pilots" / "steered")
    with pytest.raises(UserError, match=r"No such file or directory; name .*pilots/steered$"):
        load_pilot(tmp_path)
