"""Tables joined on one grid: places across the antimeridian, tables that fall silent."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from tests.support.from_scratch import written
from tests.support.logs import csv_of

TIME = np.round(0.1 * np.arange(300), 1)


def joined(
    folder: Path, tables: dict[str, dict[str, np.ndarray]], mapping: list[str], wishes: Wishes | None = None
) -> Run:
    """The run of tables whose times are their column t, of a boat with two throttles."""
    paths = [
        csv_of(folder / f"{name}.csv", {k: [repr(float(x)) for x in v] for k, v in columns.items()})
        for name, columns in tables.items()
    ]
    reading, about = (
        Reading(mapping_of(["time=t", *mapping]), "trip"),
        About(boat=str(written(folder, "twin"))),
    )
    import_logs(paths, "csv", folder / "out", about, wishes or Wishes(), reading)
    (run,) = read_dataset(folder / "out").runs
    return run


POSES = ["north=pos.n", "east=pos.e", "heading=pos.psi"]


def poses() -> dict[str, np.ndarray]:
    return {"t": TIME, "n": TIME, "e": 0.0 * TIME, "psi": 0.01 * TIME}


def throttle(time: np.ndarray) -> dict[str, np.ndarray]:
    return {"t": time, "port": 0.5 + 0.1 * np.sin(time)}


COMMANDS = [*POSES, "throttle_port=cmd.port", "throttle_starboard=cmd.port"]


def test_a_command_is_mixed_from_tables_with_times_of_their_own(tmp_path: Path) -> None:
    changes = {"t": np.array([-0.3, 7.33, 15.21]), "gear": np.array([1.0, -1.0, 0.0])}
    tables = {"pos": poses(), "level": throttle(TIME - 0.04), "gear": changes}
    mixed = ["throttle_port=where(gear.gear == 0, 0, gear.gear * level.port)", "throttle_starboard=0"]
    run = joined(tmp_path, tables, [*POSES, *mixed])
    before = np.searchsorted(changes["t"], TIME, side="right") - 1
    level = 0.5 + 0.1 * np.sin(TIME - 0.04)
    assert run.columns["throttle_port"] == pytest.approx(changes["gear"][before] * level, abs=1e-12)
    assert not [name for name in run.columns if "level" in name or "gear" in name]
    assert "not_imported" not in (run.meta.model_extra or {})


def test_a_mixed_command_has_the_unit_of_its_expression(tmp_path: Path) -> None:
    tables = {"pos": poses(), "force": throttle(TIME), "turn": throttle(TIME)}
    mixed = ["throttle_port=100 * (force.port - turn.port / 2)", "throttle_starboard=0"]
    run = joined(tmp_path, tables, [*POSES, *mixed], Wishes(units={"throttle_port": "percent"}))
    assert run.columns["throttle_port"] == pytest.approx(0.25 + 0.05 * np.sin(TIME), abs=1e-12)
    assert (run.meta.model_extra or {})["units"] == {"throttle_port": "percent"}


def test_a_pause_of_either_table_of_a_mixed_command_is_a_bad_stretch(tmp_path: Path) -> None:
    paused = throttle(np.delete(TIME, slice(100, 150)))
    for names in (("force", "turn"), ("turn", "force")):
        tables = {"pos": poses(), names[0]: throttle(TIME), names[1]: paused}
        mixed = ["throttle_port=force.port - turn.port", "throttle_starboard=0"]
        with pytest.raises(UserError, match=f"column throttle_port: {names[1]} has no value for 5.1"):
            joined(tmp_path, tables, [*POSES, *mixed])


def test_another_quantity_of_two_tables_is_refused(tmp_path: Path) -> None:
    tables = {"pos": poses(), "force": throttle(TIME), "turn": throttle(TIME)}
    with pytest.raises(UserError, match=r"reads the tables force and turn.*map each to a column of its own"):
        joined(tmp_path, tables, [*POSES, "yaw_rate=force.port - turn.port"])


def test_a_run_ends_where_commands_sent_at_a_rate_end_and_it_is_reported(tmp_path: Path) -> None:
    tables = {"pos": poses(), "cmd": throttle(TIME[20:100])}
    run = joined(tmp_path, tables, COMMANDS)
    assert run.duration == pytest.approx(9.9 + 0.5 - 2.0)
    meta = (run.meta.model_extra or {})["joined"]
    assert "the first 2 s left out, without messages of cmd; the last 19.5 s left out" in meta


def test_a_pause_of_commands_sent_at_a_rate_is_a_bad_stretch_and_can_be_filled(tmp_path: Path) -> None:
    tables = {"pos": poses(), "cmd": throttle(np.delete(TIME, slice(100, 150)))}
    with pytest.raises(UserError, match=r"column throttle_port: cmd has no value for 5\.1 s; --fill SECONDS"):
        joined(tmp_path, tables, COMMANDS)
    run = joined(tmp_path, tables, COMMANDS, Wishes(fill=6.0))
    assert run.columns["throttle_port"][100:150] == pytest.approx(np.full(50, 0.5 + 0.1 * np.sin(9.9)))


def test_commands_sent_at_changes_are_held_to_the_end(tmp_path: Path) -> None:
    changes = np.cumsum(np.random.default_rng(2).exponential(0.5, 30)) - 0.5
    run = joined(tmp_path, {"pos": poses(), "cmd": throttle(changes)}, COMMANDS)
    assert run.time[-1] == pytest.approx(TIME[-1] - max(changes[0], 0.0), abs=0.1)
    assert run.columns["throttle_port"][-1] == 0.5 + 0.1 * np.sin(changes[-1])


def test_a_joypad_that_nobody_holds_ends_no_run(tmp_path: Path) -> None:
    joypad = {"t": TIME[:50], "thrust": 0.5 + 0.1 * np.sin(TIME[:50])}
    run = joined(tmp_path, {"pos": poses(), "joy": joypad}, [*POSES, "joy_thrust=joy.thrust"])
    assert run.duration == pytest.approx(TIME[-1])


PLACES = ["latitude=gps.lat", "longitude=gps.lon", "yaw=imu.psi"]


def test_places_are_interpolated_the_short_way_across_the_antimeridian(tmp_path: Path) -> None:
    pytest.importorskip("pyproj")
    east = 179.9995 + 1e-5 * np.arange(100)
    lon = np.where(east > 180.0, east - 360.0, east)
    gps = {"t": 0.2 * np.arange(100), "lat": np.full(100, -17.5), "lon": lon}
    imu = {"t": 0.1 + 0.2 * np.arange(100), "psi": np.full(100, 1.57)}
    run = joined(tmp_path, {"gps": gps, "imu": imu}, PLACES, Wishes(resample=7.0))
    steps = np.diff(run.columns["east"])
    assert steps == pytest.approx(np.full(len(steps), steps.mean()), rel=1e-3)
    assert np.abs(run.columns["longitude"]).max() <= 180.0


def test_longitudes_that_are_no_degrees_are_refused_in_joined_tables_too(tmp_path: Path) -> None:
    pytest.importorskip("pyproj")
    gps = {"t": TIME, "lat": np.full(300, 34.8), "lon": 13530.0 + 1e-3 * TIME}
    imu = {"t": TIME, "psi": np.zeros(300)}
    with pytest.raises(UserError, match="is no longitude in degrees"):
        joined(tmp_path, {"gps": gps, "imu": imu}, PLACES)
