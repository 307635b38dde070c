"""A recorded run sails again to the bit: whatever the boat, what disturbs it, and who had the helm."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat import load_boat
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.runs import DatasetMeta, Run, RunMeta, check_dataset
from swamp_rl.teleop.afloat import Afloat
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.recordings import Recordings
from swamp_rl.teleop.rows import initial_state, largest_difference, sailed_again
from swamp_rl.teleop.session import ENDED, RUN, Session
from tests.support.driving import accept, command, meta

KICK = {
    "effect": "thruster_kick",
    "thruster": "sp",
    "time": 9.0,
    "duration": 2.0,
    "throttle": 0.6,
    "azimuth": 1,
}
DELAY = {"effect": "command_delay", "delay": 0.23}
SENSORS = [
    {"effect": "heading_bias", "bias": 0.1},
    {"effect": "position_delay", "delay": 0.37},
    {"effect": "position_lever_arm", "x": 0.4, "y": -0.1},
]
GUSTS = [{"effect": "wind", "speed": 4.0, "from": 1.0}, {"effect": "gusts", "speed_std": 0.8}]
WORN = [
    {"effect": "current", "north": 0.1, "east": -0.15},
    {"effect": "thruster_gain", "thruster": "bs", "gain": 0.7},
    {"effect": "azimuth_offset", "thruster": "bp", "offset": 0.1},
    {"effect": "channel_swap", "thruster": ["ss", "sp"]},
]


def described(boat: str) -> DatasetMeta:
    found = load_boat(boat)
    particulars = {key: getattr(found, key) for key in ("mass", "draught", "water_density")}
    return meta(vehicle=boat, **particulars)


def driven(folder: Path, boat: str, effects: list[dict[str, Any]], kicks: bool) -> Session:
    """A session whose run has ended: commands at odd instants, the helm given away and taken back."""

    def make_craft(level: str, senses: tuple[str, ...]) -> Afloat:
        return Afloat(GatesEnv(boat=boat, disturbances=effects, observation=senses))

    berth = Berth(make_craft, ("set",), lambda: Recordings(folder, described(boat), lambda line: None))
    game = Session({boat: berth}, np.random.default_rng(3), {"ai": ScriptedPilot(2)})
    now, helms = 0.0, 0
    while game.phase != ENDED:
        kicked = {"stern_throttle": 0.7, "stern_azimuth": -1.3} if kicks and 20 < game.rows < 30 else {}
        game.command(command(game, **kicked), now)
        if game.phase == RUN and game.rows > 15 * (helms + 1):
            game.change_helm(now)
            helms += 1
        now += 0.037
    return game


@pytest.mark.parametrize(
    ("boat", "effects", "kicks"),
    [
        ("swamp", [DELAY], False),
        ("swamp", [*SENSORS, *GUSTS, KICK], True),
        ("swamp-light", [*WORN, *SENSORS, DELAY | {"delay": 0.5}, *GUSTS], True),
        ("esso_osaka", [DELAY, *GUSTS, SENSORS[0]], False),
    ],
)
def test_any_boat_with_any_effects_sails_its_run_again_to_the_bit(
    tmp_path: Path, boat: str, effects: list[dict[str, Any]], kicks: bool
) -> None:
    game = driven(tmp_path / "runs", boat, effects, kicks)
    run = game.recordings.read(accept(game))
    assert check_dataset(tmp_path / "runs") == []
    assert len(run.time) > 40
    assert set(run.columns["driver"]) == {0.0, 1.0}
    assert not kicks or run.columns["throttle_sp"].max() == 0.7
    assert largest_difference(run, load_boat(boat)) == 0.0


def test_a_run_kept_from_its_middle_on_sails_again_with_the_commands_before_it(tmp_path: Path) -> None:
    game = driven(tmp_path / "runs", "swamp", [DELAY], False)
    whole = game.recordings.read(accept(game))
    boat = load_boat("swamp")
    commands = whole.commands(boat.thruster_names)
    first = 40 + int(np.argmax(np.abs(np.diff(commands[39:-40], axis=0)).sum(axis=1)))  # changed just then
    start = initial_state(boat, sailed_again(whole, boat)[first])
    rest = {name: values[first:] for name, values in whole.columns.items()}
    # 0.23 s is two steps and a part of the third.
    before = commands[first - 3 : first].T.tolist()
    channels = [f"{kind}_{name}" for kind in ("azimuth", "throttle") for name in boat.thruster_names]
    entries = {"initial_state": start, "earlier_commands": dict(zip(channels, before, strict=True))}
    meta = RunMeta.model_validate(whole.meta.model_dump() | entries)
    assert largest_difference(Run("rest", rest, meta), boat) == 0.0
    forgotten = meta.model_copy(update={"earlier_commands": {}})
    assert largest_difference(Run("rest", rest, forgotten), boat) > 1e-6
