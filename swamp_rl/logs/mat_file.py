"""Variables of MATLAB's files of versions 5 to 7, by MathWorks' description "MAT-File Format" (level 5).

scipy's reader ends the process where sizes in a damaged file contradict each other.
"""

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

HEADER = 128
ORDERS = {b"IM": "<", b"MI": ">"}
HDF5 = 0x0200
MATRIX, COMPRESSED = 14, 15
STORED = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
NUMERIC, OPAQUE, COMPLEX = range(6, 16), 17, 0x0800
WIDEST = 8
"""Bytes of a number."""


@dataclass(frozen=True)
class Variable:
    """A variable; values: of a real matrix of numbers, in its shape, None for any other kind."""

    name: str
    values: NDArray[np.float64] | None


def variables(data: bytes, most: int) -> Iterator[Variable]:
    """The variables of a file, of real matrices of numbers with their values.

    ValueError for a damaged file and for a variable of more than `most` numbers, NotImplementedError for
    another version.
    """
    order = ORDERS.get(data[HEADER - 2 : HEADER])
    if order is None or struct.unpack_from(f"{order}H", data, HEADER - 4)[0] == HDF5:
        raise NotImplementedError("of another version")
    for kind, body in _elements(memoryview(data)[HEADER:], order):
        if kind == COMPRESSED:
            kind, body = next(_elements(_inflated(body, WIDEST * most), order))
        if kind == MATRIX and body.nbytes:
            yield _variable(body, order, most)


def _elements(data: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Type and content of the elements one after the other; ValueError where one is cut off."""
    at = 0
    while at < len(data):
        if at + 8 > len(data):
            raise ValueError("an element is cut off")
        kind, size = struct.unpack_from(f"{order}II", data, at)
        begin, end = at + 8, at + 8 + size
        if kind >> 16:  # of up to four bytes, beside its type
            kind, size = kind & 0xFFFF, kind >> 16
            begin, end = at + 4, at + 4 + min(size, 4)
        if begin + size > len(data) or size != end - begin:
            raise ValueError("an element is cut off")
        yield kind, data[begin:end]
        at = end if kind == COMPRESSED else 8 * math.ceil(end / 8)


def _inflated(body: memoryview, most: int) -> memoryview:
    stream = zlib.decompressobj()
    try:
        made = stream.decompress(body, most + 2 * HEADER)
    except zlib.error as error:
        raise ValueError(str(error)) from error
    if not stream.eof:
        raise ValueError("a compressed variable is cut off, or too large")
    return memoryview(made)


def _variable(body: memoryview, order: str, most: int) -> Variable:
    parts = _elements(body, order)
    try:
        flags = int(_numbers(next(parts), order)[0])
        sizes = _numbers(next(parts), order) if flags & 0xFF != OPAQUE else np.zeros(0)
        name = bytes(next(parts)[1]).decode("latin-1")
        if flags & 0xFF not in NUMERIC or flags & COMPLEX or len(sizes) != 2:
            return Variable(name, None)
        shape = int(sizes[0]), int(sizes[1])
        values = _numbers(next(parts), order)
    except (StopIteration, IndexError) as error:
        raise ValueError("a variable is cut off") from error
    if min(shape) < 0 or math.prod(shape) != len(values) or len(values) > most:
        raise ValueError(f"{len(values)} numbers of a matrix of {shape[0]} by {shape[1]}")
    return Variable(name, values.reshape(shape, order="F").astype(float))


def _numbers(element: tuple[int, memoryview], order: str) -> NDArray[np.generic]:
    kind, body = element
    if kind not in STORED:
        raise ValueError(f"numbers of type {kind}")
    return np.frombuffer(body, f"{order}{STORED[kind]}")
