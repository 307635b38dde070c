"""`runs import` and `runs export` from the command line: what they print, and one line for what is wrong."""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.cli import app as cli

from swamp_rl.evaluation import drive
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.replacement import WRITTEN
from swamp_rl.runs import read_dataset
from tests.support.binary_logs import bag
from tests.support.command_line import assert_complains
from tests.support.runs import circling

Called = tuple[int, str, str]


@pytest.fixture
def call(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Callable[..., Called]:
    monkeypatch.chdir(tmp_path)

    def called(*words: object) -> Called:
        monkeypatch.setattr(sys, "argv", ["swamp-rl", "runs", *map(str, words)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        message = capsys.readouterr()
        return int(stop.value.code or 0), message.out, message.err

    return called


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """The boat that circles, as others might have logged it."""
    columns = circling()
    lines = ["secs,x,y,psi,knots"]
    for row in zip(columns["time"], columns["north"], columns["east"], columns["heading"], strict=True):
        lines.append(",".join(repr(float(value)) for value in row) + ",1.0")
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


RENAMED = ["--column", "time=secs", "--column", "north=x", "--column", "east=y", "--column", "heading=psi"]

MAPPED = [word if word != "--column" else "--map" for word in RENAMED]


def test_a_log_becomes_a_dataset_and_goes_out_again(call: Callable[..., Called], log: Path) -> None:
    units = ["--column", "surge=knots", "--unit", "surge=kn"]
    code, message, _ = call(
        "import", log, "--from", "csv", "--out", "day", "--source", "human", *RENAMED, *units
    )
    without, counted = message.splitlines()
    assert (code, counted) == (0, "day: 1 run, 31 rows at 10 Hz, human")
    assert "no commands of boat swamp (azimuth_bs, " in without
    assert without.endswith("import with --column azimuth_bs=THEIRS")
    run = read_dataset("day").runs[0]
    assert run.columns["north"].tobytes() == circling()["north"].tobytes()
    assert run.columns["surge"][0] == pytest.approx(0.514444, abs=1e-6)
    assert call("check", "day")[0] == 0
    assert call("export", "day", "--to", "mcap", "--out", "bags") == (0, "bags: 1 run\n", "")
    assert sorted(path.name for path in Path("bags").iterdir()) == [WRITTEN, "SHA256SUMS", "log.mcap"]


def test_runs_that_lack_the_state_after_the_last_action_are_told(call: Callable[..., Called]) -> None:
    flown = drive(LineOfSightPilot(), lambda n, senses: GatesVectorEnv(n, observation=senses), np.arange(3))
    assert flown.outcome.tolist() == ["success"] * 3
    for i in range(3):
        poses = flown.track(i)[: -1 if i else None]  # of all but the first, as (observation, action) pairs
        rows = (f"{0.1 * t:.1f},{n!r},{e!r},{h!r}" for t, (n, e, h) in enumerate(poses.tolist()))
        Path(f"log{i}.csv").write_text("\n".join(["time,north,east,heading", *rows]) + "\n")
    code, message, _ = call("import", *sorted(Path().glob("*.csv")), "--course", "camogli", "--out", "day")
    assert code == 0 and [run.meta.outcome for run in read_dataset("day").runs] == [
        "success",
        "incomplete",
        "incomplete",
    ]
    assert "day: 2 of 3 runs end less than a step before the last gate of camogli" in message
    _, message, _ = call("import", "log0.csv", "--course", "camogli", "--out", "whole")
    assert "last gate" not in message


def test_all_that_is_missing_is_listed_a_line_each(call: Callable[..., Called], log: Path) -> None:
    code, _, message = call("import", log, "--from", "csv", "--out", "day", *RENAMED[:2])
    assert code == cli.BAD_INPUT
    lines = message.splitlines()
    assert [line.count("is missing") for line in lines] == [1, 1, 1]
    assert all(line.startswith("swamp-rl: ") for line in lines) and "nothing was imported" in lines[-1]
    log.with_name("other.csv").write_bytes(log.read_bytes())
    code, _, message = call("import", log, "other.csv", "--from", "csv", "--out", "day", *RENAMED[:2])
    assert message.count("log.csv and 1 other: column") == 3
    assert message.count("is missing") == 3 and message.count("nothing was imported") == 1


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--column", "north"], "--column north: give each of our column names once"),
        (["--column", "north=x", "--column", "north=y"], "give each of our column names once"),
        (["--unit", "surge=furlongs"], "--unit surge=furlongs: known units are deg"),
        (["--unit", "heading=deg", "--degrees", "heading"], "--degrees heading: has a --unit already"),
        (["--origin", "north pole"], "--origin north pole: give latitude and longitude"),
        (["--origin", "91,0"], "--origin 91,0"),
        (["--resample", "-1"], "--resample"),
        (["--boat", "titanic"], "titanic"),
        ([*RENAMED, "--degrees", "sway"], "has no column sway to be given in deg"),
        (RENAMED[:6], "column heading: is missing"),
    ],
)
def test_what_is_asked_wrongly_is_one_line_and_imports_nothing(
    call: Callable[..., Called], log: Path, words: list[str], part: str
) -> None:
    code, _, message = call("import", log, "--from", "csv", "--out", "day", *words)
    assert code == cli.BAD_INPUT
    assert part in message and len(message.splitlines()) == 1, message
    assert [path.name for path in log.parent.iterdir()] == ["log.csv"]


@pytest.mark.parametrize(
    ("kind", "words", "part"),
    [
        ("free-running", ["--unit", "surge=kn"], "--unit or --degrees: not for --from free-running"),
        ("free-running", ["--degrees", "heading"], "--unit or --degrees: not for --from free-running"),
        ("free-running", ["--bad-rows", "cut"], "--bad-rows: not for --from free-running"),
        ("free-running", ["--origin", "1,2", "--fill", "3"], "--origin, --fill: not for --from free-running"),
        ("free-running", ["--resample", "5"], "--resample: not for --from free-running"),
        ("csv", ["--repair", *RENAMED], "--repair: not for --from csv"),
        ("csv", ["--topic", "/pose", "--sender", "0", *RENAMED], "--topic, --sender: not for --from csv"),
        ("csv", ["--sender", "7", "--map", "north=x"], "--sender: not for --from csv"),
        ("csv", ["--fill", "3", *RENAMED], "--fill: fills gaps of joined tables and of --resample HZ"),
        ("csv", ["--fill", "3", *MAPPED], "--fill: fills gaps of joined tables and of --resample HZ"),
        ("csv", ["--origin", "44.1,9.5", *RENAMED], "log.csv: has north and east, so --origin cannot act"),
    ],
)
def test_an_option_that_cannot_act_is_refused(
    call: Callable[..., Called], log: Path, kind: str, words: list[str], part: str
) -> None:
    code, _, message = call("import", log, "--from", kind, "--out", "day", *words)
    assert (code, len(message.splitlines())) == (cli.BAD_INPUT, 1)
    assert part in message and not Path("day").exists()


@pytest.mark.parametrize(
    ("words", "package", "extra"),
    [
        (["export", "runs", "--to", "minari", "--out", "out"], "minari", "exchange"),
        (["export", "runs", "--to", "mcap", "--out", "out"], "mcap.writer", "exchange"),
        (["import", "gps.csv", "--from", "csv", "--out", "out"], "pyproj", "gps"),
    ],
)
def test_a_package_that_is_not_installed_is_named_with_its_extra(
    call: Callable[..., Called],
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    package: str,
    extra: str,
) -> None:
    Path("gps.csv").write_text("time,latitude,longitude,heading\n0.0,44.125,9.5,0\n0.1,44.125,9.5,0\n")
    monkeypatch.setitem(sys.modules, package, None)
    code, _, message = call(*words)
    assert code == cli.BAD_INPUT
    assert f"pip install 'swamp-rl[{extra}]'" in message and len(message.splitlines()) == 1
    assert not Path("out").exists()


def test_the_kind_of_a_log_is_that_of_its_suffix_where_only_one_has_it(
    call: Callable[..., Called], log: Path, tmp_path: Path
) -> None:
    assert call("import", log, "--list") == call("import", log, "--from", "csv", "--list")
    (tmp_path / "drive.mcap").write_bytes(b"")
    code, _, message = call("import", "drive.mcap", "--list")
    assert (code, message.count("\n")) == (2, 1)
    assert (
        "drive.mcap: neither its suffix nor its header tells what it is; give --from, one of csv" in message
    )
    code, _, message = call("import", log, "drive.mcap", "--list")
    assert (code, message.count("\n")) == (2, 1)
    code, _, message = call("import", "none.csv", "--list")
    assert (code, message) == (2, "swamp-rl: none.csv: no such file or folder; check the name\n")


def test_the_kind_of_a_folder_is_that_of_the_logs_in_it_or_in_its_folders(
    call: Callable[..., Called], tmp_path: Path
) -> None:
    day = tmp_path / "sea" / "monday"
    day.mkdir(parents=True)
    (day / "log.csv").write_text("t,x\n0,1\n1,2\n")
    (day / "notes.md").write_text("calm")
    for source in (day, tmp_path / "sea"):
        assert call("import", source, "--list") == call("import", source, "--from", "csv", "--list")
    (day / "log.ulg").write_bytes(b"")
    assert f"{day}: files of several kinds (csv, ulog); give --from" in call("import", day, "--list")[2]


def test_a_folder_without_logs_is_refused_as_such(call: Callable[..., Called], tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "calm.md").write_text("calm")
    for folder in ("empty", "notes"):
        code, _, message = call("import", folder, "--list")
        assert (code, message.count("\n")) == (2, 1)
        assert message.startswith(
            f"swamp-rl: {folder}: neither it nor a folder in it has .csv, .tsv, .parquet"
        )


def test_the_kind_of_an_mcap_file_is_that_of_the_program_that_wrote_it(
    call: Callable[..., Called], folder: Path, tmp_path: Path
) -> None:
    (ros,) = bag(tmp_path / "log", "mcap").glob("*.mcap")
    result = call("import", ros, "--list")
    assert result[0] == 0 and result == call("import", ros, "--from", "rosbag", "--list")
    assert call("export", folder, "--to", "mcap", "--out", "ours")[0] == 0
    first = sorted(Path("ours").glob("*.mcap"))[0]
    assert call("import", first, "--out", "again")[0] == 0
    assert len(read_dataset("again").runs) == 1


def test_a_column_in_degrees_that_passes_zero_often_is_one_line(
    call: Callable[..., Called], tmp_path: Path
) -> None:
    lines = [f"{0.1 * i},{i},0,{-20.0 + 40.0 * (i % 2) if i % 3 else 0.0}" for i in range(60)]
    (tmp_path / "log.csv").write_text("\n".join(["time,north,east,heading", *lines]) + "\n")
    code, _, text = call("import", "log.csv", "--out", "day")
    (message,) = [line for line in text.splitlines() if "column heading" in line]
    assert code == 2
    assert "(in 40 of rows 2 to 60) (--degrees heading)" in message
    text = call("import", "log.csv", "--out", "day", "--bad-rows", "split")[2]
    assert text.count("column heading") == 1 and "(in 40 of rows 2 to 60); 67% of the rows are bad" in text


def test_the_option_that_a_complaint_offers_can_be_typed_as_it_stands(
    call: Callable[..., Called], tmp_path: Path
) -> None:
    lines = [f"2026-05-04T09:20:{i:02d}Z,{i},0,0,calm sea" for i in range(12)]
    (tmp_path / "log.csv").write_text("\n".join(["UTC time,north,east,heading,my notes", *lines]) + "\n")
    message = call("import", "log.csv", "--out", "day")[2]
    assert "read it as times: --map 'time=`UTC time`'" in message
    assert "leave the column out: --drop 'my notes'" in message
    again = [word for name in ("north", "east", "heading") for word in ("--map", f"{name}={name}")]
    assert call("import", "log.csv", "--out", "day", "--map", "time=`UTC time`", *again)[0] == 0


def test_a_boat_that_the_dataset_names_too_may_be_named_again(
    call: Callable[..., Called], folder: Path
) -> None:
    for verb in ("check", "doctor", "show"):
        again = call(verb, folder, "--boat", "swamp")
        assert again[:2] == call(verb, folder)[:2]
        assert_complains(call(verb, folder, "--boat", "swamp-thesis"), "whose numbers differ", "--boat")


def test_the_origin_of_several_logs_is_told_and_one_of_a_log_far_away(
    call: Callable[..., Called], tmp_path: Path
) -> None:
    pytest.importorskip("pyproj")
    for name, start in ("a", 45.0), ("b", 45.001), ("c", 46.0):
        lines = [f"{0.1 * i:.1f},{start + 1e-6 * i:.6f},9,0" for i in range(20)]
        (tmp_path / f"{name}.csv").write_text("\n".join(["time,latitude,longitude,heading", *lines]) + "\n")
    code, text, _ = call("import", "a.csv", "b.csv", "c.csv", "--out", "day")
    assert code == 0
    assert "a.parquet and 1 other: origin of north and east: 45, 9\n" in text
    assert "c.parquet: origin of north and east: 46, 9, 111 km from 45, 9; positions about different" in text
