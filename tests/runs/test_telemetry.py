"""The boat's telemetry: 40 fields a line become a run in metres, and a bad line is named."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.errors import UserError
from swamp_rl.runs import read_dataset
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.import_telemetry import FIELDS, read_telemetry
from tests.support.runs import circling

CAMOGLI = (44.3489, 9.1536)
START = 1568455200000  # ms, 14 September 2019


def lines(seconds: float = 3.0, **changes: object) -> list[list[str]]:
    """Telemetry of the boat that circles, by the ellipsoid's radii of curvature, in the thesis's digits."""
    columns = circling(seconds)
    a, f = 6378137.0, 1 / 298.257223563
    e2, latitude = f * (2 - f), math.radians(CAMOGLI[0])
    w = math.sqrt(1 - e2 * math.sin(latitude) ** 2)
    found = []
    for i, time in enumerate(columns["time"]):
        yaw = columns["heading"][i]
        cos, sin = math.cos(yaw), math.sin(yaw)
        values = dict.fromkeys(FIELDS, "0.000000") | {
            "sender": "101",
            "yaw": f"{yaw:.6f}",
            "latitude": f"{CAMOGLI[0] + math.degrees(columns['north'][i] * w**3 / (a * (1 - e2))):.8f}",
            "longitude": f"{CAMOGLI[1] + math.degrees(columns['east'][i] * w / a / math.cos(latitude)):.8f}",
            "position_flags": "31",
            "gyro_z": "0.250000",
            "orientation_11": f"{cos:.6f}",
            "orientation_12": f"{sin:.6f}",
            "velocity_north": f"{0.5 * cos:.6f}",
            "velocity_east": f"{0.5 * sin:.6f}",
            "velocity_flags": "63",
            "utc": str(START + round(1000 * time)),
            "utc_flags": "3",
        }
        found.append([str(value) for value in (values | changes).values()])
    return found


def write(path: Path, found: list[list[str]], end: str = "\n\0") -> Path:
    path.write_bytes("".join(" ".join(line) + end for line in found).encode())
    return path


def test_there_are_forty_fields_in_the_thesiss_order() -> None:
    assert len(FIELDS) == len(set(FIELDS)) == 40
    places = {1: "sender", 5: "latitude", 11: "position_flags", 12: "acceleration_x", 17: "gyro_z"}
    places |= {18: "magnetic_x", 21: "orientation_11", 29: "orientation_33", 30: "velocity_north"}
    places |= {35: "course_over_ground", 37: "velocity_flags", 39: "utc", 40: "utc_flags"}
    assert {number: FIELDS[number - 1] for number in places} == places


@pytest.mark.parametrize("end", ["\n", "\n\0", "\r\n\0"])
def test_a_circle_sailed_is_the_circle_read(tmp_path: Path, end: str) -> None:
    path = write(tmp_path / "day1.txt", lines(), end)
    made = import_runs([path], "telemetry", tmp_path / "out", About(course="camogli"))
    assert (made.sample_rate, made.source) == (10.0, "measured")
    run, true = read_dataset(tmp_path / "out").runs[0], circling()
    # Places have 8 decimals of a degree, a millimetre.
    for name, tolerance in (
        ("time", 1e-9),
        ("heading", 1e-6),
        ("surge", 2e-6),
        ("sway", 2e-6),
        ("yaw_rate", 0),
    ):
        assert run.columns[name] == pytest.approx(true[name], abs=tolerance), name
    for name in ("north", "east"):
        assert run.columns[name] - run.columns[name][0] == pytest.approx(true[name] - true[name][0], abs=2e-3)
    meta = run.meta.model_extra or {}
    assert meta["utc_start"] == START / 1000 and meta["sender"] == 101
    assert meta["origin"]["latitude"] == pytest.approx(CAMOGLI[0], abs=1e-7)
    assert {"gyro_z", "orientation_33", "height_above_sea", "utc_flags"} <= set(run.columns)


@pytest.mark.parametrize("ticks", [1e-3, 1.0, 1e3, 1e6])
def test_stamps_may_be_in_seconds_milliseconds_microseconds_or_nanoseconds(
    tmp_path: Path, ticks: float
) -> None:
    found = lines()
    for i, line in enumerate(found):
        line[38] = str(round((START + 1000 * i) * ticks) if ticks < 1 else (START + 1000 * i) * int(ticks))
    table = read_telemetry(write(tmp_path / "a.txt", found)).table
    assert table.columns["time"].tolist() == list(range(31))


def bad(index: int, field: int, value: str) -> list[list[str]]:
    found = lines()
    found[index][field - 1] = value
    return found


@pytest.mark.parametrize(
    ("found", "parts"),
    [
        ([*lines(), ["101"] * 39], ["line 32 has 39 fields"]),
        ([*lines(), ["101"] * 41], ["line 32 has 41 fields"]),
        (bad(4, 2, "1,5"), ["line 5, field 2 (yaw): '1,5' is no number"]),
        (bad(4, 5, "nan"), ["line 5, field 5 (latitude)"]),
        (bad(4, 39, "1e9"), ["line 5, field 39 (utc)", "whole number"]),
        (bad(4, 11, "30"), ["line 5, field 11 (position_flags)", "in 1 line(s)"]),
        (bad(4, 37, "0"), ["line 5, field 37 (velocity_flags)"]),
        (bad(0, 39, "12345"), ["line 1, field 39 (utc)", "not a time since 1970"]),
        (bad(4, 39, str(START)), ["row 5", "column time", "does not come after"]),
        (bad(4, 5, "91.0"), ["row 5", "column latitude"]),
        (bad(4, 1, "102"), ["senders [101, 102]", "--sender 101"]),
        ([], ["holds no line"]),
    ],
)
def test_a_bad_line_is_named_by_line_and_field(
    tmp_path: Path, found: list[list[str]], parts: list[str]
) -> None:
    path = write(tmp_path / "a.txt", found)
    with pytest.raises(UserError) as error:
        import_runs([path], "telemetry", tmp_path / "out")
    assert all(part in str(error.value) for part in ["a.txt", *parts]), str(error.value)
    assert [left.name for left in tmp_path.iterdir()] == ["a.txt"]


def test_a_yaw_in_degrees_is_noticed_by_the_matrix(tmp_path: Path) -> None:
    found = lines(20.0)
    for line in found:
        line[1] = f"{math.degrees(float(line[1])):.6f}"
    path = write(tmp_path / "a.txt", found)
    with pytest.raises(UserError, match=r"is in degrees.*--degrees heading"):
        read_telemetry(path)
    import_runs([path], "telemetry", tmp_path / "out", None, Wishes(units={"heading": "deg"}))
    run = read_dataset(tmp_path / "out").runs[0]
    assert run.columns["heading"] == pytest.approx(circling(20.0)["heading"], abs=1e-6)  # six decimals
    assert run.columns["surge"] == pytest.approx(np.full(201, 0.5), abs=2e-6)


def test_of_several_hulls_one_is_chosen_and_its_lines_keep_their_numbers(tmp_path: Path) -> None:
    both = [line for pair in zip(lines(), lines(sender="102"), strict=True) for line in pair]
    path = write(tmp_path / "a.txt", both)
    assert read_telemetry(path, 102).table.rows.tolist() == list(range(2, 63, 2))
    with pytest.raises(UserError, match="no line of sender 7"):
        read_telemetry(path, 7)


@given(garbage=st.one_of(st.binary(max_size=300), st.text("0123456789. -e\n", max_size=300).map(str.encode)))
def test_garbage_is_refused_in_one_line(tmp_path_factory: pytest.TempPathFactory, garbage: bytes) -> None:
    path = tmp_path_factory.mktemp("telemetry") / "a.txt"
    path.write_bytes(garbage)
    with pytest.raises(UserError) as error:
        read_telemetry(path)
    assert "\n" not in str(error.value)


def test_numbers_are_kept_as_they_were_sent(tmp_path: Path) -> None:
    found = lines(roll="-0.123456", height_above_sea="1.500001")
    columns = read_telemetry(write(tmp_path / "a.txt", found)).table.columns
    assert np.all(columns["roll"] == -0.123456) and np.all(columns["height_above_sea"] == 1.500001)
