"""What tests of sweeps try in place of a training: a formula, and ways to fail."""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from swamp_rl.experiments.sweep.run import carry_on
from swamp_rl.experiments.sweep.schema import Sweep
from swamp_rl.experiments.sweep.store import opened

from swamp_rl.workers.processes import ProcessPool

FORMULA: dict[str, Any] = {
    "name": "formula",
    "experiment": "smoke",
    "parameters": {"a": {"grid": [0, 1, 2]}, "b": {"grid": [0.0, 0.5, 1.0]}},
    "objective": {"pilot": "reservoir", "level": "calm"},
}
DRAWN: dict[str, Any] = {
    "parameters": {
        "a": {"uniform": [-1.0, 2.0]},
        "b": {"log_uniform": [0.01, 10.0]},
        "c": {"choice": [[1, 2], [3, 4], "none"]},
        "d": {"integers": [1, 9]},
    },
    "trials": 18,
    "batch": 3,
    "seed": 7,
}


def sweep_of(**changes: Any) -> Sweep:
    """The grid of the formula, with other keys."""
    return Sweep.model_validate(FORMULA | changes)


def formula(job: str) -> str:
    """A value that depends on the parameters alone, with an interval around it."""
    values = json.loads(job)
    value = 1.0 / (1.0 + (values["a"] - 1.0) ** 2 + (values["b"] - 0.5) ** 2)
    ends = [value - 0.1, value + 0.1]
    return json.dumps({"value": value, "summary": {"success_rate": value, "wilson_95": ends}})


def seldom_is_cheap(job: str) -> str:
    """The success of a from -1 to 2, and a cost that is the lower the less it succeeds."""
    success = (json.loads(job)["a"] + 1.0) / 3.0
    return json.dumps({"value": 10.0 * success, "summary": {"success_rate": success}})


def slow_formula(job: str) -> str:
    """Some time in coming."""
    time.sleep(0.2)
    return formula(job)


def first_time_fails(job: str) -> str:
    """Where the job's folder holds no note of an earlier attempt it leaves one, and fails or dies."""
    values = json.loads(job)
    note = Path(values["notes"]) / f"{values['a']}-{values['b']}"
    if not note.exists():
        note.write_text("tried")
        if values["dies"]:
            os._exit(9)
        raise ValueError("the first time\nfails")
    return formula(job)


def stuck_on_the_doomed_node(job: str) -> str:
    """On the node `doomed` it leaves a note that it is there, and never ends."""
    import ray

    values = json.loads(job)
    if ray.get_runtime_context().get_node_id() == values["doomed"]:
        Path(values["note"]).write_text("here")
        time.sleep(3600.0)
    return formula(job)


def always_fails(job: str) -> str:
    """For a == 1."""
    if json.loads(job)["a"] == 1:
        raise ValueError("never works")
    return formula(job)


def main() -> None:
    """Go on with the sweep of the formula in a folder, by two processes; tells the trials that end."""
    sweep = sweep_of()
    with (
        opened(Path(sys.argv[1]), sweep.model_dump(mode="json")) as store,
        ProcessPool(slow_formula, 2) as pool,
    ):
        carry_on(sweep, store, pool, json.dumps, lambda trial, total: print(trial.number, flush=True))


if __name__ == "__main__":
    main()
