"""Mass and stiffness matrices from finite-element programs: .npz, MatrixMarket, CSV."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from ...structure import TorsionalModel
from ..storage.whole_files import read_bytes, write_bytes

Floats = NDArray[np.float64]

_EXPECTED = "numbers as .npz (arrays mass and stiffness), MatrixMarket (.mtx) or CSV"


def read_torsional_model(
    mass: str | Path,
    stiffness: str | Path | None = None,
    *,
    names: tuple[str, ...] = (),
    damping_ratio: float = 0.02,
) -> TorsionalModel:
    """A torsional model from files with its mass and stiffness matrix, SI units (kg m², Nm/rad).

    Parameters
    ----------
    mass : str or Path
        An .npz with the arrays ``mass`` and ``stiffness`` (``names`` and ``ratios`` if there are any), or a file with
        the mass matrix alone: MatrixMarket (.mtx) or comma-separated rows (.csv, .txt).
    stiffness : str or Path, optional
        The file with the stiffness matrix, where the first one is not an .npz.
    names : tuple of str
        Names of the nodes; default: those in the .npz, else "1", "2", …
    damping_ratio : float
        Modal damping ratio.

    Raises
    ------
    InvalidInput
        If a file cannot be read, holds no matrix, or the matrices make no torsional model.
    """
    mass = Path(mass)
    if mass.suffix.lower() == ".npz":
        arrays = _npz(mass)
        names = names or tuple(str(name) for name in arrays.get("names", ()))
        ratios = arrays.get("ratios")
        return TorsionalModel(arrays["mass"], arrays["stiffness"], names, ratios, damping_ratio)  # type: ignore[arg-type]
    if stiffness is None:
        raise InvalidInput(
            str(mass), "a mass matrix alone", "a second file with the stiffness matrix", "Name it too."
        )
    return TorsionalModel(_matrix(mass), _matrix(Path(stiffness)), names, damping_ratio=damping_ratio)


def save_torsional_model(model: TorsionalModel, path: str | Path) -> None:
    """Write a torsional model as .npz; see ``read_torsional_model``."""
    buffer = io.BytesIO()
    np.savez(
        buffer, mass=model.mass, stiffness=model.stiffness, names=np.array(model.names), ratios=model.ratios
    )
    write_bytes(Path(path), buffer.getvalue())


def _npz(path: Path) -> dict[str, Floats]:
    raw = read_bytes(path)
    try:
        with np.load(io.BytesIO(raw), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, OSError, EOFError, zipfile.BadZipFile):
        raise InvalidInput(str(path), "a file that cannot be read", _EXPECTED, "Write it again.") from None
    missing = sorted({"mass", "stiffness"} - set(arrays))
    if missing:
        raise InvalidInput(
            str(path), f"arrays {sorted(arrays)}", "arrays mass and stiffness", f"Add {missing}."
        )
    return arrays


def _matrix(path: Path) -> Floats:
    raw = read_bytes(path)
    try:
        if path.suffix.lower() in (".mtx", ".mm"):
            from scipy.io import mmread

            matrix = mmread(io.BytesIO(raw))
            return np.asarray(matrix if isinstance(matrix, np.ndarray) else matrix.toarray(), dtype=float)
        if not raw.strip():
            raise ValueError("an empty file")
        return np.loadtxt(io.StringIO(raw.decode()), delimiter=",", comments="#", ndmin=2)
    except (ValueError, UnicodeDecodeError) as error:
        raise InvalidInput(str(path), f"no matrix: {error}", _EXPECTED, "Check the file.") from None
