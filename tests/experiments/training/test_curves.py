"""Logged learning curves are read strictly and drawn with their band."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.reports.figures import learning_curves
from swamp_rl.experiments.training.curves import quantity_of, read_curve, write_curve

from swamp_rl.errors import UserError


def test_a_logged_curve_is_read_as_steps_and_success(tmp_path: Path) -> None:
    file = tmp_path / "curve.jsonl"
    file.write_text('{"step": 0, "success": 0.0}\n{"step": 500, "success": 0.25, "reward": -3}\n')
    steps, success = read_curve(file)
    assert (steps.tolist(), success.tolist()) == ([0.0, 500.0], [0.0, 0.25])


def test_a_curve_of_losses_is_read_as_such(tmp_path: Path) -> None:
    points = [{"step": 1, "loss": 1.5}, {"step": 2, "loss": 0.25}]
    write_curve(tmp_path / "curve.jsonl", points)
    assert quantity_of(points) == "loss" and quantity_of([]) is None
    assert quantity_of([{"step": 1, "loss": 1.5, "success": 0.5}]) == "success"
    assert quantity_of([{"step": 0, "runs": 10}]) is None
    steps, loss = read_curve(tmp_path / "curve.jsonl", "loss")
    assert (steps.tolist(), loss.tolist()) == ([1.0, 2.0], [1.5, 0.25])
    with pytest.raises(UserError, match="line 1: must hold the numbers step and success"):
        read_curve(tmp_path / "curve.jsonl")
    (tmp_path / "curve.jsonl").write_text('{"step": 1, "loss": Infinity}\n')
    with pytest.raises(UserError, match="finite and at least 0"):
        read_curve(tmp_path / "curve.jsonl", "loss")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "holds no point"),
        ('{"step": 1}\n', "line 1: must hold"),
        ('{"step": 1, "success": 2}\n', "within 0 and 1"),
        ('{"step": 1, "success": NaN}\n', "within 0 and 1"),
        ('{"step": 5, "success": 0}\n{"step": 5, "success": 0}\n', "line 2: step 5 does not follow 5"),
        ('{"step": 1, "success": 0}\n{"st', "line 2"),
    ],
)
def test_a_curve_that_is_no_curve_is_refused_by_its_line(tmp_path: Path, text: str, told: str) -> None:
    file = tmp_path / "curve.jsonl"
    file.write_text(text)
    with pytest.raises(UserError, match=told):
        read_curve(file)


def test_learning_curves_of_ten_seeds_are_drawn_and_the_same_each_time(tmp_path: Path) -> None:
    steps, rng = np.arange(0.0, 6.0), np.random.default_rng(0)
    ten = [(steps, np.clip(steps / 5 + 0.1 * rng.normal(size=6), 0, 1)) for _ in range(10)]
    for name in ("a.png", "b.png"):
        learning_curves(tmp_path / name, {"ppo": ten, "sac": ten[:1]}, "Success while learning")
    first, second = ((tmp_path / name).read_bytes() for name in ("a.png", "b.png"))
    assert first == second and first.startswith(b"\x89PNG")


def test_seeds_without_common_steps_are_told_by_name(tmp_path: Path) -> None:
    early, late = (np.array([0.0, 1.0]), np.zeros(2)), (np.array([5.0, 6.0]), np.zeros(2))
    with pytest.raises(UserError, match=r"ppo: .*in common"):
        learning_curves(tmp_path / "x.png", {"ppo": [early, late]}, "")
    assert not (tmp_path / "x.png").exists()


def test_a_curve_that_was_written_is_read_again(tmp_path: Path) -> None:
    points = [{"step": 100, "success": 0.25, "return": -1.5}, {"step": 300, "success": 0.5, "seconds": 2.0}]
    write_curve(tmp_path / "curve.jsonl", points)
    steps, success = read_curve(tmp_path / "curve.jsonl")
    assert steps.tolist() == [100.0, 300.0] and success.tolist() == [0.25, 0.5]
