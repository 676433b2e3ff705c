"""The type of lanes: eight numbers that one instruction handles at once.

On a processor they are a vector. On a graphics processor they are eight threads of a warp, each of
which holds its own number: what is one number for all lanes is computed by each of them, and what
combines lanes is an instruction between threads.
"""

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import models, register_model

from eyas.lanes.vector import WIDTH


class Lanes(types.Type):
    """The numba type of `WIDTH` numbers of an element type; `<8 x float>` in LLVM.

    LLVM splits it where the processor's vectors are shorter, so it works everywhere.
    """

    def __init__(self, element: types.Type) -> None:
        self.element = element
        super().__init__(name=f"Lanes({element})")


F4, I4, U4 = Lanes(types.float32), Lanes(types.int32), Lanes(types.uint32)
I8, MASK = Lanes(types.int64), Lanes(types.boolean)


def element_of(*kinds: types.Type) -> types.Type:
    """Return the element type of the first lanes among some types, or of the first number."""
    for kind in kinds:
        if isinstance(kind, Lanes):
            return kind.element
    return types.unliteral(kinds[0])


def lanes_are_threads(context: Any) -> bool:  # noqa: ANN401  # numba has no types
    """Return whether code is made for a graphics processor, where each lane is a thread."""
    return getattr(context, "lanes_are_threads", False)


def ir_type(kind: types.Type, *, threads: bool) -> ir.Type:
    """Return LLVM's type of lanes, or of a number as the kernels hold it.

    Args:
        kind: The type.
        threads: See `lanes_are_threads`.
    """
    element = element_of(kind)
    if isinstance(element, types.Boolean):
        single: ir.Type = ir.IntType(1)
    elif isinstance(element, types.Float):
        single = ir.FloatType() if element.bitwidth == 32 else ir.DoubleType()
    else:
        single = ir.IntType(element.bitwidth)
    return ir.VectorType(single, WIDTH) if isinstance(kind, Lanes) and not threads else single


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lanes) -> None:  # noqa: ANN401
        super().__init__(manager, kind, ir_type(kind, threads=False))


class ThreadModel(models.PrimitiveModel):
    """How a thread of a graphics processor holds lanes: its own number."""

    def __init__(self, manager: Any, kind: Lanes) -> None:  # noqa: ANN401
        super().__init__(manager, kind, ir_type(kind, threads=True))


def as_lanes(
    context: Any,  # noqa: ANN401
    builder: Any,  # noqa: ANN401
    kind: types.Type,
    value: ir.Value,
    wanted: types.Type,
) -> ir.Value:
    """Return a value as the wanted lanes, each with the number if it is one; or as a number."""
    if isinstance(kind, Lanes):
        return value
    element = element_of(wanted)
    number = context.cast(builder, value, kind, element)
    if not isinstance(wanted, Lanes) or lanes_are_threads(context):
        return number
    vector = ir.VectorType(number.type, WIDTH)
    nothing = ir.Constant(vector, ir.Undefined)
    one = builder.insert_element(nothing, number, ir.IntType(32)(0))
    order = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [ir.IntType(32)(0)] * WIDTH)
    return builder.shuffle_vector(one, nothing, order)
