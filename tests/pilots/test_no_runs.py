"""Learners from recorded runs that are given none."""

from collections.abc import Callable

import pytest

from swamp_rl.errors import UserError
from swamp_rl.pilots import Pilot
from swamp_rl.pilots.cloning import fit_cloning
from swamp_rl.pilots.gru import fit_gru
from swamp_rl.pilots.reservoir import fit_reservoir
from swamp_rl.runs import Run


@pytest.mark.parametrize("fit", [fit_cloning, fit_gru, fit_reservoir])
def test_a_fit_to_no_runs_is_told_as_such(fit: Callable[[list[Run]], Pilot]) -> None:
    with pytest.raises(UserError, match=r"^no runs were given to learn from; give one or more$"):
        fit([])
