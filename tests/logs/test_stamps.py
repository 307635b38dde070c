"""Times of tables of others: their unit, their first row, and the common clock of joined tables."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs, read_log
from swamp_rl.logs.listing import listing
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.bad_rows import BadRows
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.table import read_table

COUNT = 60
TIME = np.round(0.1 * np.arange(COUNT), 1)


def imported(paths: list[Path], wishes: Wishes | None = None, join: str | None = None) -> Run:
    """The run of files with columns t, x, y and psi, or of one with t, x, y and one with t, psi."""
    place, turn = ("", "") if join is None else (f"{paths[0].stem}.", f"{paths[1].stem}.")
    mapping = mapping_of(["time=t", f"x={place}x", f"y={place}y", f"yaw={turn}psi"])
    out, kind = paths[0].parent / "out", paths[0].suffix[1:]
    import_logs(paths, kind, out, About(), wishes or Wishes(), Reading(mapping, join))
    (run,) = read_dataset(out).runs
    return run


def table(path: Path, stamps: list[str], x: bool = True, psi: bool = True) -> Path:
    """A CSV file of a boat that sails north at 1 m/s and turns at 0.01 rad/s from the first TIME on."""
    columns = {"t": stamps}
    if x:
        columns |= {"x": [f"{t:.3f}" for t in TIME], "y": ["0"] * COUNT}
    if psi:
        columns |= {"psi": [f"{0.01 * t:.5f}" for t in TIME]}
    rows = [",".join(row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    return path


def of_a_day(start: float, hour: str = "14:00:00.000") -> list[str]:
    moments = np.datetime64(f"2024-06-05T{hour}") + np.round(1000.0 * (start + TIME)).astype("m8[ms]")
    return [str(moment)[11:] for moment in moments]


@pytest.mark.parametrize("day", ["", "05/06/2024 "], ids=["times of a day", "days of unknown order"])
def test_joined_tables_have_one_clock_though_the_day_is_not_known(tmp_path: Path, day: str) -> None:
    gps = table(tmp_path / "gps.csv", [day + clock for clock in of_a_day(0.0)], psi=False)
    imu = table(tmp_path / "imu.csv", [day + clock for clock in of_a_day(2.0)], x=False)
    run = imported([gps, imu], join="trip")
    assert run.columns["north"][0] == pytest.approx(2.0)
    assert run.columns["heading"] == pytest.approx(0.01 * run.time, abs=1e-6)
    assert run.duration == pytest.approx(3.9)


@pytest.mark.parametrize("known", ["2024-05-06T", "2024/05/06 ", "06.05.2024 ", "2024-06-05T"])
def test_a_date_of_either_order_is_the_one_of_the_table_beside_it(tmp_path: Path, known: str) -> None:
    gps = table(tmp_path / "gps.csv", [known + clock for clock in of_a_day(0.0)], psi=False)
    imu = table(tmp_path / "imu.csv", [f"05/06/2024 {clock}" for clock in of_a_day(2.0)], x=False)
    run = imported([gps, imu], join="trip")
    assert run.columns["north"][0] == pytest.approx(2.0) and run.duration == pytest.approx(3.9)


def test_tables_joined_by_times_in_whole_seconds_are_refused(tmp_path: Path) -> None:
    gps = table(tmp_path / "gps.csv", [f"{int(t)}" for t in TIME], psi=False)
    imu = table(tmp_path / "imu.csv", [f"{t}" for t in TIME], x=False)
    with pytest.raises(UserError, match="the times of gps repeat: 10 rows have each time") as error:
        imported([gps, imu], join="trip")
    assert "\n" not in str(error.value)


def test_a_yaw_beyond_a_turn_in_degrees_is_reported_by_its_row(tmp_path: Path) -> None:
    log = table(tmp_path / "log.csv", [f"{t}" for t in TIME])
    lines = log.read_text().splitlines()
    lines[31] = lines[31].rpartition(",")[0] + ",500"
    log.write_text("\n".join(lines) + "\n")
    with pytest.raises(UserError, match="--map yaw: row 31: 500 deg is more than a turn; correct it"):
        imported([log], Wishes(units={"yaw": "deg"}))


def test_a_table_may_name_times_of_its_own_and_shift_those_of_another_zone(tmp_path: Path) -> None:
    local = table(tmp_path / "gps.csv", of_a_day(0.0, "16:00:00.000"), psi=False)
    utc = table(tmp_path / "imu.csv", [f"2024-06-05 {clock}" for clock in of_a_day(2.0)], x=False)
    utc.write_text(utc.read_text().replace("t,", "Zeit UTC,", 1))
    places = ["x=gps.x", "y=gps.y", "yaw=imu.psi"]

    def run_of(out: str, *times: str) -> Run:
        reading = Reading(mapping_of([*times, *places]), "trip")
        import_logs([local, utc], "csv", tmp_path / out, About(), Wishes(), reading)
        (run,) = read_dataset(tmp_path / out).runs
        return run

    with pytest.raises(UserError, match=r"--map time of table imu \(--map imu\.time=COLUMN gives its own\)"):
        run_of("one", "time=t")
    with pytest.raises(UserError, match=r"for clocks that are hours apart, --map imu\.time="):
        run_of("apart", "time=t", "imu.time=`Zeit UTC`")
    run = run_of("shifted", "gps.time=t - 7200", "imu.time=`Zeit UTC`")
    assert run.columns["north"][0] == pytest.approx(2.0)
    assert run.columns["heading"] == pytest.approx(0.01 * run.time, abs=1e-6)
    assert (run.meta.model_extra or {})["times"] == "of a day, from 16:00:00.000, shifted by -7200 s"


def test_a_date_and_a_time_of_day_are_not_added(tmp_path: Path) -> None:
    log = table(tmp_path / "log.csv", [f"14.05.2024,{clock}" for clock in of_a_day(0.0)])
    log.write_text(log.read_text().replace("t,", "day,t,", 1))
    with pytest.raises(UserError, match=r"'day' has no numbers.* give the time of day alone"):
        reading = Reading(mapping_of(["time=day + t", "x=x", "y=y", "yaw=psi"]))
        import_logs([log], "csv", tmp_path / "out", About(), Wishes(), reading)
    assert imported([log]).duration == pytest.approx(5.9)


def test_times_of_a_table_that_is_not_there_are_refused(tmp_path: Path) -> None:
    gps = table(tmp_path / "gps.csv", of_a_day(0.0))
    reading = Reading(mapping_of(["time=t", "imu.time=t", "x=x", "y=y", "yaw=psi"]))
    with pytest.raises(UserError, match=r"--map imu\.time: there is no table 'imu'; known here: gps"):
        import_logs([gps], "csv", tmp_path / "out", About(), Wishes(), reading)


def test_tables_whose_dates_are_read_in_different_orders_are_not_joined(tmp_path: Path) -> None:
    either = table(tmp_path / "gps.csv", [f"05/06/2024 {clock}" for clock in of_a_day(0.0)], psi=False)
    month_first = table(tmp_path / "imu.csv", [f"05/16/2024 {clock}" for clock in of_a_day(0.0)], x=False)
    with pytest.raises(UserError, match="the tables have no time in common"):
        imported([either, month_first], join="trip")


@pytest.mark.parametrize(("ticks", "start"), [(1e3, 1.7e9), (1e6, 1.7e9), (1e9, 1.7e9)])
def test_stamps_from_before_a_fix_are_bad_rows_and_change_no_unit(
    tmp_path: Path, ticks: float, start: float
) -> None:
    stamps = ["0", "0", "0", *(f"{round((start + t) * ticks)}" for t in TIME[3:])]
    path = table(tmp_path / "log.csv", stamps)
    with pytest.raises(UserError, match=r"row 1 \(line 2\), column time: is not a time"):
        imported([path])
    run = imported([path], Wishes(bad_rows="cut"))
    assert run.time == pytest.approx(TIME[3:] - TIME[3], abs=1e-5)
    assert run.columns["north"][0] == pytest.approx(0.3)


@pytest.mark.parametrize(
    "stamps",
    [1.2e9 + 1e6 * TIME, 5e5 + 1e3 * TIME, 3e12 + 1e9 * TIME],
    ids=["us since the boot", "ms since the boot", "ns since the boot"],
)
def test_ticks_since_a_boot_need_their_unit(tmp_path: Path, stamps: np.ndarray) -> None:
    path = table(tmp_path / "log.csv", [f"{stamp:.0f}" for stamp in stamps])
    with pytest.raises(UserError, match=r"log\.csv: --map time: the rows are .* s apart.*--unit time=ms"):
        imported([path])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("given", "ticks", "right"), [("ms", 1e9, "ns"), ("ns", 1e3, "ms")])
def test_a_unit_of_time_of_which_no_rate_is_plausible_is_refused_with_one_that_is(
    tmp_path: Path, given: str, ticks: float, right: str
) -> None:
    path = table(tmp_path / "log.csv", [f"{ticks * time:.0f}" for time in TIME])
    with pytest.raises(UserError, match=rf"the rows are .* s apart.*correct it, as in --unit time={right}$"):
        imported([path], Wishes(units={"time": given}))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("unit", "step"), [("us", 1e5), ("ms", 100.0), ("s", 0.1)])
def test_numbers_count_from_the_first_row_in_the_unit_that_is_given(
    tmp_path: Path, unit: str, step: float
) -> None:
    path = table(tmp_path / "log.csv", [f"{1000.0 + step * i:.6g}" for i in range(COUNT)])
    assert imported([path], Wishes(units={"time": unit})).time == pytest.approx(TIME)


def test_seconds_count_from_the_first_row(tmp_path: Path) -> None:
    assert imported([table(tmp_path / "log.csv", [f"{1000.0 + t:.1f}" for t in TIME])]).time[0] == 0.0


def test_rows_far_apart_are_seconds_where_that_is_said(tmp_path: Path) -> None:
    path = table(tmp_path / "log.csv", [f"{60 * i}" for i in range(COUNT)])
    assert imported([path], Wishes(units={"time": "s"})).time[1] == 60.0


def test_a_first_row_without_a_time_of_day_is_a_bad_row(tmp_path: Path) -> None:
    path = table(tmp_path / "log.csv", ["", *of_a_day(0.0)[1:]])
    assert "t: times" in list(listing(read_log(path, "csv")))[1]
    assert imported([path], Wishes(bad_rows="cut")).time == pytest.approx(TIME[1:] - TIME[1])


EPOCH = 1_700_000_000_000_000_000
"""ns"""
STEPS = np.arange(COUNT, dtype=np.int64) * 100_000_123
"""ns, no whole microseconds."""


@pytest.mark.parametrize(
    ("cells", "tolerance"),
    [
        (pa.array(EPOCH + STEPS, pa.timestamp("ns")), 1e-12),
        (pa.array(EPOCH + STEPS, pa.timestamp("ns", tz="Mars/One")), 1e-12),
        (pa.array((EPOCH + STEPS) // 1000, pa.timestamp("us")), 1e-6),
        (pa.array(EPOCH // 10**5 + STEPS, pa.time64("ns")), 1e-9),
        (pa.array((STEPS // 10**6).astype(np.int32), pa.time32("ms")), 1e-3),
        (pa.array(STEPS, pa.duration("ns")), 1e-12),
        (pa.array(EPOCH + STEPS), 3e-7),
    ],
    ids=lambda cells: str(getattr(cells, "type", "")),
)
def test_times_of_parquet_are_known_to_the_nanosecond(
    tmp_path: Path, cells: pa.Array, tolerance: float
) -> None:
    path = tmp_path / "log.parquet"
    pq.write_table(pa.table({"t": cells, "x": TIME, "y": 0.0 * TIME, "psi": 0.01 * TIME}), path)
    list(listing(read_log(path, "parquet")))
    assert imported([path]).time == pytest.approx(STEPS * 1e-9, abs=tolerance)


def far(unit: str) -> pa.Array:
    return pa.array([2**62] * COUNT, pa.timestamp(unit))


@pytest.mark.parametrize(
    "cells",
    [
        far("us"),
        far("ms"),
        pa.array([2**62] * COUNT, pa.time64("ns")),
        pa.array([2**30] * COUNT, pa.date32()),
        pa.array([b"\xff"] * COUNT),
    ],
    ids=["us", "ms", "time of day", "date", "bytes"],
)
def test_cells_that_are_no_number_are_faults_whatever_their_type(tmp_path: Path, cells: pa.Array) -> None:
    path = tmp_path / "log.parquet"
    pq.write_table(pa.table({"t": cells, "x": TIME, "y": TIME, "psi": TIME}), path)
    assert "is not a number" in read_table(path).faults[0].message
    assert list(listing(read_log(path, "parquet")))[1].startswith("  t: no numbers, as")
    with pytest.raises(UserError, match=r"--map time: .* is not a time"):
        imported([path])


@pytest.mark.parametrize("bad_rows", ["refuse", "cut", "split"])
def test_rows_at_ten_hertz_in_whole_seconds_are_reported_and_can_be_counted(
    tmp_path: Path, bad_rows: BadRows
) -> None:
    log = table(tmp_path / "log.csv", [f"{1_780_470_000 + int(t)}" for t in TIME])
    with pytest.raises(UserError) as error:
        imported([log], Wishes(bad_rows=bad_rows))
    (line,) = str(error.value).splitlines()
    assert (
        "column time: repeats: 10 rows have each time, 1 s apart, as at 10 Hz; give each row its own" in line
    )
    assert "(--rate HZ counts rows at a constant rate)" in line
    run = imported([log], Wishes(bad_rows=bad_rows, rate=10.0))
    assert run.time == pytest.approx(TIME)
    assert (run.meta.model_extra or {})["times"] == "counted, 10 rows a second"


def test_times_that_are_rounded_to_figures_are_reported_with_the_rate_of_the_whole(tmp_path: Path) -> None:
    log = table(tmp_path / "log.csv", [f"{0.5 * i:.0e}" for i in range(COUNT)])
    with pytest.raises(UserError) as error:
        imported([log])
    (line,) = str(error.value).splitlines()
    assert "column time: repeats: 60 rows have 14 times, as if rounded, at 1.967 Hz on the whole" in line
    assert "(--rate HZ counts rows at a constant rate)" in line
    assert imported([log], Wishes(rate=2.0)).duration == pytest.approx(29.5)


def test_a_file_whose_times_mostly_repeat_is_refused_beside_other_bad_rows(tmp_path: Path) -> None:
    log = table(tmp_path / "log.csv", [f"{int(t)}" if i != 30 else "" for i, t in enumerate(TIME)])
    with pytest.raises(UserError, match="column time: repeats: 10 rows have each time"):
        imported([log], Wishes(bad_rows="split"))


def test_rows_of_joined_tables_are_not_counted(tmp_path: Path) -> None:
    gps = table(tmp_path / "gps.csv", of_a_day(0.0), psi=False)
    imu = table(tmp_path / "imu.csv", of_a_day(2.0), x=False)
    with pytest.raises(UserError, match="--rate: counts the rows of one table without times"):
        imported([gps, imu], Wishes(rate=10.0), join="trip")


def test_rows_that_repeat_a_time_count_as_bad_ones(tmp_path: Path) -> None:
    times = np.where(np.arange(COUNT) % 3 == 1, TIME - 0.1, TIME)
    log = table(tmp_path / "log.csv", [f"{t:.1f}" for t in times])
    lines = log.read_text().splitlines()
    lines[3:46:3] = [line.replace(line.split(",")[1], "", 1) for line in lines[3:46:3]]
    log.write_text("\n".join(lines) + "\n")
    with pytest.raises(UserError, match="% of the rows are bad"):
        imported([log], Wishes(bad_rows="split", resample=5.0))


def test_times_of_a_day_are_counted_past_midnight(tmp_path: Path) -> None:
    stamps = of_a_day(0.0, "23:59:58.000")
    stamps[20:22] = stamps[21:19:-1]  # a message that comes late
    log = table(tmp_path / "log.csv", stamps)
    with pytest.raises(UserError, match=r"row 22 .*: 2 s does not come after 2\.1 s"):
        imported([log])
    run = imported([table(tmp_path / "log.csv", of_a_day(0.0, "23:59:58.000"))])
    assert run.time == pytest.approx(TIME)
    assert (run.meta.model_extra or {})["times"] == "of a day, from 23:59:58.000, past midnight"


@pytest.mark.parametrize("later", ["gps", "imu"])
def test_joined_tables_have_one_clock_past_midnight(tmp_path: Path, later: str) -> None:
    start = {"gps": 0.0, "imu": 0.0, later: 2.5}
    gps = table(tmp_path / "gps.csv", of_a_day(start["gps"], "23:59:58.000"), psi=False)
    imu = table(tmp_path / "imu.csv", of_a_day(start["imu"], "23:59:58.000"), x=False)
    run = imported([gps, imu], join="trip")
    assert run.duration == pytest.approx(3.4)
    assert run.columns["north"][0] == pytest.approx(2.5 - start["gps"])
    assert run.columns["heading"][0] == pytest.approx(0.01 * (2.5 - start["imu"]), abs=1e-6)
    assert "past midnight" in (run.meta.model_extra or {})["times"]


@pytest.mark.parametrize("way", ["column", "mapping"])
def test_a_row_without_a_time_is_reported_with_the_option_that_leaves_it_out(
    tmp_path: Path, way: str
) -> None:
    stamps = [f"{1_700_000_000_000 + round(1000 * t)}" for t in TIME]
    stamps[30] = "0"
    log = table(tmp_path / "log.csv", stamps)

    def made(wishes: Wishes) -> Run:
        return imported([log], wishes) if way == "mapping" else renamed(log, wishes)

    with pytest.raises(UserError) as error:
        made(Wishes())
    (line,) = str(error.value).splitlines()
    assert "row 31 (line 32), column time: is not a time; correct it or cut the row" in line
    assert line.endswith("(--bad-rows cut or split); nothing was imported")
    run = made(Wishes(bad_rows="cut"))
    assert len(run.time) == 30 and run.time == pytest.approx(TIME[:30])
    assert "ms since 1970, from 2023-11-14" in (run.meta.model_extra or {})["times"]


def renamed(log: Path, wishes: Wishes) -> Run:
    """The run of a file with columns t, x, y and psi by their new names."""
    names = {"time": "t", "north": "x", "east": "y", "heading": "psi"}
    import_runs([log], "csv", log.parent / "out", None, replace(wishes, renamed=names))
    (run,) = read_dataset(log.parent / "out").runs
    return run


def test_the_unit_of_a_renamed_time_is_asked_for_where_its_rows_lie_far_apart(tmp_path: Path) -> None:
    log = table(tmp_path / "log.csv", [f"{round(1000 * t)}" for t in TIME])
    for wishes in (Wishes(), Wishes(bad_rows="split"), Wishes(resample=5.0)):
        with pytest.raises(
            UserError, match="column time: the rows are 100 s apart if the numbers are s; give"
        ):
            renamed(log, wishes)
    assert renamed(log, Wishes(units={"time": "ms"})).time == pytest.approx(TIME)


def test_times_in_days_are_reported_a_mapping_too(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"as of times in days; give them in s \(--unit time=d\)"):
        imported([table(tmp_path / "log.csv", [f"{45_000 + t / 86_400:.9f}" for t in TIME])])
