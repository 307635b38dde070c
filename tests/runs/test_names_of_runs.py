"""Runs of imported files have names of their own, by the files and, where these agree, by the folders."""

from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.runs import read_dataset, write_run
from swamp_rl.runs.import_dataset import import_runs
from swamp_rl.runs.run import Run
from tests.support.runs import circling

TWINS = ["log.csv", "LOG.csv"]  # one file, where a file system folds cases


def logs(folder: Path, *names: str) -> list[Path]:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_run(folder / name, Run(Path(name).stem, circling()))
    return [folder / name for name in names]


@pytest.mark.parametrize("twin", TWINS)
def test_files_of_one_name_in_a_source_are_refused(twin: str, tmp_path: Path) -> None:
    paths = logs(tmp_path / "in", "a/log.csv", f"b/{twin}")
    for sources in ([tmp_path / "in"], [paths[0], paths[0]]):
        with pytest.raises(UserError, match="same name"):
            import_runs(sources, "csv", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("twin", TWINS)
def test_files_of_one_name_in_several_sources_have_the_names_of_their_folders(
    twin: str, tmp_path: Path
) -> None:
    paths = logs(tmp_path, "day 1/log.csv", f"day 2/{twin}")
    expected = ["day 1-log", f"day 2-{Path(twin).stem}"]
    for sources in (paths, [path.parent for path in paths]):
        out = tmp_path / f"of {sources[0].stem}"
        import_runs(sources, "csv", out)
        assert [run.name for run in read_dataset(out).runs] == expected
