"""Round trips: what goes out to another format comes back equal, to the bit where the format has float64."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from swamp_rl.errors import UserError
from swamp_rl.runs import Dataset, DatasetMeta, Run, RunMeta, append_run, create_dataset, read_dataset
from swamp_rl.runs.export_dataset import export_runs
from swamp_rl.runs.import_dataset import import_runs
from swamp_rl.runs.mcap_files import read_mcap, write_mcap
from tests.support.runs import circling, described

META = RunMeta.model_validate(
    {
        "seed": 3,
        "outcome": "success",
        "initial_state": {"north": 0.1, "surge": 1e-17},
        "disturbances": [{"effect": "current", "north": 0.1 + 0.2}],
        "gust_seed": 2**63 - 1,
    }
)


@pytest.fixture
def dataset(tmp_path: Path) -> Dataset:
    """Two runs whose numbers need all their bits, the second shorter, failed, and not from time nought."""
    folder = tmp_path / "runs"
    create_dataset(folder, described(notes="öre: 'x'", licence="CC0"))
    rng = np.random.default_rng(5)
    for name, seconds, meta in (("one", 3.0, META), ("two", 1.2, RunMeta(outcome="buoy"))):
        columns = circling(seconds)
        columns["north"] = columns["north"] + rng.normal(size=len(columns["time"])) * 1e-9
        columns["temperature"] = rng.normal(size=len(columns["time"])) * 1e30
        append_run(folder, Run(name, columns, meta))
    return read_dataset(folder)


def assert_same(found: list[Run], wanted: list[Run]) -> None:
    assert [run.name for run in found] == [run.name for run in wanted]
    for one, other in zip(found, wanted, strict=True):
        assert list(one.columns) == list(other.columns)
        for name, values in other.columns.items():
            assert one.columns[name].tobytes() == values.tobytes(), name
        assert one.meta.model_dump(exclude={"file"}) == other.meta.model_dump(exclude={"file"})


@pytest.mark.parametrize("to", ["csv", "parquet", "mcap"])
def test_tables_and_mcap_come_back_to_the_bit_with_all_that_was_described(
    dataset: Dataset, tmp_path: Path, to: str
) -> None:
    assert export_runs(dataset.folder, to, tmp_path / "out") == 2
    import_runs([tmp_path / "out"], to, tmp_path / "back")
    back = read_dataset(tmp_path / "back")
    assert_same(back.runs, dataset.runs)
    assert back.meta.model_copy(update={"runs": []}) == dataset.meta.model_copy(update={"runs": []})


def test_minari_reads_its_own_format_and_gives_every_column_to_the_bit(
    dataset: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import minari

    export_runs(dataset.folder, "minari", tmp_path / "Two Runs!")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "Two Runs!"))
    loaded = minari.load_dataset("two-runs-v0")
    assert (loaded.total_episodes, loaded.total_steps) == (2, 30 + 12)
    found = []
    for number, (episode, run) in enumerate(zip(loaded.iterate_episodes(), dataset.runs, strict=True)):
        state = run.stacked(("north", "east", "heading", "surge", "sway", "yaw_rate"))
        assert episode.observations.tobytes() == state.tobytes()
        assert np.array_equal(episode.actions, run.joypad[:-1])
        assert episode.rewards.sum() == (run.meta.outcome == "success") == episode.rewards[-1]
        assert episode.terminations[-1] and not episode.terminations[:-1].any()
        assert not episode.truncations.any()
        metadata = next(iter(loaded.storage.get_episode_metadata([number])))
        kept = json.loads(metadata["options"]["run"])
        assert kept.pop("name") == run.name
        meta = RunMeta.model_validate(kept | {"rows": run.meta.rows})
        columns = {name: np.asarray(episode.infos[name]) for name in run.columns}
        found.append(Run(run.name, columns, meta))
    assert_same(found, dataset.runs)
    metadata = DatasetMeta.model_validate(json.loads(loaded.storage.metadata["swamp_rl"]))
    assert metadata == dataset.meta.model_copy(update={"runs": []})


def test_a_run_cut_short_by_time_is_truncated_not_terminated(tmp_path: Path) -> None:
    import minari

    create_dataset(tmp_path / "runs", described())
    append_run(tmp_path / "runs", Run("late", circling(), RunMeta(outcome="timeout")))
    export_runs(tmp_path / "runs", "minari", tmp_path / "out")
    episode = next(minari.MinariDataset(tmp_path / "out" / "out-v0" / "data").iterate_episodes())
    assert episode.truncations[-1] and not episode.terminations.any()
    assert episode.rewards.sum() == 0.0


def lerobot_runs(folder: Path) -> list[Run]:
    """The runs in a folder of LeRobot's layout, found by what its info and episodes say."""
    info = json.loads((folder / "meta" / "info.json").read_text())
    data = json.loads((folder / "meta" / "swamp_rl.json").read_text())
    episodes = pq.read_table(folder / "meta" / "episodes").to_pylist()
    found = []
    for episode, meta in zip(episodes, data["runs"], strict=True):
        place = info["data_path"].format(
            chunk_index=episode["data/chunk_index"], file_index=episode["data/file_index"]
        )
        table = pq.read_table(folder / place, filters=[("episode_index", "=", episode["episode_index"])])
        assert table.num_rows == episode["length"]
        columns = {}
        for feature, kind in info["features"].items():
            cells = np.array(table[feature].to_pylist())
            assert cells.dtype == np.dtype(kind["dtype"]) or kind["dtype"] == "float32"
            assert list(cells.reshape(len(cells), -1).shape[1:]) == kind["shape"]
            for j, name in enumerate(kind["names"] or [feature]):
                columns[name] = cells.reshape(len(cells), -1)[:, j].copy()
        found.append(Run(meta.pop("name"), columns, RunMeta.model_validate(meta)))
    return found


def test_lerobots_layout_gives_every_column_to_the_bit(dataset: Dataset, tmp_path: Path) -> None:
    export_runs(dataset.folder, "lerobot", tmp_path / "out")
    found = []
    for run, wanted in zip(lerobot_runs(tmp_path / "out"), dataset.runs, strict=True):
        columns = {name: run.columns[name] for name in wanted.columns}
        found.append(Run(run.name, columns, run.meta))
        steps = np.arange(len(wanted.time))
        assert np.array_equal(run.columns["frame_index"], steps)
        assert run.columns["timestamp"] == pytest.approx(steps / 10, abs=1e-6)
    assert_same(found, dataset.runs)


def test_lerobots_layout_is_that_of_version_three(dataset: Dataset, tmp_path: Path) -> None:
    export_runs(dataset.folder, "lerobot", tmp_path / "out")
    info = json.loads((tmp_path / "out" / "meta" / "info.json").read_text())
    assert info["codebase_version"] == "v3.0" and info["fps"] == 10
    assert (info["total_episodes"], info["total_frames"]) == (2, 31 + 13)
    assert info["features"]["action"]["names"] == ["joy_thrust", "joy_angle"]
    episodes = pq.read_table(tmp_path / "out" / "meta" / "episodes").to_pylist()
    assert [episode["dataset_from_index"] for episode in episodes] == [0, 31]
    assert [episode["dataset_to_index"] for episode in episodes] == [31, 44]
    tasks = pq.read_table(tmp_path / "out" / "meta" / "tasks.parquet")
    assert tasks["task"].to_pylist() == episodes[0]["tasks"] == ["pass the gates of camogli"]
    stats = json.loads((tmp_path / "out" / "meta" / "stats.json").read_text())
    surge = np.concatenate([run.columns["north"] for run in dataset.runs])
    assert stats["observation.state"]["mean"][0] == pytest.approx(surge.mean())
    assert stats["observation.state"]["count"] == [44]
    assert pq.ParquetFile(tmp_path / "out/data/chunk-000/file-000.parquet").num_row_groups == 2


@pytest.mark.parametrize("to", ["minari", "lerobot"])
def test_runs_of_different_columns_are_refused_and_nothing_is_left(
    dataset: Dataset, tmp_path: Path, to: str
) -> None:
    append_run(dataset.folder, Run("three", circling()))
    with pytest.raises(UserError, match="column temperature is not in both one and three"):
        export_runs(dataset.folder, to, tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]


@pytest.mark.parametrize("name", ["action", "observation.state", "timestamp", "task_index"])
def test_a_column_with_the_name_of_one_of_lerobots_features_is_refused(tmp_path: Path, name: str) -> None:
    create_dataset(tmp_path / "runs", described())
    columns = circling()
    append_run(tmp_path / "runs", Run("one", columns | {name: columns["time"]}))
    with pytest.raises(UserError, match=f"column {name} has another meaning in LeRobot; rename it"):
        export_runs(tmp_path / "runs", "lerobot", tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]


def test_an_export_never_replaces_what_is_there(dataset: Dataset, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with pytest.raises(UserError, match="already exists"):
        export_runs(dataset.folder, "csv", tmp_path / "out")


def test_a_boat_file_beside_the_runs_goes_with_them(tmp_path: Path) -> None:
    boat = tmp_path / "runs" / "mine.yaml"
    boat.parent.mkdir()
    boat.write_text("extends: swamp\nname: mine\n")
    create_dataset(boat.parent, described(vehicle="mine.yaml"))
    append_run(boat.parent, Run("a", circling()))
    export_runs(boat.parent, "csv", tmp_path / "out")
    import_runs([tmp_path / "out"], "csv", tmp_path / "back")
    assert (tmp_path / "back" / "mine.yaml").read_text() == boat.read_text()
    assert read_dataset(tmp_path / "back").meta.vehicle == "mine"


finite = st.floats(allow_nan=False, allow_infinity=False, width=64)


@given(values=arrays(np.float64, st.integers(2, 12), elements=finite))
def test_any_finite_number_survives_mcap(
    tmp_path_factory: pytest.TempPathFactory, values: np.ndarray
) -> None:
    path = tmp_path_factory.mktemp("mcap") / "a.mcap"
    columns = {"time": np.arange(len(values)) * 0.1, "any": values}
    write_mcap(path, Run("a", columns), described())
    assert read_mcap(path).table.columns["any"].tobytes() == values.tobytes()
