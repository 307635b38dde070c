"""Options that a complaint about a mapped column names: those that a mapping takes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.doctor.examine import examine
from swamp_rl.errors import UserError
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from tests.support.from_scratch import written
from tests.support.logs import csv_of, weaving

MAP = ["time=t", "x=n", "y=e", "yaw=psi", "throttle_port=port", "throttle_starboard=stb"]


@pytest.fixture
def boat(tmp_path: Path) -> str:
    return str(written(tmp_path, "twin"))


def imported(
    folder: Path,
    boat: str,
    more: list[str],
    units: dict[str, str],
    frame: str = "ned",
    mapped: Sequence[str] = MAP,
) -> Run:
    """The run of a log with a surge, a yaw rate in degrees a second, velocities and words."""
    was = weaving()
    columns = {"t": was["time"], "n": was["north"], "e": was["east"], "psi": was["heading"]}
    columns |= {"port": was["throttle_port"], "stb": was["throttle_starboard"]}
    columns |= {"speed": was["surge"], "turn": np.degrees(was["yaw_rate"])}
    columns |= {"vn": np.gradient(was["north"], was["time"]), "ve": np.gradient(was["east"], was["time"])}
    cells = {name: [repr(float(value)) for value in column] for name, column in columns.items()}
    log = csv_of(folder / "log.csv", {**cells, "mode": ["AUTO"] * 301})
    reading = Reading(mapping_of([*mapped, *more], frame))
    import_logs([log], "csv", folder / "out", About(boat=boat), Wishes(units=units), reading)
    (run,) = read_dataset(folder / "out").runs
    return run


@pytest.mark.parametrize(
    ("more", "part"),
    [
        (["r=turn"], "column yaw_rate: looks like degrees: .* \\(--unit r=deg/s\\)"),
        (
            ["yaw_rate=turn"],
            "column yaw_rate: looks like degrees: it is 57.* times .* \\(--unit yaw_rate=deg/s\\)",
        ),
        (["depth=mode"], "column depth: 'AUTO' is not a number; .* or leave the column out of the mapping"),
        (["Surge=speed"], "column Surge: is surge of the run format; name it so in the mapping"),
        (["throttle_bow=port"], "column throttle_bow: .* \\(--map, --boat\\)"),
    ],
)
def test_a_hint_names_an_option_that_a_mapping_takes(
    tmp_path: Path, boat: str, more: list[str], part: str
) -> None:
    with pytest.raises(UserError, match=part) as error:
        imported(tmp_path, boat, more, {})
    assert "--column" not in str(error.value) and "--drop" not in str(error.value)


def test_the_hint_for_a_log_of_velocities_gives_the_positions(tmp_path: Path, boat: str) -> None:
    rest = [one for one in MAP if one[:2] not in ("x=", "y=")]
    with pytest.raises(UserError, match=r"column north: .* --map 'north=integral\(VELOCITY\)'"):
        imported(tmp_path, boat, [], {}, mapped=rest)
    run = imported(tmp_path, boat, ["north=integral(vn)", "east=integral(ve)"], {}, mapped=rest)
    for name in ("north", "east"):
        np.testing.assert_allclose(run.columns[name], weaving()[name] - weaving()[name][0], atol=0.02)


@pytest.mark.parametrize(
    ("given", "frame", "hint"),
    [("surge", "ned", "u becomes surge: --unit u=kn"), ("north", "enu", "y becomes north: --unit y=kn")],
)
def test_a_unit_of_what_a_quantity_becomes_is_refused_with_its_name(
    tmp_path: Path, boat: str, given: str, frame: str, hint: str
) -> None:
    with pytest.raises(
        UserError, match=f"--unit or --degrees {given}: the mapping has no such column.*{hint}"
    ):
        imported(tmp_path, boat, ["u=speed"], {given: "kn"}, frame)


def test_a_unit_is_kept_with_the_run_and_a_wrong_one_is_reported_by_the_right_one(
    tmp_path: Path, boat: str
) -> None:
    run = imported(tmp_path, boat, ["u=3.6*speed"], {"u": "kn"})
    assert (run.meta.model_extra or {})["units"] == {"surge": "kn"}
    (finding,) = [finding for finding in examine([run]) if finding.code == "unit"]
    assert "is 1.85 times the speed" in str(finding) and "as km/h are that were taken for kn" in str(finding)
    assert "--unit surge=km/h" in str(finding)


@pytest.mark.parametrize(("most", "percent"), [(205.0, False), (2.05, False), (85.0, True)])
def test_revolutions_as_a_throttle_are_not_taken_for_percent(
    tmp_path: Path, boat: str, most: float, percent: bool
) -> None:
    mapped = [*MAP[:4], f"throttle_port=port*0+{most}", "throttle_starboard=stb"]
    with pytest.raises(UserError) as refused:
        imported(tmp_path, boat, [], {}, mapped=mapped)
    told = (
        "it looks like percent"
        if percent
        else f"it reaches {most:g}; divide it by its value at full throttle"
    )
    assert told in str(refused.value)
