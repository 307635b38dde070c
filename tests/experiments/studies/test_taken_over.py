"""What an evaluation takes over from a folder of trained pilots, which may be a stranger's."""

import os
import resource
from pathlib import Path

import pytest
from swamp_rl.experiments.artifacts.job import job
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene

from swamp_rl.errors import UserError


@pytest.fixture(scope="module")
def scene() -> Scene:
    return read_scene(load_experiment("smoke"))


@pytest.fixture
def trained(tmp_path: Path) -> Path:
    """A folder of one pilot, with a folder in it, and a private file beside it."""
    (tmp_path / "trained" / "pilots" / "net" / "more").mkdir(parents=True)
    (tmp_path / "trained" / "pilots" / "net" / "weights").write_text("weights")
    (tmp_path / "trained" / "pilots" / "net" / "more" / "notes").write_text("notes")
    (tmp_path / "private").mkdir()
    (tmp_path / "private" / "key").write_text("secret")
    return tmp_path / "trained"


def taken_over(scene: Scene, trained: Path) -> dict[str, str]:
    """The text of each file of pilots in the finished folder, by its path there."""
    out = trained.with_name("out")
    with job(scene, out, (), trained):
        pass
    return {
        path.relative_to(out).as_posix(): path.read_text()
        for path in out.glob("pilots/**/*")
        if path.is_file()
    }


def test_pilots_are_taken_over_whole(scene: Scene, trained: Path) -> None:
    assert taken_over(scene, trained) == {
        "pilots/net/weights": "weights",
        "pilots/net/more/notes": "notes",
    }


@pytest.mark.parametrize("place", ["pilots/net/link", "pilots/link", "tensorboard", "data/link"])
@pytest.mark.parametrize("target", ["private", "private/key"])
def test_a_link_among_them_is_refused_and_nothing_that_it_leads_to_is_copied(
    scene: Scene, trained: Path, place: str, target: str
) -> None:
    (trained / place).parent.mkdir(exist_ok=True)
    (trained / place).symlink_to(trained.parent / target)
    with pytest.raises(UserError, match=f"{place}: is a link; put a copy"):
        taken_over(scene, trained)
    assert sorted(os.listdir(trained.parent)) == ["private", "trained"]


def test_a_pipe_among_them_is_refused_in_one_line(scene: Scene, trained: Path) -> None:
    os.mkfifo(trained / "pilots" / "net" / "pipe")
    with pytest.raises(UserError) as caught:
        taken_over(scene, trained)
    assert str(caught.value).startswith(f"{trained}/pilots/net/pipe: is not a regular file")


def test_a_file_that_cannot_be_copied_names_the_folder_of_results(scene: Scene, trained: Path) -> None:
    (trained / "pilots" / "net" / "weights").write_bytes(bytes(2**21))
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**20, limits[1]))
    try:
        with pytest.raises(UserError, match=f"^{trained.with_name('out')}: File too large; "):
            taken_over(scene, trained)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
