"""RemoteLaw: a law whose step is made elsewhere, for the loop of ``simulate``."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..systems import DiscreteSystem, Stepper
from .law_steps import CODE, Step


@dataclass(frozen=True, eq=False, kw_only=True)
class RemoteLaw(DiscreteSystem):
    """Inputs, outputs and sample time of a law; its code calls ``exchange``, its matrices are empty.

    The simulation calls a law by the address of its code. It sees no other difference, so a loop with a remote law runs
    the very same code as with the law itself. An exception cannot pass that code: see ``raised_after``.
    """

    exchange: Step
    failures: list[BaseException] = field(default_factory=list)

    @classmethod
    def of(cls, law: DiscreteSystem | Stepper, exchange: Step) -> RemoteLaw:
        return cls(name=law.name, inputs=law.inputs, outputs=law.outputs, dt=law.dt, exchange=exchange)

    def tables(self) -> Any:
        """Those of a law without a number, with the address of the callback as its code."""
        from ..kernels.law.step import LawTables

        if "_code" not in self.__dict__:
            self.__dict__["_code"] = CODE(self._step)  # it must live as long as its address is used
        address = ctypes.cast(self.__dict__["_code"], ctypes.c_void_p).value
        assert address is not None
        return LawTables(0, len(self.inputs), len(self.outputs), address, np.zeros(1))

    def _step(self, _numbers: int, _state: int, inputs: int, outputs: int) -> int:
        ctypes.memset(outputs, 0, 8 * len(self.outputs))
        if self.failures:  # the simulation runs out with zeros, at once
            return 0
        faults, made = self.exchange(ctypes.string_at(inputs, 8 * len(self.inputs)))
        ctypes.memmove(outputs, made, len(made))
        return faults


@contextmanager
def raised_after(law: RemoteLaw) -> Iterator[None]:
    """Around the simulation: what the exchange raised, Ctrl-C among it, is raised at its end, which comes at once."""

    def remember(unraisable: Any) -> None:
        law.failures.append(unraisable.exc_value)

    before, sys.unraisablehook = sys.unraisablehook, remember
    try:
        yield
    finally:
        sys.unraisablehook = before
    if law.failures:
        raise law.failures[0]
