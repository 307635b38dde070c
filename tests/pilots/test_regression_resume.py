"""A training of a clone that was broken off goes on from its checkpoint and ends as an unbroken one does."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.gru import GRUSettings, fit_gru
from tests.support import forks
from tests.support.killed import KilledError, assert_same_weights, killed_training
from tests.support.killed_clones import trained
from tests.support.steering_runs import RUNS

pytestmark = pytest.mark.slow

POSE = ("north", "east", "cos_heading", "sin_heading")
KINDS: dict[str, tuple[Callable[..., Any], Any]] = {
    "cloning": (fit_cloning, CloningSettings(senses=POSE, epochs=6, noise=0.05, seed=3)),
    "gru": (fit_gru, GRUSettings(senses=POSE, epochs=6, noise=0.05, units=6, seed=3)),
}


def broken_off(kind: str, after: int, checkpoint: Path) -> list[float]:
    """Train until `after` epochs more are done; what `tick` heard."""
    fit, settings = KINDS[kind]
    heard: list[float] = []

    def tick(done: float) -> None:
        heard.append(done)
        if len(heard) == after:
            raise KilledError

    with pytest.raises(KilledError):
        fit(RUNS, settings, tick, checkpoint)
    return heard


@pytest.mark.parametrize("kind", KINDS)
def test_broken_off_twice_it_ends_with_the_same_weights_bit_for_bit(kind: str, tmp_path: Path) -> None:
    fit, settings = KINDS[kind]
    checkpoint = tmp_path / "training.safetensors"
    assert broken_off(kind, 2, checkpoint) == pytest.approx([1 / 6, 2 / 6])
    assert broken_off(kind, 3, checkpoint) == pytest.approx([3 / 6, 4 / 6, 5 / 6])
    assert_same_weights(fit(RUNS, settings), fit(RUNS, settings, checkpoint=checkpoint))
    assert [path.name for path in tmp_path.iterdir()] == [checkpoint.name]


@pytest.mark.parametrize("kind", KINDS)
def test_a_later_life_tells_the_losses_of_every_epoch_as_an_unbroken_one_does(
    kind: str, tmp_path: Path
) -> None:
    fit, settings = KINDS[kind]
    broken_off(kind, 4, tmp_path / "training.safetensors")
    lives: list[list[tuple[int, float]]] = []
    for checkpoint in (tmp_path / "training.safetensors", None):
        lives.append(points := [])
        fit(
            RUNS,
            settings,
            checkpoint=checkpoint,
            log=lambda epoch, values: points.append((epoch, values["loss"])),
        )
    assert lives[0] == lives[1]
    assert [epoch for epoch, _ in lives[0]] == [1, 2, 3, 4, 5, 6]
    assert 0.0 < lives[0][-1][1] < lives[0][0][1]


@pytest.mark.parametrize("change", ["settings", "runs"])
def test_a_checkpoint_of_another_training_is_not_gone_on_from(change: str, tmp_path: Path) -> None:
    fit, settings = KINDS["cloning"]
    broken_off("cloning", 4, tmp_path / "training.safetensors")
    runs = RUNS[:-1] if change == "runs" else RUNS
    if change == "settings":
        settings = settings.model_copy(update={"learning_rate": 1e-3})
    found = fit(runs, settings, checkpoint=tmp_path / "training.safetensors")
    assert_same_weights(fit(runs, settings), found)


def test_a_damaged_checkpoint_is_reported_in_one_line(tmp_path: Path) -> None:
    checkpoint = tmp_path / "training.safetensors"
    broken_off("cloning", 2, checkpoint)
    checkpoint.write_bytes(checkpoint.read_bytes()[:200])
    with pytest.raises(UserError, match=r"training.safetensors: .*is damaged") as error:
        broken_off("cloning", 1, checkpoint)
    assert "\n" not in str(error.value)


@forks.GROUP
@pytest.mark.timed
def test_killed_at_random_instants_it_ends_with_the_same_bits(tmp_path: Path) -> None:
    kills, resumed = killed_training("clones", tmp_path)
    assert kills >= 3
    assert_same_weights(trained(None), resumed)
