"""Training says so where the runs that a pilot learns from lack what its evaluation holds."""

import json
from pathlib import Path

import pytest
from swamp_rl.experiments.studies.run import train_experiment

from swamp_rl.runs import Run, append_run, create_dataset, read_dataset
from tests.support.driving import accept, drive, session


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three runs of a recorder."""
    folder = tmp_path_factory.mktemp("driven") / "runs"
    game = session(folder)
    now = 0.0
    for _ in range(3):
        now = drive(game, now)
        accept(game)
    game.close()
    return folder


def cut_at_the_first_gate(folder: Path, out: Path, whole: int = 0) -> Path:
    """The runs as recorders once kept them, but for the first `whole`."""
    dataset = read_dataset(folder)
    create_dataset(out, dataset.meta)
    for number, run in enumerate(dataset.runs):
        assert run.meta.gates is not None
        first = 0 if number < whole else int((run.time < run.meta.gates[0]).sum())
        kept = {name: values[first:] for name, values in run.columns.items()}
        append_run(out, Run(run.name, kept, run.meta), "csv")
    return out


def printed_in_training(folder: Path, out: Path, capsys: pytest.CaptureFixture[str], *options: str) -> str:
    settings = [
        f"data.folder={folder}",
        "evaluation.episodes=50",
        "pilots.reservoir-alone.runs=3",
        "pilots.cloning.options.epochs=1",
        *options,
    ]
    train_experiment("camogli", settings, out, ["reservoir-alone", "cloning"])
    return capsys.readouterr().err


def test_runs_kept_from_the_first_thrust_cover_every_start(
    driven: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "evaluation" not in printed_in_training(driven, tmp_path / "out", capsys)


def test_runs_kept_from_the_first_gate_are_reported_in_one_line_a_learner(
    driven: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = printed_in_training(cut_at_the_first_gate(driven, tmp_path / "cut"), tmp_path / "out", capsys)
    lines = [line for line in output.splitlines() if "evaluation" in line]
    assert [line.split(": ")[1] for line in lines] == ["pilots.reservoir-alone", "pilots.cloning"]
    for line in lines:
        assert "no run covers the starts of the evaluation: 100 %" in line and "3 training runs" in line


def test_a_pilot_that_takes_over_later_is_not_reported(
    driven: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = cut_at_the_first_gate(driven, tmp_path / "cut")
    late = [f"pilots.{name}.takeover=3.0" for name in ("reservoir-alone", "cloning")]
    assert "evaluation" not in printed_in_training(cut, tmp_path / "out", capsys, *late)


def test_one_whole_run_covers_the_starts(
    driven: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mixed = cut_at_the_first_gate(driven, tmp_path / "mixed", whole=1)
    assert "evaluation" not in printed_in_training(mixed, tmp_path / "out", capsys)


def test_calm_runs_are_reported_where_the_pilot_is_tried_among_disturbances(
    driven: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = printed_in_training(driven, tmp_path / "out", capsys)
    lines = [line for line in output.splitlines() if "without disturbances" in line]
    assert [line.split(": ")[1] for line in lines] == ["pilots.reservoir-alone", "pilots.cloning"]
    for line in lines:
        assert "3 of 3 training runs" in line and "evaluated at standard, severe" in line
        assert line.endswith("--disturbances standard")


def test_of_calm_runs_that_an_experiment_records_its_own_key_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    train_experiment("smoke", ["data.record.disturbances=calm"], tmp_path / "out", ["cloning"])
    assert "if it fails there, set data.record.disturbances=standard\n" in capsys.readouterr().err


def test_calm_runs_suffice_for_calm_water(
    driven: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plans = {
        "pilots": {"echo": {"kind": "reservoir"}},
        "evaluation": {"levels": ["calm"], "episodes": 5, "seed": 1},
    }
    entries = {"name": "calm", "boat": "swamp", "course": "camogli", "data": {"folder": str(driven)}, **plans}
    (tmp_path / "calm.yaml").write_text(json.dumps(entries))
    train_experiment(tmp_path / "calm.yaml", out=tmp_path / "out")
    assert "without disturbances" not in capsys.readouterr().err


def test_runs_among_disturbances_are_not_reported_as_calm(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    game = session(tmp_path / "runs", "standard")
    now, kept = 0.0, 0
    while kept < 3:
        now = drive(game, now)
        kept += game.outcome == "success"
        accept(game)
    game.close()
    assert "without disturbances" not in printed_in_training(tmp_path / "runs", tmp_path / "out", capsys)
