"""Recorded and simulated runs: read, checked, written, and never silently repaired."""

from swamp_rl.runs.dataset import (
    Dataset,
    check_dataset,
    inspect_dataset,
    read_dataset,
    read_run,
    refuse_faults,
)
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.helm import corrected, persons_part
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import DatasetMeta, RunMeta
from swamp_rl.runs.writer import adopt_run, append_run, append_runs, create_dataset, dataset_beside, write_run

__all__ = [
    "Dataset",
    "DatasetMeta",
    "Fault",
    "Run",
    "RunMeta",
    "adopt_run",
    "append_run",
    "append_runs",
    "check_dataset",
    "corrected",
    "create_dataset",
    "dataset_beside",
    "inspect_dataset",
    "persons_part",
    "read_dataset",
    "read_run",
    "refuse_faults",
    "write_run",
]
