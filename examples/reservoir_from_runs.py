"""Train a reservoir computer from ten scripted runs and drive 100 new episodes with it.

Records the runs, fits the readout by ridge regression, stores the pilot and loads it again. Prints what was
recorded and the pilot's success with its Wilson 95 % interval.
"""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.hindsight import with_gates

from swamp_rl import load_pilot, read_runs
from swamp_rl.evaluation import drive, wilson
from swamp_rl.pilots import save_pilot
from swamp_rl.pilots.record import record_scripted
from swamp_rl.pilots.reservoir import ReservoirSettings, fit_reservoir


def boats(n: int, senses: Sequence[str]) -> GatesVectorEnv:
    """n boats among the disturbances of `standard`."""
    return GatesVectorEnv(n, disturbances="standard", observation=senses)


with TemporaryDirectory() as folder:
    runs = Path(folder, "runs")
    record_scripted(boats, runs, boat="swamp", course="camogli", count=10, failed=0, seed=0)
    dataset = read_runs(runs)
    good = [with_gates(run, dataset.course) for run in dataset.successful]
    print(f"learns from {len(good)} successful runs, {sum(run.duration for run in good):.0f} s in all")

    save_pilot(fit_reservoir(good, ReservoirSettings(units=200, seed=1)), Path(folder, "pilot"))
    pilot = load_pilot(Path(folder, "pilot"))

rollout = drive(pilot, boats, seeds=np.arange(1000, 1100))
passed = int((rollout.outcome == "success").sum())
rate = wilson(passed, len(rollout.seeds))
print(f"reservoir: {rate.value:.0%} of {rate.n} episodes, 95 % interval {rate.low:.0%} to {rate.high:.0%}")
