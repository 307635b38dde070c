"""Reconstructed commands in place of an effect: what they have to explain."""

from types import SimpleNamespace
from typing import Any

import pytest

from swamp_rl.criticism.selection.command_reconstruction import is_simpler
from swamp_rl.criticism.selection.continuation import LAST, MIDDLE


def selection(stage: int, criterion: float, effects: int) -> Any:
    """An adequate selection on windows of a stage, of so many effects."""
    winner = SimpleNamespace(hypothesis=SimpleNamespace(instances=("effect",) * effects), criterion=criterion)
    return SimpleNamespace(winner=winner, adequate=True, stage=stage)


def continuation(cost: float) -> Any:
    """Fits whose criterion is the same at any stage, beside commands of that cost."""
    return SimpleNamespace(
        at=lambda stage, fit: fit,
        criterion=lambda fit: fit.criterion,
        run_set=SimpleNamespace(instants_cost=cost),
    )


@pytest.mark.parametrize(("reached", "replaced"), [(MIDDLE, False), (LAST, True)])
def test_commands_replace_an_effect_that_explains_whole_runs_only_where_they_do_too(
    reached: int, replaced: bool
) -> None:
    effect, commands = selection(LAST, 1000.0, effects=1), selection(reached, 500.0, effects=0)
    assert is_simpler(continuation(0.0), effect, continuation(250.0), commands) == replaced
