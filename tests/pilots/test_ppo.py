"""PPO as it is trained here: broken off and resumed, begun as a clone, with a memory, telling its curve."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from pydantic import ValidationError
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.errors import UserError
from swamp_rl.pilots.network import NetworkPilot, layers_of
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from swamp_rl.pilots.scripted import ScriptedPilot
from tests.support import forks
from tests.support.killed import assert_same_weights, killed_training
from tests.support.killed_ppo import trained

pytestmark = pytest.mark.slow

QUICK = PPOSettings(boats=8, decisions=2048, horizon=64, batch_size=128, epochs=2, leg=2)
CLONED = ("east", "north", "yaw_rate", "gate_sin")


def boats_of(settings: PPOSettings) -> GatesVecEnv:
    boats = GatesVectorEnv(settings.boats, observation=settings.senses, autoreset_mode="SameStep")
    return GatesVecEnv(boats, settings.hold)


def clone(senses: tuple[str, ...] = CLONED, hidden: int = 64) -> NetworkPilot:
    torch.manual_seed(5)
    widths = (len(senses), hidden, hidden, 2)
    layers = layers_of([torch.nn.Linear(*pair) for pair in pairwise(widths)])
    rng = np.random.default_rng(5)
    scaling = {"mean": rng.normal(size=len(senses)), "scale": rng.uniform(0.5, 2.0, size=len(senses))}
    return NetworkPilot("cloning", senses, scaling | layers)


@forks.GROUP
@pytest.mark.timed
def test_a_training_killed_at_random_instants_ends_with_the_same_bits(tmp_path: Path) -> None:
    kills, resumed = killed_training("ppo", tmp_path)
    assert kills >= 2
    unbroken = trained(None)
    assert resumed.settings() == unbroken.settings()
    assert_same_weights(unbroken, resumed)


def test_a_checkpoint_tells_the_curve_again_and_is_refused_with_other_settings(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint"
    entries: list[tuple[int, dict[str, float]]] = []

    def log(step: int, values: Any) -> None:
        entries.append((step, dict(values)))

    train_ppo(boats_of(QUICK), QUICK, log=log, checkpoint=path)
    first = list(entries)
    assert [step for step, _ in first] == sorted({step for step, _ in first}) and first[-1][0] == 2048
    assert all(0.0 <= values["success"] <= 1.0 and values["episodes"] >= 1 for _, values in first)
    entries.clear()
    train_ppo(boats_of(QUICK), QUICK, log=log, checkpoint=path)
    assert entries == first
    with pytest.raises(UserError, match=r"other settings \(epochs\)"):
        train_ppo(boats_of(QUICK), QUICK.model_copy(update={"epochs": 3}), checkpoint=path)
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(UserError, match="damaged"):
        train_ppo(boats_of(QUICK), QUICK, checkpoint=path)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"batch_size": 1}, "batch_size"),
        ({"horizon": 1, "boats": 1}, "raise horizon or boats"),
        ({"hold": 100_000}, "hold"),
    ],
)
def test_settings_of_which_nothing_can_be_learned_are_refused(options: dict[str, int], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        PPOSettings(**options)


def test_a_training_without_a_checkpoint_writes_nothing(temporary: Path) -> None:
    short = QUICK.model_copy(update={"decisions": 512, "leg": 1})
    train_ppo(boats_of(short), short)
    assert not list(temporary.iterdir())


def test_ppo_drives_as_the_clone_it_begins_as_until_its_value_function_has_settled() -> None:
    settled = QUICK.model_copy(update={"settle": 100, "memory": 2})
    start = clone()
    pilot = train_ppo(boats_of(settled), settled, start=start)
    seen = np.random.default_rng(0).normal(size=(50, len(settled.senses)))
    places = [settled.senses.index(name) for name in CLONED]
    pilot.reset(50)
    start.reset(50)
    np.testing.assert_allclose(pilot.act(seen), start.act(seen[:, places]), atol=1e-5)
    moving = settled.model_copy(update={"settle": 1})
    moved = train_ppo(boats_of(moving), moving, start=start)
    moved.reset(50)
    assert (moved.act(seen) != pilot.act(seen)).any()


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (ScriptedPilot(0), "cannot start from a scripted pilot"),
        (clone(("north", "east"), hidden=32), "use the same `hidden`"),
        (clone(("north", "gate_sin")), "senses gate_sin, which"),
        (NetworkPilot("ppo", ("north",), clone(CLONED).weights(), memory=1), "has a memory, which"),
    ],
)
def test_a_pilot_that_ppo_cannot_begin_as_is_refused(start: Any, message: str) -> None:
    settings = QUICK.model_copy(update={"senses": ("north", "east")})
    with pytest.raises(UserError, match=message):
        train_ppo(boats_of(settings), settings, start=start)


def test_a_policy_with_a_memory_is_the_same_pilot_as_in_training() -> None:
    from swamp_rl.pilots.remembering import RememberingBoats

    remembering = RememberingBoats(boats_of(QUICK), 2)
    width = 12 + 2 * (12 + 2)
    layers = {"weight_0": np.random.default_rng(0).normal(size=(width, 2)) * 0.05, "bias_0": np.zeros(2)}
    scaling = {"mean": np.zeros(width), "scale": np.ones(width)}
    pilot = NetworkPilot("ppo", QUICK.senses, scaling | layers, QUICK.hold, memory=2)
    pilot.reset(8)
    seen = np.asarray(remembering.reset())
    assert seen.shape == (8, width)
    for _ in range(4):
        levers = pilot._decide(seen)
        acted = [pilot.act(seen[:, : len(QUICK.senses)]) for _ in range(QUICK.hold)]
        np.testing.assert_array_equal(acted[-1], levers)
        seen = np.asarray(remembering.step((levers - [0.5, 0.0]) * [2.0, 1.0])[0])


def test_caution_is_paid_for_what_is_touched_and_not_for_success_or_the_clock() -> None:
    from swamp_rl.pilots.cautious import CautiousBoats

    settings = QUICK.model_copy(update={"boats": 32})
    plain, cautious = boats_of(settings), CautiousBoats(boats_of(settings), 3.0)
    for boats in (plain, cautious):
        boats.seed(7)
        boats.reset()
    chance, paid = np.random.default_rng(7), dict[str, set[float]]()
    idle = np.arange(32) < 4  # these lie until the clock ends their episodes
    for _ in range(210):
        actions = np.where(idle[:, None], [-1.0, 0.0], chance.uniform(-0.6, 1.0, (32, 2)))
        _, rewards, dones, infos = plain.step(actions)
        _, fewer, _, _ = cautious.step(actions)
        np.testing.assert_array_equal(rewards[~dones], fewer[~dones])
        for i in np.flatnonzero(dones):
            paid.setdefault(infos[i]["outcome"], set()).add(round(float(rewards[i] - fewer[i]), 5))
    assert paid["timeout"] == {0.0}
    assert paid["buoy"] == paid["out_of_bounds"] == {3.0}
    assert paid.get("success", {0.0}) == {0.0}
