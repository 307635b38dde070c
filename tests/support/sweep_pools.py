"""A pool that works in this process, and what a sweep by it gives."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.sweep.report import results
from swamp_rl.experiments.sweep.run import carry_on
from swamp_rl.experiments.sweep.schema import Sweep
from swamp_rl.experiments.sweep.store import Trial, opened

from swamp_rl.workers.attempt import attempt


class PoolHere:
    """Does the trials in this process, in an order drawn from a seed."""

    def __init__(self, work: Callable[[str], str], size: int, seed: int) -> None:
        self.work, self.size, self.rng = work, size, np.random.default_rng(seed)
        self.given: dict[int, str] = {}

    def submit(self, number: int, job: str) -> None:
        self.given[number] = job
        assert len(self.given) <= self.size

    def wait(self) -> tuple[int, str | None, str]:
        number = int(self.rng.choice(list(self.given)))
        return number, *attempt(self.work, self.given.pop(number))


class KilledError(Exception):
    """What ends a sweep between two trials."""


def swept(
    folder: Path, sweep: Sweep, pool: Any, job: Callable[..., str] = json.dumps, stop_after: int = 10**6
) -> dict[int, Trial]:
    """The trials of a sweep, gone on with after every `stop_after`."""
    while True:
        heard: list[Trial] = []

        def tell(trial: Trial, total: int, heard: list[Trial] = heard) -> None:
            heard.append(trial)
            if len(heard) == stop_after:
                raise KilledError

        with opened(folder, sweep.model_dump(mode="json")) as store:
            try:
                carry_on(sweep, store, pool, job, tell)
            except KilledError:
                pool.given.clear()
                continue
            return store.trials()


def summary_of(sweep: Sweep, trials: dict[int, Trial]) -> dict[str, Any]:
    """All that is to be the same."""
    return results(sweep, [], trials) | {"measured": None}
