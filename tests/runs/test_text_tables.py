"""Tables in text of other programs: their suffixes, what separates their cells, and their first line."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.runs import read_dataset
from swamp_rl.runs.import_dataset import import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.kind_of_file import kind_of
from swamp_rl.runs.table import read_table
from tests.support.runs import circling

NAMES = ("time", "north", "east", "heading")


def table(separator: str, mark: str = "", decimal: str = ".", indent: str = "") -> str:
    columns = circling()
    rows = zip(*(columns[name].tolist() for name in NAMES), strict=True)
    lines = [separator.join(repr(value).replace(".", decimal) for value in row) for row in rows]
    return mark + "".join(f"{indent}{line}\n" for line in (separator.join(NAMES), *lines))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("log.tsv", table("\t")),
        ("log.txt", table("\t", decimal=",")),
        ("log.txt", table(";", decimal=",")),
        ("log.txt", table(" ")),
        ("log.csv", table("   ", indent="  ")),
        ("log.dat", table(" ", decimal=",").replace("\n", "\r\n")),
        ("log.csv", table(",").replace("\n", "\r\r\n")),
        ("log.txt", table(";", decimal=",").replace("\n", "\r\r\n")),
        ("log.txt", table(" ").replace("\n", "\r\r\n")),
        ("log.dat", table(" ", mark="# ")),
        ("log.log", table(",", mark="%")),
        ("log.csv", table(", ")),
        ("log.csv", table(" ; ", decimal=",").replace("north", '"north"')),
        ("log.LOG", table(",", mark="\ufeff# ")),
    ],
)
def test_a_table_in_text_is_read_whatever_its_suffix_and_separator(
    tmp_path: Path, name: str, text: str
) -> None:
    path = tmp_path / name
    path.write_bytes(text.encode())
    assert kind_of([path]) == "csv"
    import_runs([path], "csv", tmp_path / "out")
    (run,) = read_dataset(tmp_path / "out").runs
    for column in NAMES:
        np.testing.assert_array_equal(run.columns[column], circling()[column])


@pytest.mark.parametrize("first", ["0.0,1.0,2.0", "0 1.5 2", "1e3\t2\t3", "nan;1;2"])
def test_a_first_line_of_numbers_is_not_taken_for_names(tmp_path: Path, first: str) -> None:
    path = tmp_path / "log.csv"
    path.write_text(f"{first}\n{first}\n")
    (fault,) = read_table(path).faults
    assert "its first line holds numbers; the first line must name the columns" in str(fault)


@pytest.mark.parametrize("between", ["\t", " ", "   ", ",", ", "])
def test_a_title_above_a_table_is_not_taken_for_its_only_column(tmp_path: Path, between: str) -> None:
    path = tmp_path / "log.dat"
    rows = [between.join(["0.0", "1.5", "2e-1"]), between.join(["0.1", "1.6", "2e-1"])]
    path.write_text("\n".join(["Zig-zag test of a tanker", "", *rows]) + "\n")
    (fault,) = read_table(path).faults
    message = (
        "its first line names 1 column, line 3 has 3 values; the first line must name the columns, remove"
    )
    assert message in str(fault)


def test_whole_numbers_may_be_names(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("0,1,2\n5,6,7\n")
    assert list(read_table(path).columns) == ["0", "1", "2"]


@pytest.mark.parametrize(
    ("name", "text", "part"),
    [
        (
            "log.txt",
            "$GPGGA,022718.80,2234.0,N,11431.9,E\n$GPGGA,022719.80,2234.0,N,11431.9,E\n",
            "is not read; it holds NMEA sentences; convert it to CSV",
        ),
        ("log.txt", "Lake test\nt x y\n0 1 2\n", "give --from"),
        (
            "log.txt",
            "START OF TEST\nax, ay, yaw, throttle\n0.1,0.2,284.8,1500\n",
            "its first line names 1 column, line 3 has 4 values; .* remove what stands before it; .* --from",
        ),
        ("log.log", "", "give --from"),
        (
            "1.log",
            "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nATT, 101, 0,0,0,0,12.3\n",
            "is not read; it is a DataFlash log converted to text; import the autopilot's .bin log",
        ),
        ("log.txt", "t,°\n0,1\n", "give --from"),
        ("day.xlsx", "PK", "is not read; save the sheet as CSV"),
        ("day.csv.gz", "", "is not read; unpack it"),
        ("day.npz", "PK", "is not read; write its columns to a CSV or Parquet file"),
        ("day.tlog", "", "is not read; import the autopilot's .bin log"),
    ],
)
def test_another_file_is_refused_with_what_to_do(tmp_path: Path, name: str, text: str, part: str) -> None:
    path = tmp_path / name
    path.write_bytes(text.encode("cp1252"))
    with pytest.raises(UserError, match=f"{name}: .*{part}") as error:
        kind_of([path])
    assert len(str(error.value).splitlines()) == 1


def test_a_name_that_no_run_may_have_is_refused_with_the_option_that_leaves_it_out(tmp_path: Path) -> None:
    rows = ["time,north,east,heading,-rudder", "0.0,0.0,0.0,0.0,1.0", "0.1,0.1,0.0,0.0,1.0"]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    with pytest.raises(UserError, match=r"column -rudder: is not a column name: .* \(--drop -rudder\)"):
        import_runs([tmp_path / "log.csv"], "csv", tmp_path / "out")
    import_runs([tmp_path / "log.csv"], "csv", tmp_path / "out", wishes=Wishes(dropped=("-rudder",)))
    assert "-rudder" not in read_dataset(tmp_path / "out").runs[0].columns
