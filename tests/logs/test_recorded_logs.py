"""Logs that autopilots and robots recorded: imported whole, or refused in lines that say what to do."""

import os
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from tests.support.from_scratch import written

PLACE = "SWAMP_RL_LOGS"
KINDS = {".bin": "dataflash", ".ulg": "ulog", ".bag": "rosbag", ".mcap": "rosbag", ".db3": "rosbag"}
FOUND = sorted(p for p in Path(os.environ.get(PLACE, "/dev/null")).rglob("*") if p.suffix.lower() in KINDS)


@pytest.mark.skipif(
    not FOUND, reason=f"no recorded logs: put .bin, .ulg, .bag files in a folder named by {PLACE}"
)
@pytest.mark.parametrize("path", FOUND, ids=lambda path: path.name)
def test_a_recorded_log_becomes_runs_or_says_what_is_missing(tmp_path: Path, path: Path) -> None:
    boat = str(written(tmp_path, "twin"))
    try:
        import_logs(
            [path],
            KINDS[path.suffix.lower()],
            tmp_path / "out",
            About(boat=boat),
            Wishes(bad_rows="split"),
            Reading(mapping_of([])),
        )
    except UserError as error:
        assert "--list" in str(error) and not (tmp_path / "out").exists()
        return
    for run in read_dataset(tmp_path / "out").runs:
        assert np.isfinite(run.pose).all() and np.ptp(run.time) > 0.0
