"""A DAgger that was broken off goes on from its last round and ends as an unbroken one does, bit for bit."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots.dagger import DaggerSettings
from swamp_rl.pilots.dagger_checkpoint import load_rounds
from tests.support import forks
from tests.support.killed import KilledError, assert_same_weights, killed_training
from tests.support.killed_dagger import trained

pytestmark = pytest.mark.slow

LEARNERS = {
    "reservoir": {"kind": "reservoir", "units": 40},
    "gru": {"kind": "gru", "epochs": 2, "units": 6},
}


def settings_of(kind: str) -> DaggerSettings:
    """Few rounds of a small learner."""
    return DaggerSettings.model_validate(
        {"learner": LEARNERS[kind], "rounds": 2, "runs": 1, "trials": 6, "seed": 4}
    )


def broken_off(checkpoint: Path, settings: DaggerSettings, after: int) -> None:
    """Rounds until number `after` has been logged."""

    def hear(number: int, values: Mapping[str, float]) -> None:
        if number == after:
            raise KilledError

    with pytest.raises(KilledError):
        trained(checkpoint, settings, hear)


@pytest.mark.parametrize("kind", LEARNERS)
def test_broken_off_after_any_round_it_ends_with_the_same_bits_and_tells_every_round(
    kind: str, tmp_path: Path
) -> None:
    settings, checkpoint = settings_of(kind), tmp_path / "checkpoint"
    entries: list[list[tuple[int, dict[str, float]]]] = [[], []]
    for after in (0, 1, 2):
        broken_off(checkpoint, settings, after)
    resumed = trained(checkpoint, settings, lambda *point: entries[0].append((point[0], dict(point[1]))))
    unbroken = trained(None, settings, lambda *point: entries[1].append((point[0], dict(point[1]))))
    assert_same_weights(unbroken, resumed)
    assert entries[0] == entries[1]
    assert [path.name for path in tmp_path.iterdir()] == ["checkpoint"]


@forks.GROUP
@pytest.mark.timed
def test_killed_at_random_instants_it_ends_with_the_same_bits(tmp_path: Path) -> None:
    kills, resumed = killed_training("dagger", tmp_path)
    assert kills >= 3
    assert_same_weights(trained(None), resumed)


def test_a_checkpoint_of_other_settings_is_not_gone_on_from(tmp_path: Path) -> None:
    checkpoint = tmp_path / "checkpoint"
    settings = settings_of("reservoir")
    broken_off(checkpoint, settings, 1)
    other = settings.model_copy(update={"seed": 5})
    anew = trained(None, other)
    assert_same_weights(anew, trained(checkpoint, other))
    assert (anew.weights()["W"] != trained(None, settings).weights()["W"]).any()


@pytest.mark.parametrize("kept", [0, 200, -1])
def test_a_damaged_checkpoint_is_reported_in_one_line(kept: int, tmp_path: Path) -> None:
    checkpoint = tmp_path / "checkpoint"
    broken_off(checkpoint, settings_of("reservoir"), 0)
    checkpoint.write_bytes(checkpoint.read_bytes()[:kept])
    with pytest.raises(UserError, match=r"checkpoint: .*is damaged") as error:
        load_rounds(checkpoint, "any")
    assert "\n" not in str(error.value)
