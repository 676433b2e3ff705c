"""Kernel operations that Python cannot express: memory layout of values, an atomic counter."""

import hashlib

import numba
from numba.extending import intrinsic

__all__ = ["claim", "layout_of", "size_of", "store"]


@intrinsic
def size_of(typing_context, value):
    """Return the size of a value in memory [bytes]."""

    def generate(context, builder, signature, arguments):
        size = context.get_abi_sizeof(context.get_data_type(value))
        return context.get_constant(numba.intp, size)

    return numba.intp(value), generate


@intrinsic
def layout_of(typing_context, value):
    """Return a positive number that identifies the type of a value, the same in every process."""
    number = int.from_bytes(hashlib.sha256(str(value).encode()).digest()[:7])

    def generate(context, builder, signature, arguments):
        return context.get_constant(numba.intp, number)

    return numba.intp(value), generate


@intrinsic
def store(typing_context, memory, value):
    """Write a value into an array of bytes, in the layout that `CPointer` reads."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(memory)(context, builder, arguments[0])
        kind = context.get_data_type(value).as_pointer()
        context.pack_value(builder, value, arguments[1], builder.bitcast(array.data, kind))
        return context.get_dummy_value()

    return numba.void(memory, value), generate


@intrinsic
def claim(typing_context, counter):
    """Return the first number of an array of int64 and add one to it, atomically."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(counter)(context, builder, arguments[0])
        one = context.get_constant(numba.int64, 1)
        return builder.atomic_rmw("add", array.data, one, "monotonic")

    return numba.int64(counter), generate
