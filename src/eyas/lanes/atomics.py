"""An atomic counter."""

import numba
from numba.extending import intrinsic

__all__ = ["claim"]


@intrinsic
def claim(typing_context, counter):
    """Return the first number of an array of int64 and add one to it, atomically."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(counter)(context, builder, arguments[0])
        one = context.get_constant(numba.int64, 1)
        return builder.atomic_rmw("add", array.data, one, "monotonic")

    return numba.int64(counter), generate
