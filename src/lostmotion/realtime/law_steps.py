"""A law's step on bytes, as datagrams bring them: as the package runs it, or as its exported C."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..systems import DiscreteSystem, Stepper

Law = DiscreteSystem | Stepper
#: Inputs of a sample, eight bytes each → bit mask of the bad ones, outputs likewise. It keeps the law's memory.
Step = Callable[[bytes], tuple[int, bytes]]

#: What a DiscreteSystem's machine code is called with: numbers, memory, inputs, outputs (``kernels.law.step``).
CODE = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_void_p] * 4)


def own_step(law: Law) -> Step:
    """As ``simulate`` steps it."""
    return _stepper(law) if isinstance(law, Stepper) else _machine_code(law)


def _machine_code(law: DiscreteSystem) -> Step:
    inputs, outputs = np.empty(len(law.inputs)), np.empty(len(law.outputs))
    # The code knows addresses alone: the arrays must live as long as the step.
    arrays = (law.tables().numbers, law.init(), inputs, outputs)
    code, addresses = CODE(law.tables().code), [array.ctypes.data for array in arrays]

    def step(given: bytes) -> tuple[int, bytes]:
        arrays[2][:] = np.frombuffer(given)
        return code(*addresses), arrays[3].tobytes()

    return step


def _stepper(law: Stepper) -> Step:
    memory = law.init()

    def step(given: bytes) -> tuple[int, bytes]:
        nonlocal memory
        memory, outputs, faults = law.step(memory, np.frombuffer(given))
        return faults, outputs.tobytes()

    return step


def exported_step(library: Path, law: Law) -> Step:
    """The exported C, of a library that ``export.shared_library`` made."""
    code = ctypes.CDLL(str(library))
    code.law_step.restype = ctypes.c_ulong
    code.law_size.restype = ctypes.c_ulong
    memory = ctypes.create_string_buffer(code.law_size())
    outputs = np.empty(len(law.outputs))
    code.law_init(memory)
    address = ctypes.c_void_p(outputs.ctypes.data)

    def step(given: bytes) -> tuple[int, bytes]:
        return code.law_step(memory, given, address), outputs.tobytes()

    return step
