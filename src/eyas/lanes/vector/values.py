"""Functions of lanes, or of numbers: choosing, comparing, converting."""

import math
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from eyas.lanes.vector import WIDTH, threads
from eyas.lanes.vector.kinds import I4, Lanes, as_lanes, element_of, ir_type, lanes_are_threads

Generate = Callable[..., ir.Value]


def _joined(*kinds: types.Type) -> types.Type:
    """Return the type that values of these types have together: lanes if any of them is."""
    element = element_of(*kinds)
    return Lanes(element) if any(isinstance(kind, Lanes) for kind in kinds) else element


def _of(kind: types.Type, element: types.Type) -> types.Type:
    """Return lanes of an element type if the given type is lanes, else the element type."""
    return Lanes(element) if isinstance(kind, Lanes) else element


@intrinsic
def select(typing_context, mask, a, b):
    """Return `a` where the mask is set, else `b`; both are computed."""
    result = _of(mask, element_of(a, b)) if isinstance(mask, Lanes) else _joined(a, b)

    def generate(context, builder, sig, args):
        x = as_lanes(context, builder, sig.args[1], args[1], result)
        y = as_lanes(context, builder, sig.args[2], args[2], result)
        return builder.select(args[0], x, y)

    return result(mask, a, b), generate


def _extreme(symbol: str) -> Callable[..., Any]:
    def typed(typing_context, a, b):
        result = _joined(a, b)
        element = element_of(result)

        def generate(context, builder, sig, args):
            x = as_lanes(context, builder, sig.args[0], args[0], result)
            y = as_lanes(context, builder, sig.args[1], args[1], result)
            if isinstance(element, types.Float):
                first = builder.fcmp_ordered(symbol, x, y)
            else:
                compare = builder.icmp_signed if element.signed else builder.icmp_unsigned
                first = compare(symbol, x, y)
            return builder.select(first, x, y)

        return result(a, b), generate

    typed.__name__ = {"<": "lesser", ">": "greater"}[symbol]
    typed.__doc__ = f"Return `a` where `a {symbol} b`, else `b`, also where `a` is NaN."
    return typed


lesser = intrinsic(_extreme("<"))
greater = intrinsic(_extreme(">"))


def _bits(context: Any, builder: Any, kind: types.Type, mask: ir.Value) -> ir.Value:
    if not isinstance(kind, Lanes):
        return mask
    if lanes_are_threads(context):
        return threads.ballot(builder, mask)
    return builder.bitcast(mask, ir.IntType(WIDTH))


@intrinsic
def any_of(typing_context, mask):
    """Return whether the mask is set in any lane."""

    def generate(context, builder, sig, args):
        bits = _bits(context, builder, mask, args[0])
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), generate


@intrinsic
def all_of(typing_context, mask):
    """Return whether the mask is set in every lane."""

    def generate(context, builder, sig, args):
        bits = _bits(context, builder, mask, args[0])
        return builder.icmp_unsigned("==", bits, ir.Constant(bits.type, -1))

    return types.boolean(mask), generate


@intrinsic
def any_bits(typing_context, a):
    """Return the bits that are set in any lane of int32, as one number."""

    def generate(context, builder, sig, args):
        if not isinstance(a, Lanes):
            return context.cast(builder, args[0], a, types.int32)
        if lanes_are_threads(context):
            raise NotImplementedError("any_bits: of lanes that are threads, ask each for its own")
        kind = ir.FunctionType(ir.IntType(32), [args[0].type])
        name = f"llvm.vector.reduce.or.v{WIDTH}i32"
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), args)

    return types.int32(a), generate


@intrinsic
def bits_of(typing_context, mask):
    """Return the mask as a number, lane 0 in its lowest bit."""

    def generate(context, builder, sig, args):
        return builder.zext(_bits(context, builder, mask, args[0]), ir.IntType(64))

    return types.int64(mask), generate


@intrinsic
def count_bits(typing_context, bits):
    """Return how many bits of a number are set."""

    def generate(context, builder, sig, args):
        return builder.ctpop(args[0])

    return types.int64(types.int64), generate


@intrinsic
def first_bit(typing_context, bits):
    """Return the number of the lowest set bit of a number that is not 0."""

    def generate(context, builder, sig, args):
        return builder.cttz(args[0], ir.IntType(1)(1))

    return types.int64(types.int64), generate


def _unary(name: str, of_number: Callable[..., Any], *, gives_integers: bool = False) -> Any:
    """Return a function of floats: LLVM's for lanes, Python's for a number, for CUDA knows that."""

    def typed(typing_context, a):
        def generate(context, builder, sig, args):
            kind = args[0].type
            if isinstance(a, Lanes):
                width = "" if lanes_are_threads(context) else f"v{WIDTH}"
                overload = f"llvm.{name}.{width}f{a.element.bitwidth}"
                function = cgutils.get_or_insert_function(
                    builder.module, ir.FunctionType(kind, [kind]), overload
                )
                return builder.call(function, [args[0]])
            result = types.int64 if gives_integers else a
            value = context.get_function(of_number, result(a))(builder, args)
            return builder.sitofp(value, kind) if gives_integers else value

        return a(a), generate

    typed.__name__ = name
    return intrinsic(typed)


root = _unary("sqrt", math.sqrt)
magnitude = _unary("fabs", abs)
ceiling = _unary("ceil", math.ceil, gives_integers=True)
whole = _unary("floor", math.floor, gives_integers=True)


def _converting(element: types.Type) -> Callable[..., Any]:
    def typed(typing_context, a):
        result, source = _of(a, element), element_of(a)

        def generate(context, builder, sig, args):
            value, target = args[0], ir_type(result, threads=lanes_are_threads(context))
            if not isinstance(a, Lanes):
                return context.cast(builder, value, source, element)
            if isinstance(element, types.Float):
                if isinstance(source, types.Float):
                    wider = element.bitwidth > source.bitwidth
                    return (builder.fpext if wider else builder.fptrunc)(value, target)
                # One instruction converts signed numbers; ours are below 2**31.
                return builder.sitofp(value, target)
            if isinstance(source, types.Float):
                return builder.fptosi(value, target)
            if isinstance(source, types.Boolean) or element.bitwidth > source.bitwidth:
                signed = getattr(source, "signed", False)
                return (builder.sext if signed else builder.zext)(value, target)
            return builder.trunc(value, target) if value.type != target else value

        return result(a), generate

    typed.__name__ = f"to_{element}"
    typed.__doc__ = f"Return values as {element}; fractions are cut off."
    return typed


to_f4 = intrinsic(_converting(types.float32))
to_f8 = intrinsic(_converting(types.float64))
to_i4 = intrinsic(_converting(types.int32))
to_i8 = intrinsic(_converting(types.int64))
to_u4 = intrinsic(_converting(types.uint32))


@intrinsic
def bit_pattern(typing_context, a):
    """Return the bits of a float32 as an int32."""
    result = _of(a, types.int32)

    def generate(context, builder, sig, args):
        return builder.bitcast(args[0], ir_type(result, threads=lanes_are_threads(context)))

    return result(a), generate


@intrinsic
def from_bits(typing_context, a):
    """Return the float32 that has the bits of an int32."""
    result = _of(a, types.float32)

    def generate(context, builder, sig, args):
        number = context.cast(builder, args[0], a, types.int32) if result is types.float32 else None
        bits = args[0] if number is None else number
        return builder.bitcast(bits, ir_type(result, threads=lanes_are_threads(context)))

    return result(a), generate


@intrinsic
def splat(typing_context, a):
    """Return lanes that all hold a number."""
    result = Lanes(types.unliteral(a))

    def generate(context, builder, sig, args):
        return as_lanes(context, builder, sig.args[0], args[0], result)

    return result(a), generate


@intrinsic
def like(typing_context, model, a):
    """Return a number in as many lanes as `model` has."""
    result = _of(model, types.unliteral(a))

    def generate(context, builder, sig, args):
        return as_lanes(context, builder, sig.args[1], args[1], result)

    return result(model, a), generate


@intrinsic
def lane_numbers(typing_context):
    """Return 0, 1, ... in the lanes."""

    def generate(context, builder, sig, args):
        if lanes_are_threads(context):
            return threads.lane_number(builder)
        numbers = [ir.IntType(32)(k) for k in range(WIDTH)]
        return ir.Constant(ir_type(I4, threads=False), numbers)

    return I4(), generate


@intrinsic
def lane(typing_context, lanes, number):
    """Return the number in one lane."""

    def generate(context, builder, sig, args):
        index = context.cast(builder, args[1], sig.args[1], types.int32)
        if lanes_are_threads(context):
            return threads.from_lane(builder, args[0], index)
        return builder.extract_element(args[0], index)

    return lanes.element(lanes, number), generate


@intrinsic
def own(typing_context, lanes):
    """Return the number in the thread's own lane; for kernels of threads only."""

    def generate(context, builder, sig, args):
        if not lanes_are_threads(context):
            raise NotImplementedError("own: lanes are threads on graphics processors only")
        return args[0]

    return lanes.element(lanes), generate
