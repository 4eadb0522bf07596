"""Mass and stiffness matrices from finite-element programs: .npz, MatrixMarket, CSV."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...plain_data import numbers
from ...structure import TorsionalModel
from ...structure.torsional_model import DAMPING_RATIO
from ..isolation.parent import read_isolated
from ..storage.npz_files import read_npz
from ..storage.whole_files import read_bytes, write_bytes
from .dialects import LONGEST

Floats = NDArray[np.float64]

_EXPECTED = "numbers as .npz (arrays mass and stiffness), MatrixMarket (.mtx) or CSV"
_NEEDED, _OPTIONAL = {"mass", "stiffness"}, {"names", "ratios", "damping_ratio"}
#: Largest number of a matrix (numerics: the square of a larger one is near the end of the floats).
LARGEST = 1e100
#: Bytes of memory that reading rows of text takes for each byte of the file (calibrated on matrices of 50 and 300 rows:
#: 5 with all digits, 9 with short integers).
_TAKES = 9.0


@checks_arguments
def read_torsional_model(
    mass: str | Path,
    stiffness: str | Path | None = None,
    *,
    names: tuple[str, ...] = (),
    damping_ratio: float | None = None,
) -> TorsionalModel:
    """A torsional model from files with its mass and stiffness matrix, SI units (kg m², Nm/rad).

    Parameters
    ----------
    mass : str or Path
        An .npz with the arrays ``mass`` and ``stiffness`` (``names``, ``ratios``, ``damping_ratio`` if there are any),
        or a file with the mass matrix alone: MatrixMarket (.mtx) or comma-separated rows (.csv, .txt).
    stiffness : str or Path, optional
        The file with the stiffness matrix, where the first one is not an .npz.
    names : tuple of str
        Names of the nodes; default: those in the .npz, else "1", "2", …
    damping_ratio : float, optional
        Modal damping ratio; default: that in the .npz, else that of ``TorsionalModel``.

    Raises
    ------
    InvalidInput
        If a file cannot be read, holds no matrix, or the matrices make no torsional model.
    """
    mass = Path(mass)
    if mass.suffix.lower() == ".npz":
        return _saved(mass, names, damping_ratio)
    if stiffness is None:
        raise InvalidInput(
            str(mass), "a mass matrix alone", "a second file with the stiffness matrix", "Name it too."
        )
    ratio = DAMPING_RATIO if damping_ratio is None else damping_ratio
    return TorsionalModel(_matrix(mass), _matrix(Path(stiffness)), names, damping_ratio=ratio)


def save_torsional_model(model: TorsionalModel, path: str | Path) -> None:
    """Write a torsional model as .npz; ``read_torsional_model`` gives an equal one."""
    buffer = io.BytesIO()
    np.savez(
        buffer,
        mass=model.mass,
        stiffness=model.stiffness,
        names=np.array(model.names),
        ratios=model.ratios,
        damping_ratio=np.array(model.damping_ratio),
    )
    write_bytes(path, buffer.getvalue())


def _saved(path: Path, names: tuple[str, ...], damping_ratio: float | None) -> TorsionalModel:
    arrays = read_npz(path, _EXPECTED)
    if not _NEEDED <= set(arrays) <= _NEEDED | _OPTIONAL:
        missing = sorted(_NEEDED - set(arrays))
        raise InvalidInput(
            str(path),
            f"arrays {sorted(arrays)}",
            "arrays mass and stiffness, perhaps names, ratios, damping_ratio",
            f"Add {', '.join(missing)}." if missing else "Leave out the others.",
        )
    where = str(path)
    own = arrays.get("names", np.empty(0, dtype="U1"))
    if own.dtype.kind != "U" or own.ndim != 1:
        raise InvalidInput(f"{where}, names", f"{own.dtype}", "a row of texts", "Write it again.")
    ratios = arrays.get("ratios")
    stored = numbers(f"{where}, damping_ratio", arrays.get("damping_ratio", DAMPING_RATIO), ())
    return TorsionalModel(
        _checked(arrays["mass"], f"{where}, mass"),
        _checked(arrays["stiffness"], f"{where}, stiffness"),
        names or tuple(map(str, own)),
        None if ratios is None else _checked(ratios, f"{where}, ratios"),  # type: ignore[arg-type]
        float(stored) if damping_ratio is None else damping_ratio,
    )


def _matrix(path: Path) -> Floats:
    if path.suffix.lower() in (".mtx", ".mm"):
        remedy = "Write it again, as MatrixMarket or CSV."
        return _checked(
            read_isolated("matrix market", read_bytes(path), str(path), _EXPECTED, remedy), str(path)
        )
    raw = read_bytes(path, takes=_TAKES)
    try:
        if not raw.strip():
            raise ValueError("an empty file")
        if any(len(field) > LONGEST for field in raw.replace(b"\n", b",").split(b",")):
            raise ValueError(f"a field of more than {LONGEST} characters")
        rows = np.loadtxt(io.StringIO(raw.decode()), delimiter=",", comments="#", ndmin=2)
    except ValueError as error:
        raise InvalidInput(str(path), f"no matrix: {error}", _EXPECTED, "Check the file.") from None
    return _checked(rows, str(path))


def _checked(array: np.ndarray, where: str) -> Floats:
    """Finite real numbers of a size that can be calculated with."""
    real = array.dtype.kind in "fiu"
    values = array.astype(float) if real else np.empty(0)
    if not real or not np.all(np.abs(values) <= LARGEST):
        got = "NaN, or a number beyond it" if real else f"{array.dtype}"
        raise InvalidInput(where, got, f"real numbers of at most {LARGEST:g}", "Check the file.")
    return values
