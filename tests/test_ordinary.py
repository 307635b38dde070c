"""Only a file with an end is read, and it is the one that was looked at."""

import errno
import os
from pathlib import Path

import pytest

from swamp_rl.ordinary import contents


def test_the_bytes_of_an_ordinary_file_are_read_through_a_link_only_if_it_may_be_followed(
    tmp_path: Path,
) -> None:
    file, link = tmp_path / "file", tmp_path / "link"
    file.write_bytes(b"held")
    link.symlink_to(file)
    assert contents(file) == contents(link) == contents(file, follow=False) == b"held"
    with pytest.raises(OSError) as refused:
        contents(link, follow=False)
    assert refused.value.errno == errno.ELOOP


def test_a_pipe_a_folder_and_a_device_are_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", tmp_path, Path("/dev/zero")):
        with pytest.raises(OSError, match="not a regular file"):
            contents(path)


@pytest.mark.parametrize(("size", "most"), [(11, 10), (2**40, 2**30)])
def test_a_file_that_is_too_large_is_refused_before_it_is_read(size: int, most: int, tmp_path: Path) -> None:
    with (tmp_path / "file").open("wb") as file:
        file.truncate(size)
    with pytest.raises(OSError, match="is larger than"):
        contents(tmp_path / "file", most)


def test_a_file_exchanged_as_it_is_opened_is_the_one_that_is_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, opening = tmp_path / "file", os.open
    path.write_bytes(b"held")

    def exchange(*given: object) -> int:
        path.unlink()
        os.mkfifo(path)
        return opening(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(os, "open", exchange)
    with pytest.raises(OSError, match="not a regular file"):
        contents(path)


def test_no_descriptor_is_left_open(tmp_path: Path) -> None:
    before = sorted(os.listdir("/proc/self/fd"))
    for _ in range(3):
        with pytest.raises(OSError):
            contents(tmp_path)
    assert sorted(os.listdir("/proc/self/fd")) == before
