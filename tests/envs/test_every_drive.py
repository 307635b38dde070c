"""Boats of every kind of drive on the default course: the joypad steers them, levels disturb them."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.single import GatesEnv

from swamp_rl.boat.estimate import KINDS, Kind
from swamp_rl.pilots.scripted import ScriptedPilot, habits_of
from tests.support.new_boats import SIZES, file_of, new_boat


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("lever", [-1.0, 1.0])
def test_the_lever_turns_the_bow_its_way_for_every_drive(tmp_path: Path, kind: Kind, lever: float) -> None:
    env = GatesEnv(boat=file_of(tmp_path, kind, 5.0))
    env.reset(seed=0)
    before = env.fleet.pose[0, 2]
    for _ in range(20):
        env.step(np.array([0.6, lever], np.float32))
    assert lever * (env.fleet.pose[0, 2] - before) > 0.0


@pytest.mark.parametrize("lever", [-1.0, 1.0])
def test_the_lever_turns_the_bow_its_way_with_foils(tmp_path: Path, lever: float) -> None:
    file_of(tmp_path, "outboard", 5.0)
    foil = "{area: 0.2, aspect_ratio: 1.5, gamma: 0.7, stall_angle: 0.4}"
    (tmp_path / "foil.yaml").write_text(f"extends: outboard.yaml\nthruster_model: {{foil: {foil}}}\n")
    env = GatesEnv(boat=tmp_path / "foil.yaml")
    env.reset(seed=0)
    before = env.fleet.pose[0, 2]
    for _ in range(20):
        env.step(np.array([0.6, lever], np.float32))
    assert lever * (env.fleet.pose[0, 2] - before) > 0.0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("length", SIZES)
def test_the_scripted_pilot_passes_the_gates_with_every_drive_and_size(
    tmp_path: Path, kind: Kind, length: float
) -> None:
    boat, count = new_boat(tmp_path, kind, length), 8
    pilot = ScriptedPilot(0, habits_of("expert", length))
    boats = GatesVectorEnv(count, boat=boat, disturbances="gusts", observation=pilot.senses)
    pilot.reset(count)
    seen, _ = boats.reset(options={"episodes": list(range(count)), "once": True})
    outcomes: list[str | None] = [None] * count
    for _ in range(round(1.2 * boats.fleet.course.time_limit / 0.1)):
        seen, _, over, cut, info = boats.step(pilot.act(seen))
        for i in np.flatnonzero(over | cut):
            outcomes[i] = outcomes[i] or info["outcome"][i]
        if all(outcomes):
            break
    assert outcomes.count("success") >= count // 2, outcomes


@pytest.mark.parametrize("kind", KINDS)
def test_every_level_disturbs_every_drive(tmp_path: Path, kind: Kind) -> None:
    path = file_of(tmp_path, kind)
    for level in ("standard", "severe", "kicks"):
        env = GatesEnv(boat=path, disturbances=level)
        assert np.isfinite(env.reset(seed=1)[0]).all()
        for _ in range(5):
            seen = env.step(np.array([1.0, 0.3], np.float32))[0]
        assert np.isfinite(seen).all()
