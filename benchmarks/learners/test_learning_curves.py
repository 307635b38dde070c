"""Learning curves are drawn with their band."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.learners.learning_curves import learning_curves
from swamp_rl.errors import UserError


def test_learning_curves_of_ten_seeds_are_drawn_and_the_same_each_time(tmp_path: Path) -> None:
    steps, rng = np.arange(0.0, 6.0), np.random.default_rng(0)
    ten = [(steps, np.clip(steps / 5 + 0.1 * rng.normal(size=6), 0, 1)) for _ in range(10)]
    for name in ("a.png", "b.png"):
        learning_curves(tmp_path / name, {"ppo": ten, "sac": ten[:1]}, "Success while learning")
    first, second = ((tmp_path / name).read_bytes() for name in ("a.png", "b.png"))
    assert first == second and first.startswith(b"\x89PNG")


def test_seeds_without_common_steps_are_reported_by_name(tmp_path: Path) -> None:
    early, late = (np.array([0.0, 1.0]), np.zeros(2)), (np.array([5.0, 6.0]), np.zeros(2))
    with pytest.raises(UserError, match=r"ppo: .*in common"):
        learning_curves(tmp_path / "x.png", {"ppo": [early, late]}, "")
    assert not (tmp_path / "x.png").exists()
