"""A pilot that is to act earlier than its driver did is told so before it is trained."""

from dataclasses import replace

import numpy as np
import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene
from swamp_rl.experiments.training.reaction import reaction_warning

from swamp_rl.pilots.record import record_scripted
from swamp_rl.runs import Run, read_dataset


@pytest.fixture(scope="module")
def scene() -> Scene:
    return read_scene(load_experiment("camogli"))


@pytest.fixture(scope="module")
def runs(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> list[Run]:
    folder = tmp_path_factory.mktemp("scripted") / "runs"
    record_scripted(scene.boats_at("calm"), folder, boat="swamp", course="camogli", count=4, step=0.1)
    return read_dataset(folder).runs


def warned(scene: Scene, runs: list[Run], reaction: float, more: tuple[str, ...] = ()) -> str | None:
    plan = scene.experiment.pilots["cloning"]
    options = {"reaction": reaction, "senses": (*plan.options["senses"], *more)}
    later = plan.model_copy(update={"options": plan.options | options})
    return reaction_warning(scene, "clone", later, runs)


def steered(run: Run, rows: int) -> Run:
    """The run with levers that follow the boat's turning and heading, so many rows later."""
    seen = np.clip(np.sin(run.columns["heading"]) - 0.5 * run.columns["yaw_rate"], -1.0, 1.0)
    late = np.concatenate([np.full(rows, seen[0]), seen[: len(seen) - rows]])
    return replace(run, columns=run.columns | {"joy_angle": late, "joy_thrust": 0.5 * late})


@pytest.mark.parametrize("reaction", [0.0, 0.3, 0.4])
def test_a_reaction_like_that_of_the_scripted_driver_has_no_warning(
    scene: Scene, runs: list[Run], reaction: float
) -> None:
    assert warned(scene, runs, reaction) is None


def test_the_last_action_among_the_senses_makes_no_reaction_shorter(scene: Scene, runs: list[Run]) -> None:
    assert warned(scene, runs, 0.4, ("last_angle", "last_throttle")) is None


def test_levers_without_delay_are_reported_with_one_advice(scene: Scene, runs: list[Run]) -> None:
    line = warned(scene, [steered(run, 0) for run in runs], 0.8)
    assert line is not None and line.endswith("if it acts too early, set reaction to 0")


@pytest.mark.parametrize("rows", [0, 2])
def test_a_reaction_longer_than_the_drivers_is_reported_with_that_of_the_runs(
    scene: Scene, runs: list[Run], rows: int
) -> None:
    driven = [steered(run, rows) for run in runs]
    line = warned(scene, driven, 0.8)
    assert line is not None
    assert line.startswith(f"pilots.clone: the levers follow what the driver saw by about {0.1 * rows:.2g} s")
    assert "not by the reaction of 0.8 s" in line
    assert warned(scene, driven, 0.1 * rows) is None


def test_levers_that_never_move_say_nothing_of_a_reaction(scene: Scene, runs: list[Run]) -> None:
    still = [
        replace(
            run, columns=run.columns | dict.fromkeys(("joy_angle", "joy_thrust"), np.zeros(len(run.time)))
        )
        for run in runs
    ]
    assert warned(scene, still, 0.4) is None
