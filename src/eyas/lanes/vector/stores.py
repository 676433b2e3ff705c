"""Stores of lanes into arrays."""

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from eyas.lanes.vector import WIDTH, threads
from eyas.lanes.vector.kinds import Lanes, lanes_are_threads
from eyas.lanes.vector.places import (
    I32,
    I64,
    each_index,
    order_of,
    place_of_half,
    place_of_lanes,
    pointer_to,
)


def _store(context: Any, builder: Any, value: ir.Value, pointer: ir.Value, align: int) -> ir.Value:
    """Write lanes; where they are threads, all see it, and none before it is done with the old."""
    if lanes_are_threads(context):
        threads.agree(builder)
    builder.store(value, pointer).align = align
    if lanes_are_threads(context):
        threads.agree(builder)
    return context.get_dummy_value()


def _storing(size: int) -> Any:
    def generate(context, builder, sig, args):
        pointer, align = place_of_lanes(context, builder, sig, args, args[2].type, size)
        return _store(context, builder, args[2], pointer, align)

    return generate


@intrinsic
def store(typing_context, array, at, value):
    """Write eight elements in a row, from index `at` on."""
    return types.void(array, at, value), _storing(array.dtype.bitwidth // 8)


def _greatest(builder: Any, a: ir.Value, b: ir.Value) -> ir.Value:
    """Return the greater of numbers, compared as the float64 that have their bits.

    That is one instruction. The fence hides from LLVM that old numbers may be stored again, which
    it would leave out by a masked store: those take some processors ten times as long.
    """
    kind = ir.VectorType(ir.DoubleType(), WIDTH)
    name = f"v{WIDTH}f64"
    most = cgutils.get_or_insert_function(
        builder.module, ir.FunctionType(kind, [kind, kind]), f"llvm.maxnum.{name}"
    )
    fence = cgutils.get_or_insert_function(
        builder.module, ir.FunctionType(kind, [kind]), f"llvm.arithmetic.fence.{name}"
    )
    found = builder.call(
        most, [builder.bitcast(a, kind), builder.bitcast(b, kind)], fastmath=("nnan", "nsz")
    )
    return builder.bitcast(builder.call(fence, [found]), a.type)


@intrinsic
def store_greater(typing_context, array, at, value, old):
    """Write eight int64 in a row where they are greater than the old ones, which were loaded there.

    As float64, their bits must not be NaN; at most one of two that are compared may be negative.

    Threads of a graphics processor do so in one step, since other workers may write there too.
    """

    def generate(context, builder, sig, args):
        pointer, align = place_of_lanes(context, builder, sig, args, args[2].type, 8)
        if not lanes_are_threads(context):
            chosen = _greatest(builder, args[2], args[3])
            return _store(context, builder, chosen, pointer, align)
        with builder.if_then(builder.icmp_signed(">", args[2], args[3])):
            builder.atomic_rmw("max", pointer, args[2], "monotonic")
        return context.get_dummy_value()

    return types.void(array, at, value, old), generate


@intrinsic
def store_largest(typing_context, array, at, value):
    """Write an int64 if it is greater than what is there, atomically."""

    def generate(context, builder, sig, args):
        index = context.cast(builder, args[1], sig.args[1], types.int64)
        pointer = pointer_to(context, builder, array, args[0], index)
        builder.atomic_rmw("max", pointer, args[2], "monotonic")
        return context.get_dummy_value()

    return types.void(array, at, value), generate


@intrinsic
def claim_some(typing_context, counter, count):
    """Return the first number of an array of int64 and add a count to it, atomically, once for all
    lanes.
    """

    def generate(context, builder, sig, args):
        count = context.cast(builder, args[1], sig.args[1], types.int64)
        pointer = context.make_array(counter)(context, builder, args[0]).data
        if not lanes_are_threads(context):
            return builder.atomic_rmw("add", pointer, count, "monotonic")
        found = cgutils.alloca_once_value(builder, I64(0))
        first = builder.icmp_unsigned("==", threads.lane_number(builder), I32(0))
        with builder.if_then(first):
            builder.store(builder.atomic_rmw("add", pointer, count, "monotonic"), found)
        return threads.from_lane(builder, builder.load(found), I32(0))

    return types.int64(counter, count), generate


@intrinsic
def agree(typing_context):
    """Let all lanes see what each has written; for kernels of threads only."""

    def generate(context, builder, sig, args):
        threads.agree(builder)
        return context.get_dummy_value()

    return types.void(), generate


@intrinsic
def scatter(typing_context, array, index, mask, value):
    """Write elements at some indices, none negative, where the mask is set."""

    def generate(context, builder, sig, args):
        number = not isinstance(index, Lanes) or lanes_are_threads(context)
        for k, at in enumerate(each_index(context, builder, index, args[1])):
            wanted = args[2] if number else builder.extract_element(args[2], I32(k))
            element = args[3] if number else builder.extract_element(args[3], I32(k))
            with builder.if_then(wanted):
                builder.store(element, pointer_to(context, builder, array, args[0], at))
        return context.get_dummy_value()

    return types.void(array, index, mask, value), generate


@intrinsic
def store_words(typing_context, array, at, value):
    """Write eight uint32 into an array of bytes, from byte `at` on."""
    return types.void(array, at, value), _storing(4)


@intrinsic
def store_triples(typing_context, array, at, packed):
    """Write the lower three bytes of each lane one after the other, from byte `at` on."""

    def generate(context, builder, sig, args):
        index = context.cast(builder, args[1], sig.args[1], types.int64)
        if lanes_are_threads(context):
            _store_triple(context, builder, (array, args[0]), index, args[2])
            return context.get_dummy_value()
        pointer = pointer_to(context, builder, array, args[0], index)
        bytes_ = builder.bitcast(args[2], ir.VectorType(ir.IntType(8), 4 * WIDTH))
        order = order_of(4 * (k // 3) + k % 3 for k in range(3 * WIDTH))
        three = builder.shuffle_vector(bytes_, ir.Constant(bytes_.type, ir.Undefined), order)
        builder.store(three, builder.bitcast(pointer, three.type.as_pointer())).align = 1
        return context.get_dummy_value()

    return types.void(array, at, packed), generate


@intrinsic
def store_triples_two(typing_context, array, at, step, packed):
    """Write what `store_triples` does, the second four `step` after the first."""

    def generate(context, builder, sig, args):
        pointer = place_of_half(context, builder, sig, args, 3, 0)
        if lanes_are_threads(context):
            _store_bytes(builder, pointer, args[3])
            return context.get_dummy_value()
        bytes_ = builder.bitcast(args[3], ir.VectorType(ir.IntType(8), 4 * WIDTH))
        for half in range(2):
            lanes = range(half * WIDTH // 2, (half + 1) * WIDTH // 2)
            order = order_of(4 * lane + k for lane in lanes for k in range(3))
            three = builder.shuffle_vector(bytes_, ir.Constant(bytes_.type, ir.Undefined), order)
            pointer = place_of_half(context, builder, sig, args, 3, half)
            builder.store(three, builder.bitcast(pointer, three.type.as_pointer())).align = 1
        return context.get_dummy_value()

    return types.void(array, at, step, packed), generate


def _store_triple(
    context: Any,
    builder: Any,
    array: tuple[types.Type, ir.Value],
    index: ir.Value,
    packed: ir.Value,
) -> None:
    """Write a thread's own three bytes of `store_triples`."""
    lane = builder.zext(threads.lane_number(builder), I64)
    first = builder.add(index, builder.mul(lane, I64(3)))
    _store_bytes(builder, pointer_to(context, builder, *array, first), packed)


def _store_bytes(builder: Any, pointer: ir.Value, packed: ir.Value) -> None:
    """Write the lower three bytes of a number of each thread."""
    for k in range(3):
        byte = builder.trunc(builder.lshr(packed, I32(8 * k)), ir.IntType(8))
        builder.store(byte, builder.gep(pointer, [I64(k)]))
    threads.agree(builder)
