"""Trained pilots of every kind take the helm and give it back; what people corrected can be learned from."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.hindsight import with_gates
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.course import load_course
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.demonstrations import MOTION, NEXT_GATE, POSE
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from swamp_rl.pilots.reservoir import fit_reservoir
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.store import load_pilot, save_pilot
from swamp_rl.pilots.takeover import TakeoverPilot
from swamp_rl.runs import Run, corrected, persons_part, read_dataset
from swamp_rl.teleop.messages import Choose
from swamp_rl.teleop.rows import largest_difference
from swamp_rl.teleop.session import ENDED, Session
from tests.support.driving import BOAT, accept, command, drive, session
from tests.support.steering_runs import RUNS, SMALL

pytestmark = pytest.mark.slow

COURSE = load_course("camogli")
QUICK = CloningSettings(senses=(*POSE, *MOTION, *NEXT_GATE), epochs=2)


def tiny_ppo() -> Pilot:
    settings = PPOSettings(boats=4, decisions=256, horizon=64, batch_size=64, epochs=1)
    boats = GatesVectorEnv(4, observation=settings.senses, autoreset_mode="SameStep")
    return train_ppo(GatesVecEnv(boats, settings.hold), settings, lambda done: None)


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Pilot]:
    """Trained as little as can be, saved, and read back as `record --pilot` does."""
    reservoir = fit_reservoir(RUNS, SMALL)
    made = {
        "ppo": tiny_ppo(),
        "reservoir": reservoir,
        "cloning": fit_cloning(RUNS, CloningSettings(senses=POSE, epochs=1)),
        "takeover": TakeoverPilot(ScriptedPilot(5), reservoir, 4.0),
    }
    folder = tmp_path_factory.mktemp("pilots")
    for name, pilot in made.items():
        save_pilot(pilot, folder / name)
    return {name: load_pilot(folder / name) for name in made}


def corrected_run(game: Session) -> Run:
    """A run in which the pilot has the helm for ten steps past the first gate, then the person again."""
    now, first, changed = 0.0, 0, set[int]()
    while game.phase != ENDED:
        first = first or (game.rows if game.gates else 0)
        if first and game.rows - first in (10, 20) and game.rows not in changed:
            changed.add(game.rows)
            game.change_helm(now)
        game.command(command(game, throttle=0.8), now)
        now += 0.1
    return game.recordings.read(accept(game))


@pytest.mark.parametrize("kind", ["ppo", "reservoir", "cloning", "takeover"])
def test_a_trained_pilot_takes_the_helm_and_gives_it_back(
    tmp_path: Path, trained: dict[str, Pilot], kind: str
) -> None:
    assert trained[kind].kind == kind
    game = session(tmp_path / "runs", pilots=trained)
    game.choose(Choose(type="choose", pilot=kind))
    run = corrected_run(game)
    about = run.meta.model_dump()
    assert (about["pilot"], about["helm"], about["corrections"]) == (kind, "both", 1)
    driver = run.columns["driver"] == 1.0
    assert np.count_nonzero(driver) == 10
    for lever in ("thrust", "angle"):
        assert np.array_equal(run.columns[f"joy_{lever}"][driver], run.columns[f"pilot_{lever}"][driver])
    assert largest_difference(run, BOAT) == 0.0


def test_corrected_runs_are_distinguished_and_the_persons_part_of_them_can_be_learned_from(
    tmp_path: Path, trained: dict[str, Pilot]
) -> None:
    game = session(tmp_path / "runs", pilots=trained)
    corrected_run(game)
    drive(game)
    accept(game)
    dataset = read_dataset(tmp_path / "runs")
    chosen = corrected(dataset.runs)
    assert [run.name for run in chosen] == ["run-0001"] and len(dataset.runs) == 2
    run = with_gates(chosen[0], COURSE)
    parts = persons_part(run)
    first, last = np.flatnonzero(run.columns["driver"] == 1.0)[[0, -1]].tolist()
    assert [len(part.time) for part in parts] == [first, len(run.time) - last - 1]
    assert np.array_equal(parts[1].time, run.time[last + 1 :])
    assert all((part.columns["driver"] == 0.0).all() for part in parts)
    # The gate was passed before the stretch began.
    assert (parts[1].columns["gates_passed"] >= 1.0).all()
    before = fit_cloning([with_gates(dataset.runs[1], COURSE)], QUICK)
    after = fit_cloning([with_gates(dataset.runs[1], COURSE), *parts], QUICK)
    assert (before.weights()["mean"] != after.weights()["mean"]).any()


def test_a_run_that_no_pilot_was_aboard_of_is_the_persons_as_a_whole(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    drive(game)
    run = game.recordings.read(accept(game))
    assert corrected([run]) == [] and persons_part(run) == [run]
