"""Reading an .npz: what it asks for is compared with what it holds before any memory is taken."""

from __future__ import annotations

import io
import math
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from ...errors import InvalidInput
from ...memory import check_memory
from .whole_files import read_bytes

#: Longest header of an array that numpy reads, bytes, and what stands before it (layout).
_HEADER = 10_000 + 12
_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_npz(path: str | Path, expected: str) -> dict[str, np.ndarray]:
    """The arrays of an .npz by name; ``expected`` says what it should be.

    Raises
    ------
    InvalidInput
        If the file cannot be read, is damaged, holds Python objects, or would take more than the memory limit.
    """
    return unpacked(read_bytes(path), str(path), expected)


def unpacked(raw: bytes, where: str, expected: str) -> dict[str, np.ndarray]:
    """The arrays of an .npz that was read already."""
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as file:
            members = file.infolist()
            if any(member.filename == "[Content_Types].xml" for member in members):
                raise InvalidInput(where, "a spreadsheet", expected, "Save it as CSV.")
            size = sum(member.file_size for member in members)
            check_memory(
                where,
                f"arrays of {size / 1e6:.3g} MB",
                len(raw) + 3.0 * size,
                "Save a part of the recording.",
            )
            arrays: dict[str, np.ndarray] = {}
            for member in members:
                name = member.filename.removesuffix(".npy")
                if name in arrays:
                    raise ValueError(f"the array {name!r} comes twice")
                with file.open(member) as stream:
                    arrays[name] = _array(stream, member.file_size)
            return arrays
    except InvalidInput:
        raise
    except Exception as error:  # zipfile and numpy raise many kinds on a damaged file
        got = "a damaged file" if isinstance(error, zipfile.BadZipFile) else f"a damaged file: {error}"
        raise InvalidInput(where, got, expected, "Copy it again; save a spreadsheet as CSV.") from None


def _array(stream: Any, size: int) -> np.ndarray:
    """The array of one member of `size` bytes: numpy itself takes memory for whatever a header asks for."""
    header = io.BytesIO(stream.read(_HEADER))
    version = npy.read_magic(header)
    if version not in _HEADERS:
        raise ValueError(f"an array of format {version}")
    shape, fortran, dtype = _HEADERS[version](header)
    start = header.tell()
    if dtype.hasobject or start + math.prod(shape) * dtype.itemsize != size:
        raise ValueError(f"an array of shape {shape} in {size - start} bytes")
    content = header.getvalue()[start:] + stream.read()
    return np.frombuffer(content, dtype).reshape(shape, order="F" if fortran else "C")
