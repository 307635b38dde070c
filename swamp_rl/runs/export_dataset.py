"""From a dataset of ours to the formats of others, whole or not at all."""

from pathlib import Path
from typing import Literal, get_args

from swamp_rl.errors import UserError
from swamp_rl.runs.dataset import Dataset, read_dataset
from swamp_rl.runs.export_lerobot import write_lerobot
from swamp_rl.runs.export_minari import write_minari
from swamp_rl.runs.mcap_files import write_mcap
from swamp_rl.runs.writer import append_runs, create_dataset
from swamp_rl.unfinished import folder_beside

Format = Literal["minari", "lerobot", "mcap", "csv", "parquet"]


def export_runs(source: Path | str, to: Format, out: Path | str) -> int:
    """Write the dataset `source` in another format into the new folder `out`; how many runs there were.

    UserError for a faulty dataset, one that the format cannot hold, or an `out` that is there already.
    """
    if to not in get_args(Format):
        raise UserError(f"--to {to}: is none of {', '.join(get_args(Format))}")
    out = Path(out)
    if out.exists():
        raise UserError(f"{out}: already exists; runs are exported into a new folder, name another")
    dataset = read_dataset(source)
    with folder_beside(out) as part:
        if to == "minari":
            write_minari(dataset, part, out.resolve().name)
        elif to == "lerobot":
            write_lerobot(dataset, part)
        elif to == "mcap":
            for run in dataset.runs:
                write_mcap(part / f"{run.name}.mcap", run, dataset.meta)
        else:
            _write_tables(dataset, part, to)
    return len(dataset.runs)


def _write_tables(dataset: Dataset, folder: Path, to: Literal["csv", "parquet"]) -> None:
    """The same dataset with every run in one format, and the boat's own file with it."""
    boat = dataset.folder / dataset.meta.vehicle
    if boat.is_file():
        (folder / dataset.meta.vehicle).write_bytes(boat.read_bytes())
    create_dataset(folder, dataset.meta.model_copy(update={"runs": []}))
    append_runs(folder, dataset.runs, to)
