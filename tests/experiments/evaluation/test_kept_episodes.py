"""Episodes that an earlier life of an experiment kept: taken over, or refused where they are others."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.evaluation.episodes import Tried, try_pilots
from swamp_rl.experiments.sweep.trial import quiet

from swamp_rl.arrays_file import read_arrays, write_arrays
from swamp_rl.errors import UserError
from swamp_rl.pilots.scripted import ScriptedPilot

SETTINGS = ["evaluation.episodes=2", "evaluation.levels=[calm]", "evaluation.shown=1"]
ROW = np.zeros(2)


def tried(folder: Path) -> Tried:
    """The episodes of the scripted pilot, kept in a folder."""
    with quiet() as progress:
        return try_pilots(
            read_scene(load_experiment("smoke", SETTINGS)), {"p": ScriptedPilot(0)}, progress, folder
        )


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The arrays that are kept."""
    folder = tmp_path_factory.mktemp("kept")
    tried(folder)
    return read_arrays(folder / "p" / "calm.npz")


def test_what_is_kept_is_taken_over(kept: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "p").mkdir()
    write_arrays(tmp_path / "p" / "calm.npz", kept | {"table/time": kept["table/time"] + 1000.0})
    found = tried(tmp_path)
    assert (found.tables["p", "calm"]["time"] > 1000.0).all()
    (run,) = found.shown["p", "calm"]
    assert run.name == "p-calm-0" and np.array_equal(run.time, kept["p-calm-0/time"])


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("alone", ROW),
        ("../../evil/time", ROW),
        ("other/time", ROW),
        ("table/seed", ROW.astype(int)),
        ("table/outcome", ROW),
        ("table/time", np.array(["a", "b"])),
        ("table/time", np.array([np.nan, 1e308])),
        ("table/time", np.zeros((2, 10**3, 10**3))),
        ("table/energy", np.zeros(3)),
        ("table/more", np.zeros(2, dtype="c16")),
        ("p-calm-0/north", np.zeros(7)),
        ("p-calm-0/north", np.array(1.0)),
        ("p-calm-0/time", np.zeros(0)),
        ("table/seed", None),
        ("p-calm-0/north", None),
    ],
)
def test_other_arrays_are_refused(kept: dict[str, Any], name: str, values: Any, tmp_path: Path) -> None:
    (tmp_path / "p").mkdir()
    file = tmp_path / "p" / "calm.npz"
    changed = {key: array for key, array in (kept | {name: values}).items() if array is not None}
    write_arrays(file, changed)
    with pytest.raises(UserError, match=str(file)) as error:
        tried(tmp_path)
    assert "\n" not in str(error.value)
