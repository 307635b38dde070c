"""Recorded or designed commands sailed open loop, written as a dataset."""

from collections.abc import Sequence
from pathlib import Path

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, append_runs, dataset_beside, read_run
from swamp_rl.runs.schema import meta_of
from swamp_rl.simulator.replay import replay, sample_step

NOTES = "Commands of other runs executed by swamp_rl on its own simulator; no measured data."
RATE_TOLERANCE = 1e-3  # of a sample step, by which the steps of several runs may differ


def record_commands(out: Path | str, boat_name: str, files: Sequence[Path]) -> list[Run]:
    """Sail the commands of each run's file (.csv, .parquet) from its first state with the boat of that name
    or file, and write the runs as the dataset `out`.

    UserError for a file that is no run of this boat's thrusters, files of different sample rates, or a folder
    that holds something else.
    """
    boat = load_boat(boat_name)
    read = [read_run(path) for path in files]
    steps = [sample_step(run) for run in read]
    for path, step in zip(files, steps, strict=True):
        if abs(step / steps[0] - 1.0) > RATE_TOLERANCE:
            raise UserError(
                f"{path}: a row every {step:g} s, in {files[0]} every {steps[0]:g} s; execute them separately"
            )
    sailed = [replay(boat, run) for run in read]
    meta = meta_of(boat, boat_name, round(1.0 / steps[0], 9), "simulated", notes=NOTES)
    with dataset_beside(out, meta) as part:
        append_runs(part, sailed)
    return sailed
