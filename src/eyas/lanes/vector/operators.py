"""Operators between lanes, and between lanes and a number; they round as for single numbers.

No operation may be contracted to a fused one, so all processors compute the same.
"""

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin

from eyas.lanes.vector.kinds import MASK, Lanes, as_lanes, element_of

__all__: list[str] = []

_ARITHMETIC = {  # of floats, of signed integers, of unsigned ones
    operator.add: ("fadd", "add", "add"),
    operator.sub: ("fsub", "sub", "sub"),
    operator.mul: ("fmul", "mul", "mul"),
    operator.truediv: ("fdiv", None, None),
    operator.and_: (None, "and_", "and_"),
    operator.or_: (None, "or_", "or_"),
    operator.xor: (None, "xor", "xor"),
    operator.lshift: (None, "shl", "shl"),
    operator.rshift: (None, "ashr", "lshr"),
    operator.iadd: ("fadd", "add", "add"),
    operator.isub: ("fsub", "sub", "sub"),
    operator.imul: ("fmul", "mul", "mul"),
    operator.itruediv: ("fdiv", None, None),
    operator.iand: (None, "and_", "and_"),
    operator.ior: (None, "or_", "or_"),
    operator.ixor: (None, "xor", "xor"),
}
_COMPARISONS = {
    operator.lt: "<",
    operator.le: "<=",
    operator.gt: ">",
    operator.ge: ">=",
    operator.eq: "==",
    operator.ne: "!=",
}


def _suits(element: types.Type, kind: types.Type) -> bool:
    """Return whether a value may be combined with lanes of an element type.

    A number of float64 may not: with a number in the place of the lanes it would widen the
    result, and the two back ends would differ.
    """
    if isinstance(kind, Lanes):
        return bool(kind.element == element)
    if isinstance(element, types.Float):
        return bool(types.unliteral(kind) == element)
    return isinstance(kind, (types.Integer, types.Boolean))


def _register(function: Callable[..., Any], lower: Callable[..., Any], *, compares: bool) -> None:
    @infer_global(function)
    class Template(AbstractTemplate):  # type: ignore[misc]  # numba has no types
        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:  # noqa: ANN401
            if len(args) != 2 or not any(isinstance(kind, Lanes) for kind in args):
                return None
            element = element_of(*args)
            if not all(_suits(element, kind) for kind in args):
                return None
            return signature(MASK if compares else Lanes(element), *args)

    for kinds in ((Lanes, Lanes), (Lanes, types.Any), (types.Any, Lanes)):
        lower_builtin(function, *kinds)(lower)


def _operands(context: Any, builder: Any, sig: Any, args: Any) -> tuple[types.Type, list[ir.Value]]:  # noqa: ANN401
    element = element_of(*sig.args)
    wanted = Lanes(element)
    pairs = zip(sig.args, args, strict=True)
    return element, [as_lanes(context, builder, kind, value, wanted) for kind, value in pairs]


def _arithmetic(names: tuple[str | None, str | None, str | None]) -> Callable[..., Any]:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:  # noqa: ANN401
        element, (a, b) = _operands(context, builder, sig, args)
        if isinstance(element, types.Float):
            name = names[0]
        else:
            name = names[1 if getattr(element, "signed", False) else 2]
        return getattr(builder, str(name))(a, b)

    return lower


def _comparison(symbol: str) -> Callable[..., Any]:
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:  # noqa: ANN401
        element, (a, b) = _operands(context, builder, sig, args)
        if isinstance(element, types.Float):
            compare = builder.fcmp_unordered if symbol == "!=" else builder.fcmp_ordered
        else:
            signed = getattr(element, "signed", False)
            compare = builder.icmp_signed if signed else builder.icmp_unsigned
        return compare(symbol, a, b)

    return lower


for _function, _names in _ARITHMETIC.items():
    _register(_function, _arithmetic(_names), compares=False)
for _function, _symbol in _COMPARISONS.items():
    _register(_function, _comparison(_symbol), compares=True)


def _register_unary(function: Callable[..., Any], lower: Callable[..., Any]) -> None:
    @infer_global(function)
    class Template(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:  # noqa: ANN401
            if len(args) == 1 and isinstance(args[0], Lanes):
                return signature(args[0], *args)
            return None

    lower_builtin(function, Lanes)(lower)


def _negative(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:  # noqa: ANN401
    floating = isinstance(sig.args[0].element, types.Float)
    return builder.fneg(args[0]) if floating else builder.neg(args[0])


def _inverse(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:  # noqa: ANN401
    return builder.not_(args[0])


_register_unary(operator.neg, _negative)
_register_unary(operator.invert, _inverse)
