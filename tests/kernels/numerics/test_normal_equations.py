"""Half of a symmetric product is the whole of it."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.kernels.numerics.normal_equations import products


@pytest.mark.parametrize(("p", "n"), [(1, 1), (3, 100), (17, 3000)])
def test_products_are_those_of_matrices(p: int, n: int):
    rng = np.random.default_rng(p)
    jacobian, residual = rng.standard_normal((p, n)), rng.standard_normal(n)
    hessian, gradient = products(jacobian, residual)
    assert hessian == pytest.approx(jacobian @ jacobian.T, rel=1e-12, abs=1e-10)
    assert gradient == pytest.approx(jacobian @ residual, rel=1e-12, abs=1e-10)
    assert np.array_equal(hessian, hessian.T)


def test_what_grew_without_bound_stays_so():
    """A filter whose numbers overflow tells nothing, and must not tell something."""
    hessian, gradient = products(np.array([[np.inf, 1.0], [1.0, np.nan]]), np.ones(2))
    assert not np.isfinite(hessian).any() and not np.isfinite(gradient).any()
