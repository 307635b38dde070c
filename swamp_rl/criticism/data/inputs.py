"""What a boat file is compared with or fitted to: folders of runs of one boat, and runs held out."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.checks import dataset_name, refuse_other_vehicle
from swamp_rl.criticism.data.consistency import refuse_inconsistent
from swamp_rl.criticism.data.run_set import RunSet, read_run_set
from swamp_rl.runs.dataset import Dataset, as_on_disk, own_boat

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
        return ", ".join(map(str, self.folders))

    @property
    def names(self) -> str:
        """The names of the folders."""
        return ", ".join(dataset_name(one) or "runs" for one in self.folders)


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
    if inputs.holdout is None:
        return run_set, None
    other = read_run_set(inputs.holdout, boat, inputs.boat, ignore)
    refuse_inconsistent(other, str(inputs.holdout))
    return run_set, other
