"""Four floats in one register for numba kernels: what a C compiler makes of short loops, said outright.

numba neither vectorises straight-line code nor knows that two arrays do not overlap, so loops over four rows stay
scalar. The functions here become single instructions of the machine, or two halves where it has shorter registers.
They take the address of an array (``address``) and count in numbers from there: nothing checks bounds, and numba
counts no references, which would cost more than an event where arrays are handed on. Products and sums may be
contracted, as in the plant kernels that use them.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import carray, extending, types
from numba.extending import models, register_model

from ..jit import njit

#: Doubles in a register of AVX2 (layout).
LANES = 4

#: The decorator without its type, which knows nothing of what it makes.
intrinsic: Any = extending.intrinsic

_DOUBLE = ir.DoubleType()
_VECTOR = ir.VectorType(_DOUBLE, LANES)
#: Layout.
_INDEX = ir.IntType(32)
#: Layout.
_LONG = ir.IntType(64)
_OF_ONE = ir.FunctionType(_VECTOR, [_VECTOR])
_CONTRACT = ("contract",)


class FourType(types.Type):
    """numba's type of four float64 in a register."""

    def __init__(self) -> None:
        super().__init__(name="Four")


four = FourType()


@register_model(FourType)
class _FourModel(models.PrimitiveModel):
    def __init__(self, manager: Any, of_type: Any) -> None:
        super().__init__(manager, of_type, _VECTOR)


def _pointer(builder: Any, address: Any, index: Any) -> Any:
    start = builder.inttoptr(address, _DOUBLE.as_pointer())
    return builder.bitcast(builder.gep(start, [index]), _VECTOR.as_pointer())


def _splat(builder: Any, value: Any) -> Any:
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), value, _INDEX(0))
    return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(_INDEX, LANES), [0] * LANES))


@intrinsic
def address(typing: Any, array: Any) -> Any:
    """Address of an array's first number; the caller keeps the array alive."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, args[0])
        return builder.ptrtoint(view.data, context.get_value_type(types.int64))

    return types.int64(array), code


@intrinsic
def load(typing: Any, at: Any, index: Any) -> Any:
    """Four numbers from at[index] on."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(_pointer(builder, *args), align=8)

    return four(types.int64, types.int64), code


@intrinsic
def store(typing: Any, at: Any, index: Any, values: Any) -> Any:
    """Four numbers to at[index] and on."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[2], _pointer(builder, args[0], args[1]), align=8)
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, four), code


@intrinsic
def splat(typing: Any, value: Any) -> Any:
    """One number four times."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _splat(builder, args[0])

    return four(types.float64), code


@intrinsic(prefer_literal=True)
def spread(typing: Any, values: Any, lane: Any) -> Any:
    """One of the four numbers, its place given by a literal, four times."""
    place = lane.literal_value

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        mask = ir.Constant(ir.VectorType(_INDEX, LANES), [place] * LANES)
        return builder.shuffle_vector(args[0], args[0], mask)

    return four(four, lane), code


@intrinsic
def pack(typing: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Four numbers side by side."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        values = ir.Constant(_VECTOR, ir.Undefined)
        for i, value in enumerate(args):
            values = builder.insert_element(values, value, _INDEX(i))
        return values

    return four(*[types.float64] * 4), code


@intrinsic
def add(typing: Any, a: Any, b: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fadd(*args, flags=_CONTRACT)

    return four(four, four), code


@intrinsic
def subtract(typing: Any, a: Any, b: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fsub(*args, flags=_CONTRACT)

    return four(four, four), code


@intrinsic
def multiply(typing: Any, a: Any, b: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fmul(*args, flags=_CONTRACT)

    return four(four, four), code


@intrinsic
def fused(typing: Any, a: Any, b: Any, c: Any) -> Any:
    """a·b + c, in one instruction where the machine has it."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        product = builder.fmul(args[0], args[1], flags=_CONTRACT)
        return builder.fadd(product, args[2], flags=_CONTRACT)

    return four(four, four, four), code


@intrinsic
def absolute(typing: Any, a: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.call(builder.module.declare_intrinsic("llvm.fabs.v4f64", fnty=_OF_ONE), args)

    return four(four), code


@intrinsic
def smaller(typing: Any, a: Any, b: Any) -> Any:
    """The smaller one of each pair of numbers."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered("<", *args), *args)

    return four(four, four), code


@intrinsic
def larger(typing: Any, a: Any, b: Any) -> Any:
    """The larger one of each pair of numbers."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", *args), *args)

    return four(four, four), code


@intrinsic
def less(typing: Any, a: Any, b: Any) -> Any:
    """Bit i is set where a[i] < b[i]; not for NaN."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        bits = builder.bitcast(builder.fcmp_ordered("<", *args), ir.IntType(LANES))
        return builder.zext(bits, _LONG)

    return types.int64(four, four), code


@intrinsic
def total(typing: Any, a: Any) -> Any:
    """Sum of the four numbers, in pairs."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        parts = [builder.extract_element(args[0], _INDEX(i)) for i in range(LANES)]
        return builder.fadd(builder.fadd(parts[0], parts[2]), builder.fadd(parts[1], parts[3]))

    return types.float64(four), code


def _read(kind: Any, number: Any) -> Any:
    """The number at[index] of an array of such numbers."""

    def access(typing: Any, at: Any, index: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.load(builder.gep(builder.inttoptr(args[0], kind.as_pointer()), [args[1]]))

        return number(types.int64, types.int64), code

    return intrinsic(access)


def _write(kind: Any, number: Any) -> Any:
    """One number to at[index] of an array of such numbers."""

    def access(typing: Any, at: Any, index: Any, value: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            builder.store(args[2], builder.gep(builder.inttoptr(args[0], kind.as_pointer()), [args[1]]))
            return context.get_dummy_value()

        return types.void(types.int64, types.int64, number), code

    return intrinsic(access)


read, write = _read(_DOUBLE, types.float64), _write(_DOUBLE, types.float64)
read_integer, write_integer = _read(_LONG, types.int64), _write(_LONG, types.int64)


def _shuffled(pattern: list[int]) -> Any:
    """Four of the eight numbers in two registers, by their places."""

    def shuffle(typing: Any, a: Any, b: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.shuffle_vector(*args, ir.Constant(ir.VectorType(_INDEX, LANES), pattern))

        return four(four, four), code

    return intrinsic(shuffle)


_even_places, _odd_places = _shuffled([0, 4, 2, 6]), _shuffled([1, 5, 3, 7])
_lower_halves, _upper_halves = _shuffled([0, 1, 4, 5]), _shuffled([2, 3, 6, 7])


@njit(forceinline=True, cache=True)
def columns_of(a, b, c, d):
    """The four columns of four rows of four numbers."""
    even, odd, even_below, odd_below = (
        _even_places(a, b),
        _odd_places(a, b),
        _even_places(c, d),
        _odd_places(c, d),
    )
    return (
        _lower_halves(even, even_below), _lower_halves(odd, odd_below),
        _upper_halves(even, even_below), _upper_halves(odd, odd_below),
    )  # fmt: skip


@intrinsic
def _pointer_to(typing: Any, at: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], context.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.int64), code


@njit(forceinline=True, cache=True)
def numbers_at(at, count):
    """The array of `count` numbers at an address; references to it are not counted."""
    return carray(_pointer_to(at), (count,))
