"""Headings that an expression takes beyond a turn, as where it adds the declination to a compass."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.angles import wrapped
from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.bad_rows import BadRows
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from tests.support.logs import csv_of, weaving

POSITIONS = ["time=t", "north=n", "east=e"]
COMPASS = np.mod(np.degrees(weaving()["heading"]), 360.0)


def log_of(folder: Path, compass: np.ndarray) -> Path:
    """A log of a boat that passes north, with a compass in degrees and the variation there."""
    was = weaving()
    columns = {"t": was["time"], "n": was["north"], "e": was["east"], "compass": compass}
    columns |= {"hundredths": 100.0 * compass, "variation": np.full(len(compass), 4.0)}
    return csv_of(folder / "log.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()})


def imported(folder: Path, compass: np.ndarray, heading: str, bad_rows: BadRows = "refuse") -> list[Run]:
    reading = Reading(mapping_of([*POSITIONS, heading]))
    name = heading.partition("=")[0]
    units = {} if "radians" in heading else {name: "deg"}
    wishes = Wishes(units=units, bad_rows=bad_rows)
    import_logs([log_of(folder, compass)], "csv", folder / "out", About(), wishes, reading)
    return read_dataset(folder / "out").runs


@pytest.mark.parametrize(
    "heading",
    [
        "heading=compass + 4",
        "heading=radians(compass + 4)",
        "heading=compass + variation",
        "heading=hundredths / 100 + 4",
        "heading=where(t > 10, compass + 4, compass + 4)",
        "heading=364 - (360 - compass)",
        "yaw=compass + 4",
    ],
)
def test_a_declination_added_to_a_compass_gives_headings_within_their_range(
    tmp_path: Path, heading: str
) -> None:
    (run,) = imported(tmp_path, COMPASS, heading)
    expected = wrapped(weaving()["heading"] + np.radians(4.0))
    assert run.columns["heading"] == pytest.approx(expected, abs=1e-9)


def test_a_declination_is_added_where_tables_are_joined_too(tmp_path: Path) -> None:
    was = weaving()
    tables = {"gps": {"n": was["north"], "e": was["east"]}, "imu": {"compass": COMPASS}}
    paths = [
        csv_of(
            tmp_path / f"{name}.csv",
            {k: [repr(float(x)) for x in v] for k, v in ({"t": was["time"]} | columns).items()},
        )
        for name, columns in tables.items()
    ]
    mapping = mapping_of(["time=t", "north=gps.n", "east=gps.e", "heading=imu.compass + 4"])
    wishes = Wishes(units={"heading": "deg"})
    import_logs(paths, "csv", tmp_path / "out", About(), wishes, Reading(mapping, "trip"))
    (run,) = read_dataset(tmp_path / "out").runs
    expected = wrapped(was["heading"] + np.radians(4.0))
    assert run.columns["heading"] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("heading", ["heading=compass", "heading=compass + 4", "heading=radians(compass)"])
def test_a_compass_beyond_a_turn_is_a_bad_row_whatever_is_added(tmp_path: Path, heading: str) -> None:
    compass = COMPASS.copy()
    compass[100] = 655.35
    with pytest.raises(UserError, match=r"row 101 \(line 102\), column heading"):
        imported(tmp_path, compass, heading)
    runs = imported(tmp_path, compass, heading, "split")
    assert [len(run.time) for run in runs] == [100, 200]


def test_a_heading_in_degrees_beyond_a_turn_is_not_reported_as_one_in_degrees(tmp_path: Path) -> None:
    compass = COMPASS.copy()
    compass[100] = 364.0
    names = {"time": "t", "north": "n", "east": "e", "heading": "compass"}
    wishes = Wishes(names, {"heading": "deg"}, ("hundredths", "variation"))
    with pytest.raises(UserError) as error:
        import_runs([log_of(tmp_path, compass)], "csv", tmp_path / "out", None, wishes)
    assert "column heading: 364 deg is more than a turn; correct it or cut the row" in str(error.value)
    assert "looks like degrees" not in str(error.value)
