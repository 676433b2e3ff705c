"""The 64 bits of a float64 as an int64, and back."""

import numba
from llvmlite import ir
from numba.extending import intrinsic

__all__ = ["bits_of_float", "float_of_bits"]


@intrinsic
def bits_of_float(typing_context, value):
    """Return the bits of a float64: sign, exponent and fraction, from the highest."""

    def generate(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return numba.int64(numba.float64), generate


@intrinsic
def float_of_bits(typing_context, bits):
    """Return the float64 that has these bits."""

    def generate(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.DoubleType())

    return numba.float64(numba.int64), generate
