"""Importing: other names, units and places become ours, and whatever is wrong is named, not imported."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.errors import UserError
from swamp_rl.runs import Run, append_run, create_dataset, read_dataset, write_run
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.local_frame import to_local
from swamp_rl.runs.mcap_files import read_mcap
from swamp_rl.runs.schema import META
from tests.support.runs import circling, described

TIME = np.arange(40) * 0.1
DEGREES = np.mod(350.0 + 2.0 * np.arange(40), 360.0)


def write_csv(path: Path, columns: dict[str, object]) -> Path:
    rows = zip(*columns.values(), strict=True)
    path.write_text("\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)]) + "\n")
    return path


def foreign() -> dict[str, object]:
    return {
        "t_ms": (TIME * 1000).tolist(),
        "x": TIME.tolist(),
        "y": (2 * TIME).tolist(),
        "psi": DEGREES.tolist(),
        "sog_kn": [3.6] * 40,
    }


WISHES = Wishes(
    renamed={"time": "t_ms", "north": "x", "east": "y", "heading": "psi", "surge": "sog_kn"},
    units={"time": "ms", "heading": "deg", "surge": "kn"},
)


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_other_names_and_units_become_ours(tmp_path: Path, kind: str) -> None:
    path = write_csv(tmp_path / "log.csv", foreign())
    if kind == "parquet":
        path = tmp_path / "log.parquet"
        pq.write_table(pa.table({name: pa.array(values) for name, values in foreign().items()}), path)
    made = import_runs([path], kind, tmp_path / "out", About(source="human", course="camogli"), WISHES)
    assert (made.sample_rate, made.source, made.mass, made.vehicle) == (10.0, "human", 58.0, "swamp")
    run = read_dataset(tmp_path / "out").runs[0]
    assert run.time == pytest.approx(TIME)
    assert run.columns["surge"] == pytest.approx(np.full(40, 3.6 * 1852 / 3600))
    assert np.exp(1j * run.columns["heading"]) == pytest.approx(np.exp(1j * np.radians(DEGREES)))
    assert run.columns["heading"].max() <= math.pi and run.columns["heading"].min() > -math.pi


def refused(
    tmp_path: Path, path: Path, kind: str, *parts: str, wishes: Wishes = WISHES, **about: object
) -> None:
    before = sorted(tmp_path.iterdir())
    with pytest.raises(UserError) as error:
        import_runs([path], kind, tmp_path / "out", About(**about), wishes)
    lines = str(error.value).splitlines()
    assert len(lines) <= 21 and all(path.name in line for line in lines[:20])
    assert all(part in str(error.value) for part in parts), str(error.value)
    assert META not in str(error.value)
    assert sorted(tmp_path.iterdir()) == before


def with_cell(name: str, row: int, value: object) -> dict[str, object]:
    columns = foreign()
    columns[name][row] = value
    return columns


@pytest.mark.parametrize(
    ("columns", "wishes", "parts"),
    [
        (
            with_cell("x", 6, "abc"),
            WISHES,
            ["row 7 (line 8), column north", "'abc' is not a number", "there 'x'"],
        ),
        (with_cell("x", 6, ""), WISHES, ["row 7", "is missing"]),
        (with_cell("x", 6, "inf"), WISHES, ["row 7", "not a finite number"]),
        (with_cell("t_ms", 6, 0), WISHES, ["row 7", "does not come after"]),
        (with_cell("t_ms", 6, 640), WISHES, ["row 7", "(--resample HZ)"]),
        (with_cell("psi", 6, 800), WISHES, ["column heading: 800 deg is more than a turn"]),
        (foreign(), Wishes(renamed={**WISHES.renamed, "sway": "v"}), ["no column 'v'", "--column"]),
        (foreign(), Wishes(renamed={"time": "t_ms"}), ["column north", "--column north=THEIRS"]),
        (foreign(), Wishes(renamed=WISHES.renamed), ["column heading", "(--degrees heading)"]),
        (foreign(), Wishes(WISHES.renamed, {"sway": "kn"}), ["no column sway"]),
        (foreign(), Wishes(WISHES.renamed, WISHES.units, ("zebra",)), ["no column 'zebra'", "--drop"]),
        ({**foreign(), "north": [0.0] * 40}, WISHES, ["its own column north beside 'x'", "--drop north"]),
        ({**foreign(), "note": ["a"] * 40}, WISHES, ["column note", "--drop note"]),
        (with_cell("t_ms", 6, 500), WISHES, ["row 7", "does not come after", "(--bad-rows cut or split)"]),
        (
            foreign() | {"t_ms": (46206.5 + TIME / 86400).tolist()},
            Wishes(WISHES.renamed, {"heading": "deg", "surge": "kn"}),
            ["column time", "times in days", "--unit time=d"],
        ),
        (
            {**foreign(), "throttle_bs": [1500.0] * 40},
            WISHES,
            ["looks like a pulse width", "(pwm - 1500) / 400"],
        ),
        (
            {**foreign(), "throttle_bs": [1.0275] * 40},
            WISHES,
            ["1.0275 is outside", "clip((pwm - 1510) / 400, -1, 1)"],
        ),
        (
            {**foreign(), "throttle_left": [0.1] * 40},
            WISHES,
            [
                "has no thruster 'left'",
                "(its commands are azimuth_bs, throttle_bs, ",
                "the boat that has it (--map or --column, --drop, --boat)",
            ],
        ),
        ({**foreign(), " Sway": [0.1] * 40}, WISHES, ["is sway of the run format", "--column sway=Sway"]),
        ({**foreign(), "THROTTLE_BS": [0.1] * 40}, WISHES, ["--column throttle_bs=THROTTLE_BS"]),
        (
            {**foreign(), "clock": ["14:05:01"] * 40},
            WISHES,
            ["'14:05:01' is not a number", "--map time=clock"],
        ),
        ({**foreign(), "local clock": ["14:05:01"] * 40}, WISHES, ["--map 'time=`local clock`'"]),
    ],
)
def test_what_is_wrong_is_named_by_file_row_and_column_and_nothing_is_written(
    tmp_path: Path, columns: dict[str, object], wishes: Wishes, parts: list[str]
) -> None:
    refused(tmp_path, write_csv(tmp_path / "log.csv", columns), "csv", "log.csv", *parts, wishes=wishes)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("# logger 3\nt_ms,x,y,psi\n" + "0,1,2,3\n" * 2000, "line 2 has 4 values; the first line must name"),
        ("sep=;\nt_ms;x;y;psi\n0;1;2;3\n1;1;2;3\n", "line 2 has 4 values; the first line must name"),
        ("t_ms,x,y,psi °\n0,1,2,3\n".encode("cp1252"), "is not UTF-8 text; save the file as UTF-8"),
        ("t_ms,x\n0,1\n".encode("utf-16"), "is not UTF-8 text; save the file as UTF-8"),
        (("t_ms,x\n" + "0,1\n" * 40_000 + "1,°\n").encode("cp1252"), "is not UTF-8; save the file as UTF-8"),
        ("t_ms,x,y,psi,sog_kn\n0,1,2,3,4\n100,1,2,3,4", "does not end with a line end"),
    ],
)
def test_a_table_that_is_written_otherwise_is_reported_how(
    tmp_path: Path, text: str | bytes, part: str
) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    refused(tmp_path, path, "csv", "log.csv", part)


def test_rows_at_thirty_hertz_in_whole_milliseconds_are_even(tmp_path: Path) -> None:
    count = 400
    columns = {"time": np.round(np.arange(count) / 30.0, 3).tolist(), "north": np.arange(count).tolist()}
    columns |= {"east": [0.0] * count, "heading": [0.1] * count}
    made = import_runs([write_csv(tmp_path / "log.csv", columns)], "csv", tmp_path / "out")
    assert made.sample_rate == pytest.approx(30.0, rel=1e-4)
    assert len(read_dataset(tmp_path / "out").runs[0].time) == count


def test_a_column_of_words_can_be_left_out_and_one_of_numbers_is_kept(tmp_path: Path) -> None:
    columns = {**foreign(), "note": ["a"] * 40, "volts": [12.5] * 40}
    wishes = Wishes(WISHES.renamed, WISHES.units, ("note",))
    import_runs([write_csv(tmp_path / "log.csv", columns)], "csv", tmp_path / "out", None, wishes)
    run = read_dataset(tmp_path / "out").runs[0]
    assert "note" not in run.columns and run.columns["volts"][3] == 12.5


def test_rows_without_times_are_counted(tmp_path: Path) -> None:
    columns = {name: values for name, values in foreign().items() if name != "t_ms"}
    renamed = {ours: theirs for ours, theirs in WISHES.renamed.items() if ours != "time"}
    wishes = Wishes(renamed, {"heading": "deg"}, rate=5.0)
    made = import_runs([write_csv(tmp_path / "log.csv", columns)], "csv", tmp_path / "out", None, wishes)
    assert made.sample_rate == 5.0
    run = read_dataset(tmp_path / "out").runs[0]
    assert run.time == pytest.approx(np.arange(40) / 5.0)
    assert run.meta.model_extra == {"times": "counted, 5 rows a second", "units": {"heading": "deg"}}


def test_uneven_rows_are_resampled_when_asked_and_the_run_says_so(tmp_path: Path) -> None:
    times = np.sort(np.random.default_rng(1).uniform(0.0, 4.0, 40))
    columns = foreign() | {"t_ms": (1000 * times).tolist(), "x": (3.0 * times).tolist()}
    wishes = Wishes(WISHES.renamed, WISHES.units, resample=20.0, fill=1.0)
    made = import_runs([write_csv(tmp_path / "log.csv", columns)], "csv", tmp_path / "out", None, wishes)
    run = read_dataset(tmp_path / "out").runs[0]
    assert made.sample_rate == 20.0
    assert run.columns["north"] == pytest.approx(3.0 * run.time)
    assert "40 rows to" in str(run.meta.model_extra)


def test_a_gap_longer_than_fill_is_not_interpolated(tmp_path: Path) -> None:
    times = np.where(TIME < 2.0, TIME, TIME + 5.0)
    path = write_csv(tmp_path / "log.csv", foreign() | {"t_ms": (1000.0 * times).tolist()})
    for fill in (0.0, 5.0):
        wishes = Wishes(WISHES.renamed, WISHES.units, resample=20.0, fill=fill)
        listed = ["row 21 (line 22), column time: 5.1 s after the row before; --fill SECONDS", "--bad-rows"]
        refused(tmp_path, path, "csv", *listed, wishes=wishes)
    wishes = Wishes(WISHES.renamed, WISHES.units, resample=20.0, fill=5.2)
    import_runs([path], "csv", tmp_path / "out", None, wishes)
    assert read_dataset(tmp_path / "out").runs[0].duration == pytest.approx(8.9)


def test_places_near_the_origin_agree_with_the_ellipsoids_radii_of_curvature() -> None:
    a, f = 6378137.0, 1 / 298.257223563
    e2, latitude = f * (2 - f), math.radians(44.3489)
    w = math.sqrt(1 - e2 * math.sin(latitude) ** 2)
    meridian, normal = a * (1 - e2) / w**3, a / w
    step = 1e-5  # degrees, about a metre
    north, east = to_local(
        np.array([44.3489 + step, 44.3489]), np.array([9.1536, 9.1536 + step]), (44.3489, 9.1536)
    )
    assert north[0] == pytest.approx(meridian * math.radians(step), rel=1e-6)
    assert east[1] == pytest.approx(normal * math.cos(latitude) * math.radians(step), rel=1e-6)
    assert abs(north[1]) < 1e-6 and abs(east[0]) < 1e-6


def test_latitude_and_longitude_become_north_and_east_of_the_first_place(tmp_path: Path) -> None:
    columns = {"time": TIME, "lat": 44.0 + 1e-5 * np.arange(40), "lon": [9.0] * 40, "heading": [0.0] * 40}
    wishes = Wishes({"latitude": "lat", "longitude": "lon"})
    path = write_csv(tmp_path / "log.csv", columns)
    import_runs([path], "csv", tmp_path / "out", None, wishes)
    run = read_dataset(tmp_path / "out").runs[0]
    assert run.columns["north"][0] == 0.0 and run.columns["north"][-1] == pytest.approx(43.34, abs=0.02)
    assert np.abs(run.columns["east"]).max() < 1e-9
    assert run.meta.model_extra == {"origin": {"latitude": 44.0, "longitude": 9.0}}
    write_csv(path, columns | {"lat": [44.0] * 39 + [440.0]})
    with pytest.raises(UserError, match=r"row 40.*column latitude: 440 is no latitude"):
        import_runs([path], "csv", tmp_path / "new", None, wishes)


def test_an_out_that_is_there_and_what_is_no_source_are_refused(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    with pytest.raises(UserError, match="already exists"):
        import_runs([write_csv(tmp_path / "log.csv", foreign())], "csv", tmp_path / "b", None, WISHES)
    refused(tmp_path, tmp_path / "b", "parquet", "nor a folder in it has .parquet")
    refused(tmp_path, tmp_path / "nowhere", "csv", "no such file or folder")


def write_messages(path: Path, topics: dict[str, list[object]], encoding: str = "json") -> Path:
    from mcap.writer import Writer

    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        for topic, messages in topics.items():
            channel = writer.register_channel(topic, encoding, 0)
            for i, message in enumerate(messages):
                data = message if isinstance(message, bytes) else json.dumps(message).encode()
                writer.add_message(channel, 10**18 + i * 10**8, data, 0)
        writer.finish()
    return path


POSES = [{"pose": {"x": 0.1 * i, "y": 0, "psi": 1.0}} for i in range(20)]
MCAP = Wishes({"north": "pose.x", "east": "pose.y", "heading": "pose.psi"})


def test_mcap_of_others_gives_nested_fields_and_the_logs_time(tmp_path: Path) -> None:
    path = write_messages(tmp_path / "a.mcap", {"/pose": POSES, "/other": [{"a": 1}]})
    import_runs([path], "mcap", tmp_path / "out", About(topic="/pose"), MCAP)
    run = read_dataset(tmp_path / "out").runs[0]
    assert run.time == pytest.approx(np.arange(20) * 0.1)
    assert run.columns["north"] == pytest.approx(np.arange(20) * 0.1)


@pytest.mark.parametrize(
    ("topics", "parts"),
    [
        ({"/a": POSES, "/b": POSES}, ["topics with JSON messages are /a, /b", "--topic"]),
        ({}, ["topics with JSON messages are none"]),
        ({"/a": [*POSES, b"{"]}, ["/a, row 21: is no JSON"]),
        ({"/a": [*POSES, [1]]}, ["/a, row 21: is no JSON object"]),
        ({"/a": [*POSES, {}]}, ["row 21", "column north", "is missing"]),
        ({"/a": [{"pose": {"x": "1", "y": 0, "psi": 0}}, *POSES]}, ["row 1", "column north", "not a number"]),
        ({"/a": [{"pose": {"x": 10**400, "y": 0, "psi": 0}}, *POSES]}, ["/a, row 1", "401 digits"]),
    ],
)
def test_mcap_that_cannot_be_a_run_is_refused(
    tmp_path: Path, topics: dict[str, list[object]], parts: list[str]
) -> None:
    path = write_messages(tmp_path / "a.mcap", topics)
    refused(tmp_path, path, "mcap", "a.mcap", *parts, wishes=MCAP)


def test_an_mcap_file_cut_short_anywhere_is_refused(tmp_path: Path) -> None:
    whole = write_messages(tmp_path / "a.mcap", {"/a": POSES}).read_bytes()
    for end in (0, 5, len(whole) // 2, len(whole) - 3):
        (tmp_path / "a.mcap").write_bytes(whole[:end])
        refused(tmp_path, tmp_path / "a.mcap", "mcap", "a.mcap", wishes=MCAP)


@given(garbage=st.binary(max_size=200))
def test_garbage_is_refused_in_one_line(tmp_path_factory: pytest.TempPathFactory, garbage: bytes) -> None:
    path = tmp_path_factory.mktemp("mcap") / "a.mcap"
    path.write_bytes(b"\x89MCAP0\r\n" + garbage)
    with pytest.raises(UserError):
        read_mcap(path)


def test_files_of_different_datasets_are_not_mixed(folder: Path, tmp_path: Path) -> None:
    create_dataset(tmp_path / "other", described(course=None))
    append_run(tmp_path / "other", Run("three", circling()), "csv")
    with pytest.raises(UserError, match="is of another dataset than"):
        import_runs([folder / "one.csv", tmp_path / "other"], "csv", tmp_path / "out")


def test_free_running_tests_have_their_verb_too(tmp_path: Path) -> None:
    from swamp_rl.runs.free_running import COLUMNS

    values = dict.fromkeys(COLUMNS, [0.0] * 20) | {
        "t [s]": (np.arange(20) * 0.1).tolist(),
        "n_prop [rps]": [10.0] * 20,
    }
    path = write_csv(tmp_path / "turn.csv", values)
    made = import_runs([path], "free-running", tmp_path / "out")
    assert (made.vehicle, made.sample_rate, made.source) == ("esso_osaka", 10.0, "measured")
    assert read_dataset(tmp_path / "out").runs[0].columns["east"].tolist() == [0.0] * 20


def test_a_folder_of_folders_of_free_running_tests_is_imported_without_the_tables_beside_them(
    tmp_path: Path,
) -> None:
    from swamp_rl.runs.free_running import COLUMNS

    values = dict.fromkeys(COLUMNS, [0.0] * 20) | {"t [s]": (np.arange(20) * 0.1).tolist()}
    for place in ("turning/turn", "zigzag/zigzag"):
        (tmp_path / "tests" / place).parent.mkdir(parents=True)
        write_csv(tmp_path / "tests" / f"{place}.csv", values)
    write_csv(tmp_path / "tests" / "turning" / "params.csv", {"lpp": [3.0]})
    made = import_runs([tmp_path / "tests"], "free-running", tmp_path / "out")
    assert [run.file for run in made.runs] == ["turn.parquet", "zigzag.parquet"]
    (tmp_path / "empty").mkdir()
    with pytest.raises(UserError, match="neither it nor a folder in it"):
        import_runs([tmp_path / "empty"], "free-running", tmp_path / "none")


def test_our_own_folder_needs_no_wishes(folder: Path, tmp_path: Path) -> None:
    (folder / "two.parquet").rename(tmp_path / "two.parquet")
    import_runs([folder / "one.csv"], "csv", tmp_path / "out")
    one = read_dataset(tmp_path / "out")
    assert one.runs[0].meta.seed == 1 and one.meta.course == "camogli"
    assert one.runs[0].columns["north"].tobytes() == circling()["north"].tobytes()


@pytest.mark.parametrize(
    ("about", "outcome"),
    [
        ({}, None),
        ({"outcome": "success"}, "success"),
        ({"outcome": "failed", "course": "camogli"}, "failed"),
        ({"course": "camogli"}, "incomplete"),
        ({"outcome": "auto", "course": "camogli"}, "incomplete"),
    ],
)
def test_an_imported_run_ended_as_is_said_or_as_the_course_tells(
    tmp_path: Path, about: dict[str, str], outcome: str | None
) -> None:
    (tmp_path / "logs").mkdir()
    write_run(tmp_path / "logs" / "one.csv", Run("one", circling()))
    import_runs([tmp_path / "logs"], "csv", tmp_path / "out", About(**about, group="monday"))
    (run,) = read_dataset(tmp_path / "out").runs
    assert (run.meta.outcome, run.meta.group) == (outcome, "monday")


def test_an_outcome_cannot_be_worked_out_without_a_course(tmp_path: Path) -> None:
    write_run(tmp_path / "one.csv", Run("one", circling()))
    with pytest.raises(UserError, match=r"--outcome auto: .*--course NAME"):
        import_runs([tmp_path / "one.csv"], "csv", tmp_path / "out", About(outcome="auto"))
    assert not (tmp_path / "out").exists()


def test_what_all_files_lack_is_reported_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyproj", None)
    columns = {"time": TIME.tolist(), "heading": [0.1] * 40}
    columns |= {"latitude": [43.21] * 40, "longitude": [8.76] * 40}
    files = [write_csv(tmp_path / f"{name}.csv", columns) for name in ("one", "two")]
    with pytest.raises(UserError) as error:
        import_runs(files, "csv", tmp_path / "out")
    assert str(error.value) == (
        "latitude and longitude need pyproj; pip install 'swamp-rl[gps]'; nothing was imported"
    )
