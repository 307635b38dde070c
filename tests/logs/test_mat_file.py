"""Variables of MATLAB's files: those that scipy writes, and damaged files."""

import io
import struct
import zlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.io import savemat

from swamp_rl.logs.mat_file import HEADER, variables

MOST = 1000
TYPES = ("f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "bool")
matrices = st.sampled_from(TYPES).flatmap(
    lambda kind: arrays.arrays(
        np.dtype(kind), arrays.array_shapes(min_dims=2, max_dims=2, min_side=0, max_side=7)
    )
)
names = st.from_regex(r"[a-zA-Z]\w{0,25}", fullmatch=True).filter(str.isascii)


def saved(held: dict[str, Any], compressed: bool = False) -> bytes:
    file = io.BytesIO()
    savemat(file, held, do_compression=compressed)
    return file.getvalue()


@given(st.dictionaries(names, matrices, max_size=4), st.booleans())
def test_matrices_of_every_type_are_read_as_they_were_written(held: dict[str, Any], compressed: bool) -> None:
    read = {one.name: one.values for one in variables(saved(held, compressed), MOST)}
    assert read.keys() == held.keys()
    for name, values in held.items():
        np.testing.assert_array_equal(read[name], values.astype(float))


def test_variables_of_other_kinds_have_a_name_and_no_values() -> None:
    held = {
        "note": "calm",
        "gains": {"p": 1.0},
        "cells": np.array([[1, "a"]], object),
        "z": np.ones((2, 2)) * 1j,
    }
    found = list(variables(saved(held), MOST))
    assert {one.name for one in found} == set(held)
    assert all(one.values is None for one in found)


def test_a_file_of_the_other_order_of_bytes_is_read() -> None:
    def element(kind: int, body: bytes) -> bytes:
        return struct.pack(">II", kind, len(body)) + body + bytes(-len(body) % 8)

    flags, sizes = element(6, struct.pack(">II", 6, 0)), element(5, struct.pack(">ii", 3, 1))
    matrix = flags + sizes + element(1, b"speed") + element(9, struct.pack(">3d", 0.5, -1.0, 2.0))
    (found,) = variables(bytes(HEADER - 4) + b"\x01\x00MI" + element(14, matrix), MOST)
    assert found.name == "speed" and found.values is not None
    assert found.values.tolist() == [[0.5], [-1.0], [2.0]]


def test_sizes_that_contradict_the_numbers_are_refused() -> None:
    whole = saved({"speed": np.arange(50.0)[:, None]})
    sizes = struct.pack("<ii", 50, 1)
    for wrong in ((51, 1), (50, 2), (2**31 - 1, 2**31 - 1), (-50, -1), (0, 1)):
        with pytest.raises(ValueError, match=r"numbers of a matrix|cut off"):
            list(variables(whole.replace(sizes, struct.pack("<ii", *wrong), 1), MOST))


@given(st.integers(HEADER + 1, 600))
def test_a_file_that_is_cut_off_is_refused(length: int) -> None:
    whole = saved({"speed": np.arange(60.0)[:, None]})
    with pytest.raises(ValueError, match="cut off"):
        list(variables(whole[:length], MOST))


def test_more_numbers_than_allowed_are_refused_before_they_are_unpacked() -> None:
    many = {"speed": np.zeros((100 * MOST, 1))}
    for compressed in (False, True):
        with pytest.raises(ValueError, match=r"too large|numbers of a matrix"):
            list(variables(saved(many, compressed), MOST))
    bomb = zlib.compress(bytes(2**24))
    with pytest.raises(ValueError, match="too large"):
        list(variables(saved({})[:HEADER] + struct.pack("<II", 15, len(bomb)) + bomb, MOST))
