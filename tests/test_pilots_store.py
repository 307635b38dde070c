"""Pilots come back from the disk as they were, and a damaged one is told."""

import json
import resource
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots import Pilot, load_pilot, save_pilot
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.reservoir import fit_reservoir
from swamp_rl.pilots.scripted import Habits, ScriptedPilot
from swamp_rl.pilots.takeover import TakeoverPilot
from tests.test_reservoir import RUNS, SMALL

SENSES = ("north", "east", "cos_heading", "sin_heading")
RESERVOIR = fit_reservoir(RUNS, SMALL)
PILOTS: dict[str, Pilot] = {
    "scripted": ScriptedPilot(3, Habits(messy=0.5, reaction=(0.1, 0.2))),
    "reservoir": RESERVOIR,
    "cloning": fit_cloning(RUNS, CloningSettings(senses=SENSES, epochs=1)),
    "takeover": TakeoverPilot(ScriptedPilot(5), RESERVOIR, 1.0),
}


def levers(pilot: Pilot) -> np.ndarray:
    """(40, 3, 2) levers for three boats that see something at random."""
    rng = np.random.default_rng(0)
    pilot.reset(3)
    return np.array([pilot.act(rng.normal(size=(3, len(pilot.senses)))) for _ in range(40)])


@pytest.mark.parametrize("kind", PILOTS)
def test_a_pilot_read_back_drives_bit_for_bit_alike(kind: str, tmp_path: Path) -> None:
    save_pilot(PILOTS[kind], tmp_path / kind)
    again = load_pilot(tmp_path / kind)
    assert (again.kind, again.senses) == (PILOTS[kind].kind, PILOTS[kind].senses)
    np.testing.assert_array_equal(levers(again), levers(PILOTS[kind]))
    assert sorted(path.name for path in (tmp_path / kind).iterdir()) == ["pilot.json", "weights.safetensors"]


def test_an_earlier_pilot_is_replaced_and_another_folder_is_not(tmp_path: Path) -> None:
    save_pilot(PILOTS["scripted"], tmp_path / "pilot")
    save_pilot(PILOTS["reservoir"], tmp_path / "pilot")
    assert load_pilot(tmp_path / "pilot").kind == "reservoir"
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "one.txt").write_text("dear", encoding="utf-8")
    with pytest.raises(UserError, match="letters"):
        save_pilot(PILOTS["reservoir"], tmp_path / "letters")
    assert (tmp_path / "letters" / "one.txt").read_text(encoding="utf-8") == "dear"


def test_a_pilot_that_the_disk_has_no_room_for_is_one_clear_line_and_not_there(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, before[1]))
    try:
        with pytest.raises(UserError, match="pilot: File too large"):
            save_pilot(RESERVOIR, tmp_path / "pilot")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


def test_damage_is_told_in_one_line_that_names_the_pilot(tmp_path: Path) -> None:
    folder = tmp_path / "pilot"
    with pytest.raises(UserError, match=r"pilot.json: No such file"):
        load_pilot(folder)
    save_pilot(PILOTS["reservoir"], folder)
    weights, description = folder / "weights.safetensors", folder / "pilot.json"
    whole, said = weights.read_bytes(), description.read_text(encoding="utf-8")
    bare = {"kind": "ppo", "senses": [], "hold": 1}
    spoilt = {
        "is damaged": (whole[: len(whole) // 2], said),
        "is not JSON": (whole, said[:-3]),
        "'autopilot' is none of": (whole, said.replace('"reservoir"', '"autopilot"')),
        "'settings' is missing": (whole, json.dumps({"kind": "reservoir"})),
        "centre has the shape": (whole, said.replace('"north",', "")),
        "does not hold a whole pilot": (whole, "[]"),
        "two outputs": (whole, json.dumps({"kind": "ppo", "settings": bare})),
    }
    for message, (array, text) in spoilt.items():
        weights.write_bytes(array)
        description.write_text(text, encoding="utf-8")
        with pytest.raises(UserError, match=message) as told:
            load_pilot(folder)
        assert str(folder) in str(told.value) and "\n" not in str(told.value)
