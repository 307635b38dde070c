"""Tables with missing columns, empty cells and impossible numbers end in findings, whatever they hold."""

import json
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import load_boat
from swamp_rl.doctor.examine import examine
from swamp_rl.doctor.finding import Finding
from swamp_rl.runs import Run

Columns = dict[str, np.ndarray]
SWAMP = load_boat("swamp")
ROWS = 80
COMMANDS = [name for thruster in SWAMP.thrusters for name in thruster.command_columns if name is not None]
MEASURED = ["north", "east", "heading", "surge", "yaw_rate", "wind_speed"]
RESPONSE = {"commands_exchanged", "levels_flipped", "angles_flipped", "latency"}
ODD = [np.nan, np.inf, -np.inf, 1e308, -1e160, 1e30, 1e19, 1e4, 100.0, 0.0, -1.0, 1e-170, 5e-324]


def table(seed: int = 1) -> Columns:
    """Rows of a boat that goes ahead, its commands and its course wandering."""
    rng, time = np.random.default_rng(seed), 0.1 * np.arange(ROWS)
    found = {"time": time} | {name: 0.1 * rng.standard_normal(ROWS).cumsum() for name in MEASURED}
    found |= {"north": time + 0.01 * found["north"], "heading": 0.1 * found["heading"]}
    found |= {name: np.clip(0.5 + 0.05 * rng.standard_normal(ROWS).cumsum(), 0.0, 1.0) for name in COMMANDS}
    return found


def named(findings: list[Finding], code: str) -> set[str]:
    return {name for finding in findings if finding.code == code for name in finding.columns}


def test_a_run_without_a_command_of_the_others_is_left_out_of_the_response() -> None:
    angle = next(name for name in COMMANDS if name.startswith("azimuth_"))
    lacking = Run("b", {name: values for name, values in table(2).items() if name != angle})
    holed = Run("b", table(2) | {angle: np.where(np.arange(ROWS) == 20, np.nan, table(2)[angle])})
    alone = examine([Run("a", table())], SWAMP)
    for runs in ([Run("a", table()), lacking], [lacking, Run("a", table())], [Run("a", table()), holed]):
        assert RESPONSE & {one.code for one in examine(runs, SWAMP)} <= {one.code for one in alone}


@pytest.mark.parametrize("place", [0, 1])
def test_percent_is_found_in_whichever_run_has_it(place: int) -> None:
    lacking = {name: values for name, values in table().items() if not name.startswith("throttle_")}
    runs = [Run("a", table(2) | {"throttle_bs": 100.0 * table(2)["throttle_bs"]})]
    runs.insert(place, Run("b", lacking))
    found = examine(runs, SWAMP)
    assert named(found, "unit") == {"throttle_bs"}


def test_degrees_are_found_beside_an_empty_table_and_after_an_empty_cell() -> None:
    degrees = table() | {"heading": np.degrees(table()["heading"]) + 20.0}
    degrees["heading"][0] = np.nan
    empty = {name: np.zeros(0) for name in degrees}
    assert named(examine([Run("a", degrees), Run("b", empty)]), "unit") == {"heading"}


@pytest.mark.parametrize("name", ["azimuth_bs", "heading"])
def test_an_angle_that_counts_twenty_turns_is_not_in_degrees(name: str) -> None:
    rows = 10 * ROWS
    turning = {"time": 0.2 * np.arange(rows), name: np.linspace(0.0, 40.0 * np.pi, rows)}
    assert named(examine([Run("a", turning)]), "unit") == set()
    assert named(examine([Run("a", turning | {name: np.degrees(turning[name])})]), "unit") == {name}


def test_rows_without_a_time_are_left_out_and_the_gap_has_a_size() -> None:
    columns = table()
    columns["time"][20] = np.nan
    (found,) = [finding for finding in examine([Run("a", columns)]) if "time" in finding.columns]
    assert found.code == "time_jump" and found.figures["largest_step_s"] == pytest.approx(0.2)
    columns["time"][:] = np.nan
    assert named(examine([Run("a", columns)]), "no_number") == {"time"}


def test_an_infinite_value_is_reported_with_its_row() -> None:
    columns = table()
    columns["north"][20] = np.inf
    (found,) = [finding for finding in examine([Run("a", columns)]) if finding.code == "no_number"]
    assert found.columns == ("north",) and "row 21 of a" in found.message


def spoiled(name: str, rng: np.random.Generator, rows: int) -> np.ndarray:
    """A column as it is, or with odd values in one cell, several, the rest or all, or of another scale."""
    values, odd, how = table(rng.integers(100))[name][:rows], rng.choice(ODD), rng.integers(12)
    if how < 4 and rows:
        first = rng.integers(rows)
        places = [first, rng.integers(rows, size=3), slice(first, rows), slice(None)]
        values[places[how]] = odd
    return values * odd if how == 4 else values + odd if how == 5 else values


@given(seed=st.integers(0, 2**32), known=st.booleans(), measured=st.booleans())
def test_any_tables_end_in_findings_that_are_valid_json(seed: int, known: bool, measured: bool) -> None:
    rng = np.random.default_rng(seed)
    runs = []
    for number in range(rng.integers(1, 4)):
        share, rows = rng.choice([0.7, 0.95, 1.0]), int(rng.choice([ROWS, ROWS, ROWS, 25, 3, 1, 0]))
        names = [name for name in table() if rng.random() < share]
        runs.append(Run(f"run-{number}", {name: spoiled(name, rng, rows) for name in names}))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of computing with such numbers
        found = examine(runs, SWAMP if known else None, measured)
    json.dumps([finding.as_json() for finding in found], allow_nan=False)
    assert all("\n" not in str(finding) and "nan" not in str(finding).split() for finding in found)
