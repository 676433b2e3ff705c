"""What kernels do that Python cannot express, made of parts of numba.

Bundles come by pointer: a kernel reads `bundle.field` of a named tuple, and loads only that. By
value, a call copies every word of its bundles, some hundred, and each caller is compiled with code
that takes them apart.
"""

from typing import Any

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import intrinsic

from eyas.lanes.vector import threads
from eyas.lanes.vector.kinds import lanes_are_threads


def _field_type(pointer: types.CPointer, name: str) -> types.Type | None:
    """Return the type of a field of the named tuple that a pointer points to, if it has it."""
    kind = pointer.dtype
    if isinstance(kind, types.BaseNamedTuple) and name in kind.fields:
        return kind[kind.fields.index(name)]
    return None


def _load_field(context: Any, builder: Any, kind: types.CPointer, pointer: Any, name: str) -> Any:
    """Return the value of a field, loaded through the pointer."""
    index = kind.dtype.fields.index(name)
    field = context.data_model_manager[kind.dtype[index]]
    return field.load_from_data_pointer(builder, cgutils.gep_inbounds(builder, pointer, 0, index))


@infer_getattr
class _Fields(AttributeTemplate):  # type: ignore[misc]  # numba has no types
    key = types.CPointer

    def generic_resolve(self, pointer: types.CPointer, name: str) -> types.Type | None:
        return _field_type(pointer, name)


lower_getattr_generic(types.CPointer)(_load_field)


@intrinsic
def address_of(typing_context, bundle):
    """Return a pointer to a copy of a bundle on the stack of the calling kernel.

    A pointer is read like the bundle itself, so annotations of kernels name the bundle's type.
    """

    def generate(context, builder, sig, args):
        model = context.data_model_manager[bundle]
        kind = model.get_data_type()
        name = threads.RECORD if lanes_are_threads(context) else ""
        slot = cgutils.alloca_once(builder, kind, name=name)
        builder.store(model.as_data(builder, args[0]), slot)
        return slot

    return types.CPointer(bundle)(bundle), generate


@intrinsic
def claim(typing_context, counter):
    """Return the first number of an array of int64 and add one to it, atomically."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(counter)(context, builder, arguments[0])
        one = context.get_constant(numba.int64, 1)
        return builder.atomic_rmw("add", array.data, one, "monotonic")

    return numba.int64(counter), generate


@intrinsic
def bits_of_float(typing_context, value):
    """Return the bits of a float64 as an int64: sign, exponent and fraction, from the highest."""

    def generate(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return numba.int64(numba.float64), generate


@intrinsic
def float_of_bits(typing_context, bits):
    """Return the float64 that has these bits."""

    def generate(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.DoubleType())

    return numba.float64(numba.int64), generate
