"""Runs with a pilot aboard: what the person drove, for who learns from corrections (DAgger, Ross 2011)."""

from collections.abc import Sequence

import numpy as np

from swamp_rl.runs.run import Run

DRIVER = "driver"
"The column that tells who drove: 0 the person, 1 the pilot."


def corrected(runs: Sequence[Run]) -> list[Run]:
    """Those in which the person took the helm back from the pilot."""
    return [run for run in runs if (run.meta.model_extra or {}).get("corrections", 0)]


def persons_part(run: Run) -> list[Run]:
    """The stretches of two rows or more that the person drove, each a run named after its first row.

    Columns stay as they are: what hangs on the way before, such as the gates passed, must be there already. A
    run without a pilot aboard is the person's as a whole.
    """
    if DRIVER not in run.columns:
        return [run]
    at_helm = np.concatenate([[False], run.columns[DRIVER] == 0.0, [False]])
    turns = np.flatnonzero(np.diff(at_helm)).reshape(-1, 2).tolist()
    meta = run.meta.model_copy(update={"file": None, "rows": None, "initial_state": None})
    return [
        Run(f"{run.name}-row-{first}", {n: values[first:end] for n, values in run.columns.items()}, meta)
        for first, end in turns
        if end - first >= 2
    ]
