"""Runs of a dataset that are imported again by a mapping of some of their columns."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, append_run, create_dataset, read_dataset
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.schema import DatasetMeta, RunMeta
from tests.support.from_scratch import written

TIME = np.round(0.1 * np.arange(100), 1)


def again(folder: Path, *mapping: str) -> list[Run]:
    """The runs of a dataset of a boat that sails north at 1 m/s, after a mapping."""
    zero = np.zeros(100)
    columns = {"time": TIME, "north": TIME, "east": zero, "heading": zero, "surge": zero + 1.0, "sway": zero}
    columns |= {"throttle_port": 0.01 * TIME, "throttle_starboard": -0.01 * TIME, "depth": zero + 3.0}
    about = {"mass": 15.0, "draught": 0.1, "water_density": 1000.0}
    twin = str(written(folder, "twin"))
    create_dataset(folder / "runs", DatasetMeta(vehicle=twin, sample_rate=10.0, source="measured", **about))
    entries = RunMeta.model_validate({"velocity_axes": "earth", "group": "lake"})
    append_run(folder / "runs", Run("trip", columns, entries))
    reading = Reading(mapping_of(list(mapping)))
    made = import_logs([folder / "runs"], "parquet", folder / "out", About(), Wishes(), reading)
    assert made.vehicle == "twin"
    return list(read_dataset(folder / "out").runs)


def test_columns_that_a_mapping_does_not_name_stay_as_they_are(tmp_path: Path) -> None:
    (run,) = again(tmp_path, "throttle_port=throttle_starboard", "throttle_starboard=throttle_port")
    assert run.columns["throttle_port"] == pytest.approx(-0.01 * TIME)
    assert run.columns["throttle_starboard"] == pytest.approx(0.01 * TIME)
    assert run.columns["north"] == pytest.approx(TIME)
    assert run.columns["depth"] == pytest.approx(np.full(100, 3.0))
    meta = run.meta.model_dump()
    assert (meta["velocity_axes"], meta["group"]) == ("earth", "lake")


def test_another_source_of_a_column_takes_its_place(tmp_path: Path) -> None:
    (run,) = again(tmp_path, "x=2 * north", "y=east", "u=2 * surge", "v=sway")
    assert run.columns["north"] == pytest.approx(2.0 * TIME)
    assert run.columns["surge"] == pytest.approx(np.full(100, 2.0))
    assert run.meta.velocity_axes is None


def test_rows_that_are_kept_are_runs_with_all_their_columns(tmp_path: Path) -> None:
    runs = again(tmp_path, "keep=where(abs(time - 5) > 0.15, 1, 0)")
    assert [(run.name, len(run.time)) for run in runs] == [("trip-1", 49), ("trip-2", 48)]
    assert runs[1].columns["north"][0] == pytest.approx(5.2)


def test_what_an_import_said_of_missing_and_unknown_columns_is_not_repeated_by_the_next(
    tmp_path: Path,
) -> None:
    twin = str(written(tmp_path, "twin"))
    zero = np.zeros(100)
    columns = {"time": TIME, "north": TIME, "east": zero, "heading": zero, "demand": 0.01 * TIME}
    about = {"mass": 15.0, "draught": 0.1, "water_density": 1000.0}
    create_dataset(
        tmp_path / "first", DatasetMeta(vehicle=twin, sample_rate=10.0, source="measured", **about)
    )
    said = {"commands": "missing: throttle_port", "unknown_columns": "demand, volts", "group": "lake"}
    append_run(tmp_path / "first", Run("trip", columns, RunMeta.model_validate(said)))

    both = Reading(mapping_of(["throttle_port=demand", "throttle_starboard=demand"]))
    second = import_logs([tmp_path / "first"], "parquet", tmp_path / "second", About(), Wishes(), both)
    entries = second.runs[0].model_dump()
    assert "commands" not in entries and entries["group"] == "lake"
    assert entries["unknown_columns"].startswith("demand;")
    fewer = Wishes(dropped=("demand",))
    third = import_runs([tmp_path / "second"], "parquet", tmp_path / "third", wishes=fewer)
    assert "unknown_columns" not in third.runs[0].model_dump()
