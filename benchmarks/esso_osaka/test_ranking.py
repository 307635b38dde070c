"""The candidates of the pond are ranked by their misfit as a number, not as text."""

from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks.esso_osaka import wind


def test_a_misfit_above_ten_ranks_last(monkeypatch: pytest.MonkeyPatch) -> None:
    misfits = {
        names: 10.5 if names == ("wind",) else 9.0 + 0.1 * i for i, names in enumerate(wind.CANDIDATES)
    }
    monkeypatch.setattr(wind, "misfit", lambda one, names: misfits[names])
    run: Any = SimpleNamespace(run=SimpleNamespace(name="random_06-Aug-2020"))
    rows = wind.ranking_table([run]).splitlines()[2:]
    assert rows[-1].startswith("| wind |") and len(rows) == len(wind.CANDIDATES)
