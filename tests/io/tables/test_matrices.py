"""Mass and stiffness matrices read from .npz, MatrixMarket and CSV."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import csc_array

from lostmotion.errors import InvalidInput
from lostmotion.io.tables.matrices import read_torsional_model, save_torsional_model
from lostmotion.structure import Coupling, Disc, Gear, assemble, modes

MODEL = assemble(
    [
        Disc("a", 0.1),
        Coupling("k", 900.0),
        Disc("b", 0.3),
        Gear("g", 2.0),
        Coupling("l", 70.0),
        Disc("c", 2.0),
    ]
)


def check(found):
    np.testing.assert_array_equal(found.mass, MODEL.mass)
    np.testing.assert_array_equal(found.stiffness, MODEL.stiffness)


def test_npz_keeps_names_and_ratios(tmp_path):
    save_torsional_model(MODEL, tmp_path / "model.npz")
    found = read_torsional_model(tmp_path / "model.npz")
    check(found)
    assert found.names == ("a", "b", "c")
    np.testing.assert_array_equal(modes(found).own_shapes(), modes(MODEL).own_shapes())


def test_matrix_market_dense_and_sparse(tmp_path):
    mmwrite(tmp_path / "m.mtx", csc_array(MODEL.mass), precision=17)
    mmwrite(tmp_path / "k.mtx", MODEL.stiffness, precision=17)
    check(read_torsional_model(tmp_path / "m.mtx", tmp_path / "k.mtx"))


def test_csv(tmp_path):
    for name, matrix in (("m.csv", MODEL.mass), ("k.csv", MODEL.stiffness)):
        np.savetxt(tmp_path / name, matrix, delimiter=",", header="kg m2 or Nm/rad", fmt="%.17g")
    check(read_torsional_model(tmp_path / "m.csv", tmp_path / "k.csv", names=("x", "y", "z")))


@pytest.mark.parametrize("content", ["a,b\nc,d\n", "1,2\n3\n", ""])
def test_no_matrix(tmp_path, content):
    (tmp_path / "m.csv").write_text(content)
    with pytest.raises(InvalidInput) as caught:
        read_torsional_model(tmp_path / "m.csv", tmp_path / "m.csv")
    assert "m.csv" in str(caught.value) or "TorsionalModel" in str(caught.value)


def test_missing_parts(tmp_path):
    np.savez(tmp_path / "m.npz", mass=np.eye(2))
    with pytest.raises(InvalidInput, match="stiffness"):
        read_torsional_model(tmp_path / "m.npz")
    (tmp_path / "m.csv").write_text("1,0\n0,1\n")
    with pytest.raises(InvalidInput, match="stiffness"):
        read_torsional_model(tmp_path / "m.csv")
    with pytest.raises(InvalidInput):
        read_torsional_model(tmp_path / "nowhere.npz")


def test_a_missing_file_is_not_called_broken(tmp_path):
    with pytest.raises(InvalidInput, match="got no such file, "):
        read_torsional_model(tmp_path / "none.npz")
