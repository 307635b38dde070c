"""From a dataset of ours to the formats of others, whole or not at all."""

from dataclasses import replace
from pathlib import Path
from typing import Literal, get_args

from swamp_rl.errors import UserError
from swamp_rl.names import file_in
from swamp_rl.runs.copies import standing_alone
from swamp_rl.runs.dataset import read_dataset
from swamp_rl.runs.export_lerobot import write_lerobot
from swamp_rl.runs.export_minari import write_minari
from swamp_rl.runs.mcap_files import write_mcap
from swamp_rl.runs.writer import append_runs, create_dataset
from swamp_rl.sums import write_sums
from swamp_rl.unfinished import folder_beside

Format = Literal["minari", "lerobot", "mcap", "csv", "parquet"]


def export_runs(source: Path | str, to: Format, out: Path | str, boat: str | None = None) -> int:
    """Write the dataset `source` in another format into the new folder `out`, with the SHA-256 of each of its
    files; how many runs there were.

    boat: whose runs they are, where `source` has no dataset.yaml to say it. The files of boat and course go
    along. UserError for a faulty dataset, one that the format cannot hold, or an `out` that is there already.
    """
    if to not in get_args(Format):
        raise UserError(f"--to {to}: is none of {', '.join(get_args(Format))}")
    out = Path(out)
    if out.exists():
        raise UserError(f"{out}: already exists; runs are exported into a new folder, name another")
    dataset = read_dataset(source, boat)
    meta, copies = standing_alone(dataset.meta, dataset.boat_file, dataset.course_file)
    dataset = replace(dataset, meta=meta)
    with folder_beside(out) as part:
        if to == "minari":
            write_minari(dataset, part, out.resolve().name, copies)
        elif to == "lerobot":
            write_lerobot(dataset, part, copies)
        elif to == "mcap":
            for run in dataset.runs:
                write_mcap(file_in(part, f"{run.name}.mcap", (".mcap",)), run, meta, copies)
        else:
            create_dataset(part, meta, dataset.boat_file, dataset.course_file)
            append_runs(part, dataset.runs, to)
        write_sums(part)
    return len(dataset.runs)
