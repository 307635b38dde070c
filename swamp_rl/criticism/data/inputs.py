"""What a boat file is compared with or fitted to: folders of runs of one boat, and runs held out."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.counted import few
from swamp_rl.criticism.data.checks import dataset_names, refuse_other_vehicle
from swamp_rl.criticism.data.consistency import refuse_inconsistent
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet, read_run_set
from swamp_rl.errors import UserError
from swamp_rl.runs.dataset import Dataset, as_on_disk, own_boat
from swamp_rl.runs.same_run import same_runs

Array = NDArray[np.float64]
Named = Dataset | Path | str


@dataclass(frozen=True)
class Inputs:
    """folders: of the runs; boat: name or file; holdout: folder of the runs held out, None for none."""

    folders: tuple[Path, ...]
    boat: str | Path
    holdout: Path | None

    @property
    def label(self) -> str:
        """The folders as they were given, for messages."""
        return few([str(one) for one in self.folders])

    @property
    def names(self) -> str:
        """The names of the folders."""
        return ", ".join(one or "runs" for one in dataset_names(self.folders))


def inputs_of(dataset: Named | Sequence[Named], boat: str | Path | None, holdout: Named | None) -> Inputs:
    """What is given, as it is on the disk; boat: None for that of the (first) dataset."""
    given = [dataset] if isinstance(dataset, Named) else list(dataset)
    folders = tuple(as_on_disk(one) for one in given)
    boat = boat or (given[0].boat_file if isinstance(given[0], Dataset) else own_boat(folders[0]))
    return Inputs(folders, boat, None if holdout is None else as_on_disk(holdout))


def read_inputs(inputs: Inputs, boat: Boat, ignore: Sequence[str]) -> tuple[RunSet, RunSet | None]:
    """The runs, and those held out or None; boat: as loaded; ignore: as `read_run_set` takes it.

    UserError where they do not allow a fit.
    """
    if inputs.holdout is not None:
        for one in inputs.folders:
            refuse_other_vehicle(one, inputs.holdout)
    run_set = read_run_set(inputs.folders, boat, inputs.boat, ignore)
    refuse_inconsistent(run_set, inputs.label)
    if len(inputs.folders) > 1 and (both := same_runs(_columns(run_set))):
        first, second = (run_set.names[i] for i in both[0])
        raise UserError(
            f"{inputs.label}: {first} and {second} are the same run; leave one of the two folders or runs out"
        )
    if inputs.holdout is None:
        return run_set, None
    other = read_run_set(inputs.holdout, boat, inputs.boat, ignore)
    refuse_inconsistent(other, str(inputs.holdout))
    if both := same_runs(_columns(other), _columns(run_set)):
        held, fitted = both[0]
        raise UserError(
            f"{inputs.holdout}: run {other.names[held]} is run {run_set.names[fitted]} of {inputs.label}, it "
            "would be held out and fitted to; leave --holdout out, runs of the dataset are then held out, or "
            "name a folder of other runs"
        )
    return run_set, other


def _columns(run_set: RunSet) -> list[dict[str, Array]]:
    """Of each run the measured channels and the commands (T,)."""
    found = []
    for measured, commands, length in zip(run_set.measured, run_set.commands, run_set.lengths, strict=True):
        columns = {name: measured[:length, i] for i, name in enumerate(CHANNELS)}
        found.append(columns | {f"command {k}": row for k, row in enumerate(commands[:length].T)})
    return found
