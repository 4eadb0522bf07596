"""Another structure in tables: cells, columns and dialects of a CSV; arrays of an .npz and of a MATLAB file."""

from __future__ import annotations

import io
import json
import random
import zipfile
from collections.abc import Callable
from typing import Any

import fuzz_trees
import numpy as np

_CELLS = (
    "", " ", "nan", "inf", "-inf", "1e308", "-1e308", "1e400", "1e12", "1_000", "١٢", "½", "1,5", "1.5.2", "0x1p3",
    "9" * 400, "1" * 20_000, '"', '"1', "'1'", "1e-12", "-0", "true", "\0", "1 2", "#", "12:30:01", "1979-05-27",
)  # fmt: skip
_HEADS = (
    "time [s],speed_motor [Nm],torque_motor [Nm]", "time,time,time", ",,", "speed_motor", "[s],[rpm],[Nm]", "a;b;c",
    "time [s],speed_motor [furlong],torque_motor [Nm]", '"time,"speed_motor"', "time [ms],speed_motor,speed_motor",
)  # fmt: skip
_CODINGS = ("utf-16", "utf-16-le", "utf-32", "utf-32-be", "latin-1", "utf-7", "cp037", "utf-8-sig")


def changed_csv(data: bytes, rng: random.Random) -> bytes:
    """A text table with one to three changes."""
    text = data.decode()
    for _ in range(rng.choice((1, 1, 2, 3))):
        text = rng.choice(_CSV_CHANGES)(text, rng)
    if rng.random() < 0.06:
        return text.encode(rng.choice(_CODINGS), errors="replace")
    return text.encode("utf-8", errors="replace")


def _separator(text: str) -> str:
    return next((mark for mark in (";", "\t", ",") if mark in text), " ")


def _cells(text: str, rng: random.Random) -> str:
    mark, lines = _separator(text), text.split("\n")
    for _ in range(rng.choice((1, 1, 5, 100))):
        i = rng.randrange(len(lines))
        fields = lines[i].split(mark)
        fields[rng.randrange(len(fields))] = rng.choice(_CELLS)
        lines[i] = mark.join(fields)
    return "\n".join(lines)


def _column(text: str, rng: random.Random) -> str:
    """A whole column changed: one value, a copy of another column, or gone."""
    mark = _separator(text)
    rows = [line.split(mark) for line in text.split("\n")]
    width = max(map(len, rows))
    one, two, value, which = rng.randrange(width), rng.randrange(width), rng.choice(_CELLS), rng.randrange(3)
    for fields in rows[rng.randrange(2) :]:
        if max(one, two) < len(fields):
            if which == 2:
                del fields[one]
            else:
                fields[one] = (value, fields[two])[which]
    return "\n".join(map(mark.join, rows))


def _lines(text: str, rng: random.Random) -> str:
    lines = text.split("\n")
    at, which = rng.randrange(len(lines)), rng.randrange(5)
    if which == 0:
        del lines[at]
    elif which == 1:
        lines.insert(at, lines[rng.randrange(len(lines))])
    elif which == 2:
        lines = lines[:at]
    elif which == 3:
        lines.insert(at, rng.choice(_CELLS))
    else:
        rng.shuffle(lines)
    return "\n".join(lines)


def _head(text: str, rng: random.Random) -> str:
    return rng.choice(_HEADS).replace(",", _separator(text)) + "\n" + text.split("\n", 1)[-1]


def _dialect(text: str, rng: random.Random) -> str:
    old, new = rng.choice(
        ((".", ","), (_separator(text), rng.choice(",;\t |")), ("\n", "\r"), ("\n", "\n\n"))
    )
    return text.replace(old, new)


_CSV_CHANGES: tuple[Callable[[str, random.Random], str], ...] = (
    _cells,
    _cells,
    _column,
    _lines,
    _head,
    _dialect,
)

_SHAPES = ((), (0,), (1,), (3, 3), (200, 1), (1, 200), (2, 2, 2), (100, 0), (50,))
_TYPES = ("<f8", ">f8", "<f4", "<f2", "<i8", "u1", "?", "<c16", "<U5", "S3", "<M8[s]", "V4", "O")


def _array(rng: random.Random) -> np.ndarray:
    kind, shape = rng.choice(_TYPES), rng.choice(_SHAPES)
    if kind == "O":
        return np.array([{"a": 1}, None], dtype=object)
    numbers = np.random.default_rng(rng.randrange(2**32)).integers(0, 100, shape)
    array = np.zeros(shape, kind) if kind[0] == "V" else numbers.astype(kind)
    if array.dtype == float and array.size and rng.random() < 0.3:
        array.flat[rng.randrange(array.size)] = rng.choice((np.nan, np.inf, 1e308, -1e30))
    return np.asfortranarray(array) if rng.random() < 0.2 else array


def changed_npz(data: bytes, rng: random.Random) -> bytes:
    """An .npz with other arrays, another header, or members that are not what the zip's directory says."""
    with np.load(io.BytesIO(data)) as file:
        arrays: dict[str, Any] = {name: file[name] for name in file.files}
    original = dict(arrays)
    for _ in range(rng.choice((1, 1, 2))):
        name, which = rng.choice(list(arrays)), rng.randrange(6)
        if which == 0:
            del arrays[name]
        elif which == 1:
            arrays[name] = _array(rng)
        elif which == 2:
            arrays[rng.choice(("signal/", "signal/x", "time", "x" * 300, "signal/speed_2"))] = arrays[name]
        elif which == 3 and "header" in original:
            header = json.loads(str(original["header"]))
            arrays["header"] = np.array(fuzz_trees.json_text(fuzz_trees.changed(header, rng)).decode())
        elif which == 4:
            arrays[name] = arrays[name][..., ::-1] if arrays[name].ndim else arrays[name]
        else:
            return _rezipped(arrays, rng)
        if not arrays:
            break
    out = io.BytesIO()
    np.savez(out, **arrays)
    return out.getvalue()


def _rezipped(arrays: dict[str, Any], rng: random.Random) -> bytes:
    """Members written by hand: a header that asks for more than there is, other compressions, doubled names, a bomb."""
    out = io.BytesIO()
    packings = (
        zipfile.ZIP_STORED,
        zipfile.ZIP_DEFLATED,
        zipfile.ZIP_DEFLATED,
        zipfile.ZIP_BZIP2,
        zipfile.ZIP_LZMA,
    )
    method = rng.choice(packings)
    victim, which = rng.choice(list(arrays)), rng.randrange(4)
    with zipfile.ZipFile(out, "w", method) as file:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.save(member, array)
            raw = member.getvalue()
            if name == victim and which == 0:
                size = rng.choice((10**6, 10**10, 10**18, -1))
                head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({size},), }}\n".encode()
                raw = b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + raw[128:]
            elif name == victim and which == 1:
                raw = rng.choice(
                    (b"", b"\x93NUMPY", b"\x93NUMPY\x09\x00" + raw[8:], raw[:100], raw + bytes(1000))
                )
            elif name == victim and which == 2:
                raw = raw[:128] + bytes(rng.choice((10_000, 3_000_000)))
            file.writestr(f"{name}.npy", raw)
    packed = out.getvalue()
    if which == 3:  # the same name in the directory twice
        return packed.replace(b"time.npy", b"header.npy"[:8])
    return packed


def _mat_value(rng: random.Random, depth: int = 0) -> Any:
    """Anything that MATLAB could have saved."""
    from scipy.sparse import csc_array

    which = rng.randrange(9 if depth < 4 else 4)
    if which == 0:
        array = _array(rng)
        while array.dtype.kind in "MVO":
            array = _array(rng)
        return array
    if which == 1:
        return rng.choice(("", "text", "ä" * 20, "x [rpm]", 1.5, True, 3 + 4j))
    if which == 2:
        return np.empty(rng.choice(((0, 0), (0, 3), (1, 0))))
    if which == 3:
        return csc_array(np.eye(rng.choice((1, 3, 50))))
    if which < 6:
        cells = np.empty(rng.choice((1, 2, 4)), dtype=object)
        for i in range(cells.size):
            cells[i] = _mat_value(rng, depth + 1)
        return cells
    names = rng.sample(("time", "signals", "values", "label", "x"), rng.choice((1, 2, 3)))
    return {name: _mat_value(rng, depth + 1) for name in names}


def changed_mat(data: bytes, rng: random.Random) -> bytes:
    """A MATLAB file of the same names with other contents."""
    from scipy.io import loadmat, savemat

    found = loadmat(io.BytesIO(data))
    variables = {name: value for name, value in found.items() if not name.startswith("__")}
    for _ in range(rng.choice((1, 1, 2))):
        variables[rng.choice([*variables, "time", "speed_motor", "data"])] = _mat_value(rng)
    if rng.random() < 0.2:
        del variables[rng.choice(list(variables))]
    out = io.BytesIO()
    savemat(out, variables, do_compression=rng.random() < 0.5, long_field_names=True)
    return out.getvalue()
