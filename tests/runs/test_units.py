"""Units of other programs' columns: what one of each is in the unit of the column that it is given for."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.doctor.kinematics import SPEEDS, TURNS
from swamp_rl.errors import UserError
from swamp_rl.runs import Run, read_dataset, write_run
from swamp_rl.runs.import_dataset import import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.units import factor
from tests.support.runs import circling


def test_units_are_those_of_the_definitions() -> None:
    assert factor("surge", "kn") == pytest.approx(0.514444, abs=1e-6)
    assert 180 * factor("heading", "deg") == pytest.approx(math.pi)
    assert 3600 * factor("propeller_main", "rpm") == pytest.approx(60.0)
    assert factor("surge", "ft/s") == pytest.approx(0.3048)


def test_a_unit_has_the_value_that_the_unit_of_its_column_asks_for() -> None:
    assert factor("yaw_rate", "rpm") == pytest.approx(2.0 * math.pi * factor("propeller_main", "rpm"))
    assert factor("yaw_rate", "rpm") == factor("r", "rpm", "yaw_rate")
    assert factor("latitude", "deg") == 1.0
    assert factor("shaft_speed", "rpm") == pytest.approx(1.0 / 60.0)


@pytest.mark.parametrize(
    ("column", "units"), [("surge", SPEEDS), ("yaw_rate", TURNS)], ids=["speeds", "rates of turn"]
)
def test_the_doctors_units_are_those_of_the_import(column: str, units: dict[str, float]) -> None:
    for unit, ratio in units.items():
        assert factor(column, unit) * ratio == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "unit", "known"),
    [
        ("yaw_rate", "deg", "deg/s, deg/min, rpm"),
        ("surge", "km", "kn, km/h"),
        ("throttle_port", "rpm", "percent"),
        ("throttle_port", "us", r"percent, or .*--map 'throttle_port=\(COLUMN-1500\)/400'"),
        ("time", "kn", "ms, us"),
    ],
)
def test_a_unit_of_another_quantity_is_refused_with_those_that_fit(name: str, unit: str, known: str) -> None:
    with pytest.raises(
        UserError, match=rf"^column {name}: {unit} is not a unit of it; give one of .*{known}"
    ):
        factor(name, unit)


def test_a_yaw_rate_in_revolutions_a_minute_is_imported_in_radians_a_second(tmp_path: Path) -> None:
    columns = circling()
    turning = columns["yaw_rate"] * 60.0 / math.tau
    write_run(tmp_path / "one.csv", Run("one", columns | {"yaw_rate": turning}))
    import_runs([tmp_path / "one.csv"], "csv", tmp_path / "out", None, Wishes(units={"yaw_rate": "rpm"}))
    (run,) = read_dataset(tmp_path / "out").runs
    assert np.allclose(run.columns["yaw_rate"], columns["yaw_rate"], atol=1e-12)
    with pytest.raises(UserError, match="column yaw_rate: kn is not a unit of it"):
        import_runs([tmp_path / "one.csv"], "csv", tmp_path / "no", None, Wishes(units={"yaw_rate": "kn"}))
    assert not (tmp_path / "no").exists()
