"""A researcher's own reward, observation and limits, from the YAML through training to the stored pilot."""

import hashlib
import json
import shutil
import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import yaml
from stable_baselines3 import A2C, PPO, SAC, TD3
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv
from swamp_rl.envs.single import GatesEnv
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.studies.run import run_experiment
from swamp_rl.experiments.studies.stored import evaluate_folders

from swamp_rl import own_code
from swamp_rl.errors import UserError
from swamp_rl.evaluation import read_episodes
from swamp_rl.export import write_onnx
from swamp_rl.pilots import own
from swamp_rl.pilots.arguments import Asked, asked_pilot, opened
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.store import load_pilot
from tests.support.own_pilots import own_pilot_module
from tests.support.random_pilots import network
from tests.support.tiny_experiment import write_tiny

OWN = """
import numpy as np

def near_buoy(batch):
    buoys = np.array([(buoy.north, buoy.east) for buoy in batch.course.buoys])
    away = np.linalg.norm(batch.pose[:, None, :2] - buoys, axis=-1).min(axis=-1)
    return np.maximum(2.0 - away, 0.0)

near_buoy.bounds = (0.0, 2.0)
"""
SENSES = [
    *("gate_ahead", "gate_starboard", "gate_cos", "gate_sin", "surge", "yaw_rate"),
    *("wind_ahead", "wind_starboard", "last_throttle", "last_angle", "their_terms:near_buoy"),
]
REWARD = {"time": 0.05, "their_terms:near_buoy": -0.5}


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with `their_terms.py`, on the path of a process that has named nothing."""
    (tmp_path / "their_terms.py").write_text(OWN)
    monkeypatch.syspath_prepend(str(tmp_path))
    forget(monkeypatch)
    return tmp_path


def forget(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a new process: no code has been named."""
    monkeypatch.setattr(own_code, "_modules", set())
    monkeypatch.setattr(own, "_named", {})
    for module in ("their_terms", "their_pilot"):
        sys.modules.pop(module, None)


def experiment(folder: Path, pilot: str = "ppo", senses: list[str] = SENSES, **keys: Any) -> Path:
    """The tiny experiment with one pilot, which has these senses."""
    file = write_tiny(folder, pilot)
    data = {**yaml.safe_load(file.read_text()), "reward": REWARD, "time_limit": 60.0, **keys}
    if "pilots" not in keys:
        data["pilots"][pilot].setdefault("options", {})["senses"] = senses
    data["evaluation"]["levels"] = ["standard"]
    file.write_text(yaml.safe_dump(data))
    return file


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_ppo_learns_from_own_terms_and_its_stored_copy_drives_the_same_episodes(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = run_experiment(experiment(place), out=place / "out")
    table = read_episodes(out / "episodes.parquet")["ppo", "standard"]
    kept = yaml.safe_load((out / "config" / "experiment.yaml").read_text())
    assert (kept["reward"]["time"], kept["reward"]["gate"], kept["time_limit"]) == (0.05, 1.0, 60.0)
    assert (table["time"][table["outcome"] == "timeout"] == 60.0).all() and table["time"].max() <= 60.0
    found = json.loads((out / "results.json").read_text())["pilots"]["ppo"]["levels"]["standard"]
    assert found["mean_return"] == pytest.approx(table["return"].mean())
    assert "## Return" in (out / "report.md").read_text()

    # The same pilot by hand, in the environment that gymnasium makes, collects the same return.
    pilot = load_pilot(out / "pilots" / "ppo")
    env = GatesEnv(observation=SENSES, reward=REWARD, time_limit=60.0, disturbances="standard")
    seen, _ = env.reset(seed=int(table["seed"][0]))
    pilot.reset(1)
    collected, over = 0.0, False
    while not over:
        seen, reward, terminated, truncated, _ = env.step(pilot.act(seen[None])[0])
        collected, over = collected + reward, terminated or truncated
    assert collected == pytest.approx(table["return"][0], rel=1e-12)

    forget(monkeypatch)
    for refused in (
        lambda: load_pilot(out / "pilots" / "ppo"),
        lambda: evaluate_folders([out], {}, out=place / "no"),
        lambda: evaluate_folders([out / "pilots" / "ppo"], {}, out=place / "no"),
        lambda: run_experiment(out, out=place / "no"),
    ):
        with pytest.raises(UserError, match="their_terms:near_buoy") as error:
            refused()
        assert "\n" not in str(error.value)
        assert "their_terms" not in sys.modules and not (place / "no").exists()
    again = evaluate_folders([f"their_terms:near_buoy={out}"], {"shown": 1}, out=place / "again")
    np.testing.assert_array_equal(
        read_episodes(again / "episodes.parquet")["ppo", "standard"]["return"], table["return"]
    )


def test_an_exported_pilot_that_observes_an_own_term_is_opened_by_the_argument_that_its_refusal_tells(
    place: Path,
) -> None:
    term, file, like = SENSES[-1], place / "pilot.onnx", network(np.random.default_rng(0))
    write_onnx(NetworkPilot(like.kind, (*like.senses[:-1], term), like.weights(), 1, 0), file)
    with pytest.raises(UserError, match=f"if it is yours, name it: {term}=onnx:FILE$"):
        opened(asked_pilot(f"onnx:{file}"))
    assert "their_terms" not in sys.modules
    assert opened(asked_pilot(f"{term}=onnx:{file}")).senses[-1] == term


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_models_that_stable_baselines3_trains_on_the_environment_are_evaluated_by_their_zips(
    place: Path,
) -> None:
    made: dict[str, Any] = {"observation": SENSES, "reward": REWARD, "time_limit": 30.0}
    plans, models = {}, {}
    for algorithm in (PPO, A2C, SAC, TD3):
        name = algorithm.__name__
        few = {"n_steps": 64} if algorithm in (PPO, A2C) else {"learning_starts": 16, "buffer_size": 100}
        env = gymnasium.make("swamp/Gates-v1", disturbances="standard", **made)
        models[name] = algorithm("MlpPolicy", env, seed=0, device="cpu", **few).learn(64)
        models[name].save(place / f"{name}.zip")
        plans[name] = {"kind": "sb3", "options": {"file": str(place / f"{name}.zip"), "senses": SENSES}}
    asked = experiment(place, pilots={"ppo": {"kind": "line-of-sight"}, **plans}, time_limit=30.0)
    out = run_experiment(asked, out=place / "o")
    tables = read_episodes(out / "episodes.parquet")
    for name, model in models.items():
        env = gymnasium.make("swamp/Gates-v1", disturbances="standard", **made)
        table = tables[name, "standard"]
        seen, _ = env.reset(seed=int(table["seed"][0]))
        collected, over = 0.0, False
        while not over:
            seen, reward, terminated, truncated, _ = env.step(model.predict(seen, deterministic=True)[0])
            collected, over = collected + float(reward), terminated or truncated
        assert collected == pytest.approx(table["return"][0], rel=1e-4), name


def with_own_pilot(folder: Path, throttle: float) -> Path:
    """The tiny experiment with an own reward term and an own pilot, which goes ahead at `throttle`."""
    (folder / "their_pilot.py").write_text(own_pilot_module(throttle))
    return experiment(folder, pilots={"ahead": {"kind": "their_pilot:Ahead"}})


@pytest.mark.usefixtures("no_figures")
def test_a_result_with_an_own_pilot_and_an_own_term_is_evaluated_where_both_are_named(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = run_experiment(with_own_pilot(place, 0.5), out=place / "out")
    forget(monkeypatch)
    with pytest.raises(UserError, match="their_terms:near_buoy"):
        evaluate_folders([f"their_pilot:Ahead={out}"], out=place / "no")
    named = [f"their_pilot:Ahead={out}", f"their_terms:near_buoy={out}"]
    again = evaluate_folders(named, {"seed": 9}, out=place / "again")
    assert list(json.loads((again / "results.json").read_text())["pilots"]) == ["ahead"]


@pytest.mark.usefixtures("no_figures")
def test_an_interrupted_run_does_not_resume_where_the_code_of_an_own_pilot_has_changed(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: Any) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
        patched.setattr("swamp_rl.experiments.studies.main.gather", stopped)
        run_experiment(with_own_pilot(place, 0.5), out=place / "out")
    with pytest.raises(UserError, match=r"unfinished work.*versions\.json: there '\"own code"):
        run_experiment(with_own_pilot(place, 0.25), out=place / "out")
    shutil.rmtree(place / ".part-out")
    out = run_experiment(with_own_pilot(place, 0.25), out=place / "out")
    held = json.loads((out / "versions.json").read_text())
    sources = {name: (place / f"{name}.py").read_bytes() for name in ("their_pilot", "their_terms")}
    assert {name: held[f"own code {name}"] for name in sources} == {
        name: hashlib.sha256(source).hexdigest() for name, source in sources.items()
    }


@pytest.mark.parametrize("algorithm", [PPO, A2C, SAC, TD3])
def test_stable_baselines3_learns_on_a_batch_with_own_terms_for_a_moment(place: Path, algorithm: Any) -> None:
    made: dict[str, Any] = {"observation": SENSES, "reward": REWARD, "time_limit": 2.0}
    boats = GatesVecEnv(GatesVectorEnv(4, autoreset_mode="SameStep", **made))
    few = {"n_steps": 32} if algorithm in (PPO, A2C) else {"learning_starts": 64, "buffer_size": 1000}
    model = algorithm("MlpPolicy", boats, seed=0, device="cpu", **few).learn(256)
    model.save(place / "model.zip")
    asked = opened(Asked("model", kind="sb3", options={"file": str(place / "model.zip"), "senses": SENSES}))
    seen = boats.reset()
    expected = model.predict(seen, deterministic=True)[0] * [0.5, 1.0] + [0.5, 0.0]
    np.testing.assert_allclose(asked.act(seen), expected, atol=1e-6)


def test_a_pilot_whose_term_cannot_be_imported_any_more_is_refused_in_one_line(place: Path) -> None:
    (place / "their_terms.py").unlink()
    with pytest.raises(UserError, match="their_terms:near_buoy: cannot be imported") as error:
        load_experiment(experiment(place))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("sense", ["wind_ahead", "time_left", "their_terms:near_buoy"])
@pytest.mark.parametrize("pilot", ["net", "reservoir"])
def test_who_learns_from_recorded_runs_can_sense_only_what_they_tell(
    place: Path, pilot: str, sense: str
) -> None:
    with pytest.raises(UserError, match=rf"pilots\.{pilot}\.options\.senses: the runs have no {sense}"):
        load_experiment(experiment(place, pilot, ["north", "east", sense]))


@pytest.mark.parametrize("pilot", ["net", "reservoir", "ppo"])
def test_a_misspelt_sense_is_answered_with_the_name_meant(place: Path, pilot: str) -> None:
    with pytest.raises(UserError, match=rf"pilots\.{pilot}\.options\.senses: .*did you mean 'gate_ahead'"):
        read_scene(load_experiment(experiment(place, pilot, ["gate_ahed", "yaw_rate"])))


def test_who_learns_from_runs_may_sense_the_last_action_as_the_environment_shows_it(place: Path) -> None:
    senses = ["gate_ahead", "gate_starboard", "last_throttle", "last_angle"]
    scene = read_scene(load_experiment(experiment(place, "net", senses)))
    from swamp_rl.envs.hindsight import with_gates

    from swamp_rl.pilots.demonstrations import observed
    from swamp_rl.pilots.record import drive_episodes
    from swamp_rl.pilots.scripted import ScriptedPilot

    pilot = ScriptedPilot(0)
    boats = scene.boats_at("standard")(2, pilot.senses)
    pilot.reset(2)
    run = drive_episodes(boats, pilot, scene.boat, np.array([5, 6]), 0.1)[0]
    env = GatesEnv(observation=senses, disturbances="standard")
    seen = [env.reset(seed=5)[0], *(env.step(levers)[0] for levers in run.joypad[:-1])]
    np.testing.assert_allclose(observed(with_gates(run, scene.course), senses), seen, atol=1e-5)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"reward": {"progres": 1.0}}, "reward: no term 'progres'; did you mean 'progress'"),
        ({"reward": {"gate": float("inf")}}, "reward"),
        ({"bounds": {"nroth": 40.0}}, "bounds"),
        ({"time_limit": 0.1}, "time_limit"),
    ],
)
def test_a_wrong_key_of_the_environment_is_one_line(place: Path, keys: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message) as error:
        read_scene(load_experiment(experiment(place, **keys)))
    assert "\n" not in str(error.value)
