"""Where lanes lie in arrays. Arrays are seen as one row, so they must be contiguous."""

from collections.abc import Iterable
from typing import Any

from llvmlite import ir
from numba.core import types

from eyas.lanes.vector import WIDTH, threads
from eyas.lanes.vector.kinds import Lanes, lanes_are_threads

I32, I64 = ir.IntType(32), ir.IntType(64)


def pointer_to(context: Any, builder: Any, array: Any, value: Any, at: Any) -> ir.Value:
    """Return the pointer to an element of an array, by its index."""
    data = context.make_array(array)(context, builder, value).data
    return builder.gep(data, [at])


def loaded(builder: Any, pointer: Any, align: int) -> ir.Value:
    """Return what lies at a pointer that is aligned so [bytes]."""
    value = builder.load(pointer)
    value.align = align
    return value


def each_index(context: Any, builder: Any, kind: types.Type, index: ir.Value) -> list[ir.Value]:
    """Return the indices in the lanes, or the one index, as 64 bits; none is negative.

    A thread has one: its own.
    """
    if not isinstance(kind, Lanes) or lanes_are_threads(context):
        return [index if index.type == I64 else builder.zext(index, I64)]
    items = [builder.extract_element(index, I32(k)) for k in range(WIDTH)]
    return [builder.zext(item, I64) for item in items]


def place_of_lanes(
    context: Any,  # numba's
    builder: Any,  # numba's
    sig: Any,  # Signature of an operation on an array and an index
    args: Any,  # Its arguments
    kind: ir.Type,  # LLVM's type of what lies there
    size: int,  # That of one lane, and of an element of the array if that is smaller [bytes]
) -> tuple[ir.Value, int]:
    """Return where lanes of a type are read or written, and how that is aligned [bytes]."""
    at = context.cast(builder, args[1], sig.args[1], types.int64)
    element = sig.args[0].dtype.bitwidth // 8
    if lanes_are_threads(context):
        lane = builder.zext(threads.lane_number(builder), I64)
        at = builder.add(at, builder.mul(lane, I64(size // element)))
    pointer = pointer_to(context, builder, sig.args[0], args[0], at)
    align = size if lanes_are_threads(context) else element
    return builder.bitcast(pointer, kind.as_pointer()), align


def place_of_half(
    context: Any,  # numba's
    builder: Any,  # numba's
    sig: Any,  # Signature of an operation on an array, an index, and where the second half begins
    args: Any,  # Its arguments
    size: int,  # Elements of the array that a lane takes
    half: int,  # 0 or 1
) -> ir.Value:
    """Return the pointer to the first element of a half of the lanes; a thread's own element."""
    at, step = (context.cast(builder, args[k], sig.args[k], types.int64) for k in (1, 2))
    if lanes_are_threads(context):
        lane = builder.zext(threads.lane_number(builder), I64)
        aside = builder.mul(builder.and_(lane, I64(WIDTH // 2 - 1)), I64(size))
        second = builder.icmp_unsigned(">=", lane, I64(WIDTH // 2))
        at = builder.add(at, builder.add(aside, builder.select(second, step, I64(0))))
    elif half:
        at = builder.add(at, step)
    return pointer_to(context, builder, sig.args[0], args[0], at)


def order_of(numbers: Iterable[int]) -> ir.Constant:
    """Return the mask of a `shufflevector` that takes the lanes of these numbers."""
    items = [I32(number) for number in numbers]
    return ir.Constant(ir.VectorType(I32, len(items)), items)
