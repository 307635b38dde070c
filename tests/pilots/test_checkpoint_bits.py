"""A flipped bit of a training's checkpoint is reported, and never trained on from in silence."""

import random
from collections.abc import Callable
from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.gru import GRUSettings, fit_gru
from swamp_rl.pilots.pilot import Pilot
from tests.support import killed_ppo, killed_sac
from tests.support.steering_runs import RUNS

pytestmark = pytest.mark.slow

FLIPS = 12
POSE = ("north", "east", "cos_heading", "sin_heading")
TRAININGS: dict[str, Callable[[Path], Pilot]] = {
    "ppo": killed_ppo.trained,
    "sac": killed_sac.trained,
    "cloning": lambda path: fit_cloning(RUNS, CloningSettings(senses=POSE, epochs=2), checkpoint=path),
    "gru": lambda path: fit_gru(RUNS, GRUSettings(senses=POSE, epochs=2, units=6), checkpoint=path),
}


@pytest.mark.parametrize("kind", TRAININGS)
def test_a_flipped_bit_of_a_checkpoint_is_refused(kind: str, tmp_path: Path) -> None:
    checkpoint, train, chance = tmp_path / "checkpoint", TRAININGS[kind], random.Random(1)
    train(checkpoint)
    good = checkpoint.read_bytes()
    header = 8 + int.from_bytes(good[:8], "little")
    # Of the length of the header, of the header, and of the numbers.
    spans = [(0, 8), (8, header), (header, len(good))]
    for first, last in spans * (FLIPS // len(spans)):
        flipped = bytearray(good)
        flipped[chance.randrange(first, last)] ^= 1 << chance.randrange(8)
        checkpoint.write_bytes(flipped)
        with pytest.raises(UserError, match=r"is damaged|carries no checksum"):
            train(checkpoint)
    checkpoint.write_bytes(good)
    train(checkpoint)
