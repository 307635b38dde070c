"""A stranger's Minari file, in HDF5, reads no other file and no more numbers than the doctor takes."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swamp_rl.doctor.read import read_records
from swamp_rl.errors import UserError

h5py = pytest.importorskip("h5py", reason="h5py is not installed; Minari's folders are not tested")


def _claims_too_much(infos: Any, secret: Path) -> None:
    infos.create_dataset("time", shape=(2**33,), dtype="f8", chunks=(2**20,))


def _claims_wide_elements(infos: Any, secret: Path) -> None:
    infos.create_dataset("time", shape=(2**20,), dtype=("f8", (2**12,)), chunks=(1,))


def _claims_a_large_chunk(infos: Any, secret: Path) -> None:
    infos.create_dataset("time", shape=(8,), maxshape=(None,), dtype="f8", chunks=(2**27,), compression=1)


def _repeats_what_it_keeps_nothing_of(infos: Any, secret: Path) -> None:
    episode = infos.file["z"]
    del episode["infos"]
    episode.create_dataset("observations", shape=(2**20,), dtype="f4", chunks=(2**20,))
    episode.create_dataset("actions", shape=(1,), dtype="f8")
    for number in range(40):
        infos.file[f"again_{number}"] = episode


def _links(infos: Any, secret: Path) -> None:
    infos["time"] = infos.file["there"] = h5py.ExternalLink(str(secret), "/time")


def _links_within(infos: Any, secret: Path) -> None:
    infos.file["there"] = h5py.ExternalLink(str(secret), "/")
    infos["time"] = h5py.SoftLink("/there/time")


def _stores_elsewhere(infos: Any, secret: Path) -> None:
    infos.create_dataset("time", shape=(8,), dtype="f8", external=[(str(secret), 0, 64)])


def _shows_another(infos: Any, secret: Path) -> None:
    layout = h5py.VirtualLayout(shape=(8,), dtype="f8")
    layout[:] = h5py.VirtualSource(str(secret), "time", shape=(8,))
    infos.create_virtual_dataset("time", layout)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (_claims_too_much, "its episodes have more than"),
        (_claims_wide_elements, "'time' has no plain numbers"),
        (_claims_a_large_chunk, "'time' is stored in chunks of more than"),
        (_repeats_what_it_keeps_nothing_of, "its episodes have more than"),
        (_links, "'(time|there)' is a link"),
        (_links_within, "'(time|there)' is a link"),
        (_stores_elsewhere, "the values of 'time' are in another file"),
        (_shows_another, "the values of 'time' are in another file"),
    ],
)
def test_a_minari_file_names_no_other_file_and_claims_no_more_than_is_read(
    tmp_path: Path, make: Callable[[Any, Path], None], message: str
) -> None:
    secret, held = tmp_path / "secret.hdf5", tmp_path / "data" / "main_data.hdf5"
    held.parent.mkdir()
    with h5py.File(secret, "w") as file:
        file["time"] = np.arange(8.0)
    with h5py.File(held, "w") as file:
        make(file.create_group("z/infos"), secret)
    with pytest.raises(UserError, match=f"not a complete Minari file .*{message}"):
        read_records(tmp_path)


def test_a_minari_file_beyond_the_limit_of_size_is_refused_by_its_name(tmp_path: Path) -> None:
    held = tmp_path / "main_data.hdf5"
    with held.open("wb") as file:
        file.truncate(2**40)  # sparse
    with pytest.raises(UserError, match=r"main_data\.hdf5: .*larger than 8 GiB"):
        read_records(tmp_path)
