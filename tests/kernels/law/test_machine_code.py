"""Machine code of laws: made once for a shape, whoever asks for it."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from lostmotion import DiscreteSystem
from lostmotion.kernels.law import machine_code


def test_threads_share_one_code() -> None:
    """Laws keep an address alone: code that a second thread makes must not take the place of the first one's."""
    rng = np.random.default_rng(0)
    a, b = 0.1 * rng.standard_normal((5, 5)), rng.standard_normal((5, 1))
    law = DiscreteSystem(
        inputs=("u",), outputs=("y",), states=tuple("abcde"), A=a, B=b, C=b.T, dt=1e-3, name="law"
    )
    barrier = threading.Barrier(4)

    def together(_: int) -> int:
        barrier.wait()
        return law.tables().code

    before = set(machine_code._CODES)
    with ThreadPoolExecutor(4) as pool:
        assert len(set(pool.map(together, range(4)))) == 1
    assert len(set(machine_code._CODES) - before) <= 1


def test_constants_are_written_to_the_last_bit() -> None:
    assert machine_code._number(1.5) == "0x3FF8000000000000"
    assert machine_code._number(-0.1) == "0xBFB999999999999A"
