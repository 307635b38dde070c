"""Every value that no writer gives a setting in `pilot.json` is refused by its key, or drives."""

import copy
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots import Pilot, load_pilot, save_pilot
from swamp_rl.pilots.description import sealed
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.store import describe_pilot
from swamp_rl.pilots.takeover import TakeoverPilot
from tests.support.random_pilots import gru, network, reservoir

RNG = np.random.default_rng(0)
PILOTS: dict[str, Pilot] = {
    "scripted": ScriptedPilot(3),
    "line-of-sight": LineOfSightPilot(),
    "reservoir": reservoir(RNG),
    "ppo": network(RNG, hold=5, memory=3, hidden=8),
    "gru": gru(RNG, 8),
    "takeover": TakeoverPilot(ScriptedPilot(5), reservoir(RNG), 3.0),
}
HOSTILE: tuple[Any, ...] = (
    *(None, True, "zzz", "", "1.5", "../evil", "a\x1b[2J", "A" * 5000, [], [1, 2], {}, {"a": 1}),
    *(-1, 0, 0.5, -0.5, 1e-320, 1e300, 10**18, 2**63, 10**400),
)
MISSING = object()


def substituted(settings: dict[str, Any], value: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    """Copies of the settings in each of which another key has the value, and that key; of those within one,
    the first five."""
    for key, held in settings.items():
        changed = copy.deepcopy(settings)
        if value is MISSING:
            del changed[key]
        else:
            changed[key] = value
        yield key, changed
        if isinstance(held, dict):
            for below, inner in islice(substituted(held, value), 5):
                yield f"{key}.{below}", settings | {key: inner}


@pytest.mark.parametrize("name", PILOTS)
def test_a_setting_that_no_writer_gives_is_refused_by_its_key_or_drives(name: str, tmp_path: Path) -> None:
    pilot = PILOTS[name]
    save_pilot(pilot, tmp_path)
    whole = describe_pilot(tmp_path)
    for value in (*HOSTILE, MISSING):
        for key, settings in substituted(whole.settings, value):
            (tmp_path / "pilot.json").write_text(sealed(whole.model_copy(update={"settings": settings})))
            try:
                read = load_pilot(tmp_path)
            except UserError as error:
                message = str(error)
                assert message.isprintable() and len(message) < 600
                assert "NoneType" not in message and "object" not in message and "operand" not in message, (
                    key,
                    message,
                )
            else:
                read.reset(2)
                levers = read.act(np.ones((2, len(read.senses))))
                assert levers.shape == (2, 2) and np.isfinite(levers).all(), (key, value)


@pytest.mark.parametrize(
    ("name", "changes", "message"),
    [
        ("scripted", {"seed": "zzz"}, "settings: seed: must be a whole number, not 'zzz'"),
        ("scripted", {"step": -0.5}, "settings: step: must be greater than 0, not -0.5"),
        ("scripted", {"habits": {"boat_length": 1e-320}}, "settings: habits.boat_length: must be at least"),
        ("ppo", {"hold": 2**63}, "settings: hold: must be at most 1000000"),
        ("ppo", {"kind": "sac"}, "settings: kind: must be ppo"),
        ("reservoir", {"senses": None}, "settings: senses: must be a list, not null"),
        ("reservoir", {"units": 3}, "settings: units: unknown key"),
        ("takeover", {"first": {"kind": "scripted"}}, "settings: first.settings: is missing"),
    ],
)
def test_a_setting_is_refused_with_what_is_allowed(
    name: str, changes: dict[str, Any], message: str, tmp_path: Path
) -> None:
    save_pilot(PILOTS[name], tmp_path)
    whole = describe_pilot(tmp_path)
    changed = whole.model_copy(update={"settings": whole.settings | changes})
    (tmp_path / "pilot.json").write_text(sealed(changed))
    with pytest.raises(UserError, match=rf"\({message}.*\); train it again"):
        load_pilot(tmp_path)
