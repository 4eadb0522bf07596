"""What is read in the child process: by readers of other packages, whose C code a damaged file can crash."""

from __future__ import annotations

import io
import math
import struct
import zlib
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

#: Bytes of one number of the classes that scipy's ``whosmat`` names (layout).
_ITEM = {
    "single": 4,
    "int32": 4,
    "uint32": 4,
    "int16": 2,
    "uint16": 2,
    "char": 4,
    "int8": 1,
    "uint8": 1,
    "logical": 1,
}
#: Type of an element of a MATLAB file that holds another one, compressed (layout).
_COMPRESSED = 15


class TooLarge(Exception):
    """Reading would take so many bytes."""

    def __init__(self, needed: float) -> None:
        self.needed = needed
        super().__init__(needed)


def mat(raw: bytes, memory: float) -> dict[str, Any]:
    """The variables of a MATLAB file of version 4 to 7; those that are no arrays, structs or cells are left out."""
    from scipy.io import loadmat, whosmat

    stream: Any = io.BytesIO(raw)
    try:
        arrays = sum(math.prod(shape) * _ITEM.get(kind, 8) for _, shape, kind in whosmat(stream))
    except TypeError:  # scipy stumbles over MATLAB's own objects here, not when it reads
        arrays = 0
    # Three times: as read, on the way to the user's process, and the columns there.
    needed = 2.0 * len(raw) + 3.0 * max(arrays, _stored(raw, memory))
    if needed > memory:
        raise TooLarge(needed)
    stream.seek(0)
    variables = loadmat(stream, struct_as_record=True, squeeze_me=False)
    return {name: _simple(value) for name, value in variables.items() if not name.startswith("__")}


def _stored(raw: bytes, memory: float) -> float:
    """Bytes of all elements of a MATLAB file of version 5 to 7 once they are unpacked; counted no further than matters.

    A struct of a few bytes may hold gigabytes: ``whosmat`` counts it as one.
    """
    if raw[124:128] not in (b"\0\1IM", b"\1\0MI"):
        return 0.0
    order = "<" if raw[126:128] == b"IM" else ">"
    at, total = 128, 0.0
    while at + 8 <= len(raw) and total <= memory:
        kind, size = struct.unpack(f"{order}II", raw[at : at + 8])
        packed = memoryview(raw)[at + 8 : at + 8 + size]
        total += _unpacked(packed, memory) if kind == _COMPRESSED else size
        at += 8 + size
    return total


def _unpacked(packed: memoryview, most: float) -> float:
    """Bytes that a compressed element unpacks to, counted up to `most`."""
    step, total = zlib.decompressobj(), 0
    rest: Any = packed
    while rest and not step.eof and total <= most:
        total += len(step.decompress(rest, 1 << 20))
        rest = step.unconsumed_tail
    return float(total)


def _simple(value: Any) -> Any:
    """Arrays of numbers and texts, structs and cells; None for what else MATLAB has (functions, sparse matrices)."""
    if type(value) is not np.ndarray:
        return None
    if value.dtype.names:
        simple = np.empty(value.shape, dtype=[(name, object) for name in value.dtype.names])
        for name in value.dtype.names:
            simple[name] = _simple(value[name])
        return simple
    if value.dtype == object:
        simple = np.empty(value.shape, dtype=object)
        for place in np.ndindex(value.shape):
            simple[place] = _simple(value[place])
        return simple
    return value


def matrix_market(raw: bytes, memory: float) -> np.ndarray:
    """The matrix of a MatrixMarket file, filled with zeros where it is sparse."""
    from scipy.io import mminfo, mmread

    rows, columns = mminfo(io.BytesIO(raw))[:2]
    if (needed := 3.0 * 8.0 * rows * columns + 8.0 * len(raw)) > memory:
        raise TooLarge(needed)
    matrix = mmread(io.BytesIO(raw))
    return matrix if isinstance(matrix, np.ndarray) else matrix.toarray()


#: Reader of each foreign format: (bytes of the file, bytes of memory) → what the user's process gets.
READERS: Mapping[str, Callable[[bytes, float], Any]] = MappingProxyType(
    {"mat": mat, "matrix market": matrix_market}
)
