"""A flat array read as a record: its numbers by name instead of by place, for numba and numpy alike.

A record costs nothing: it is the address of the array's first number, and a field a constant distance from it. It is
passed on as one number and, unlike a NamedTuple, can be written to.
"""

from __future__ import annotations

import hashlib
from functools import cache
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.datamodel import models
from numba.core.datamodel.registry import register_default
from numba.np.numpy_support import from_dtype

from ..numerics.vectors import intrinsic


class RecordType(types.Record):
    """numba's type of a record, named by what is in it.

    numba names its own by the order in which a process comes across them. Compiled functions are linked by the names
    of their arguments, so one from the cache, of another process, could be taken for another record's.
    """

    @property
    def mangling_args(self) -> tuple[str, tuple[Any, ...]]:
        return "Record" + hashlib.sha256(self.name.encode()).hexdigest()[:16], ()

    def can_convert_to(self, typingctx: Any, other: Any) -> None:
        """Not taken for another record, not even for numba's own of the same fields."""


@register_default(RecordType)
class _RecordModel(models.RecordModel):
    pass


@cache
def record_type(dtype: np.dtype[Any]) -> RecordType:
    """numba's type of a structured dtype; its fields are numbers, records, and arrays of both."""
    assert dtype.fields is not None
    fields: Any = [(name, {"type": _field(of), "offset": at}) for name, (of, at, *_) in dtype.fields.items()]
    return RecordType(fields, dtype.itemsize, False)


def _field(dtype: np.dtype[Any]) -> Any:
    if dtype.subdtype is not None:
        return types.NestedArray(_field(dtype.subdtype[0]), dtype.subdtype[1])
    return from_dtype(dtype) if dtype.fields is None else record_type(dtype)


def reads(dtype: np.dtype[Any]) -> Any:
    """A function for kernels: the record at the start of a flat array, or at a pointer; its caller keeps it alive."""
    kind = record_type(dtype)

    @intrinsic
    def record(typing: Any, numbers: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            start = args[0]
            if isinstance(numbers, types.Array):
                start = context.make_array(numbers)(context, builder, start).data
            return builder.bitcast(start, context.get_value_type(kind))

        return kind(numbers), code

    return record


def scratch(dtype: np.dtype[Any]) -> Any:
    """A function for kernels: a record with any numbers in it, on the stack; it lasts until the kernel returns."""
    kind = record_type(dtype)

    @intrinsic
    def record(typing: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            place = cgutils.alloca_once(builder, context.get_data_type(kind))
            place.align = 8
            return place

        return kind(), code

    return record
