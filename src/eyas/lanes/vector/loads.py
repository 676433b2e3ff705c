"""Loads of lanes from arrays."""

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from eyas.lanes.vector import WIDTH
from eyas.lanes.vector.kinds import F4, U4, Lanes, ir_type, lanes_are_threads
from eyas.lanes.vector.places import (
    I32,
    I64,
    each_index,
    loaded,
    order_of,
    place_of_half,
    place_of_lanes,
    pointer_to,
)


def _collected(builder: Any, kind: types.Type, items: list[ir.Value]) -> ir.Value:
    if len(items) == 1:
        return items[0]
    value = ir.Constant(ir_type(kind, threads=False), ir.Undefined)
    for k, item in enumerate(items):
        value = builder.insert_element(value, item, I32(k))
    return value


def _numbered(kind: types.Type, element: types.Type) -> types.Type:
    return Lanes(element) if isinstance(kind, Lanes) else element


@intrinsic
def gather(typing_context, array, index):
    """Return the elements at some indices, none negative; smaller types become uint32."""
    element = array.dtype if array.dtype.bitwidth >= 32 else types.uint32
    result = _numbered(index, element)

    def generate(context, builder, sig, args):
        places = each_index(context, builder, index, args[1])
        items = [builder.load(pointer_to(context, builder, array, args[0], at)) for at in places]
        if array.dtype.bitwidth >= 32:
            return _collected(builder, result, items)
        if len(items) == 1:
            return builder.zext(items[0], I32)
        # Widened together: once, and each is loaded straight into its place.
        small = ir.Constant(ir.VectorType(items[0].type, WIDTH), ir.Undefined)
        for k, item in enumerate(items):
            small = builder.insert_element(small, item, I32(k))
        return builder.zext(small, ir.VectorType(I32, WIDTH))

    return result(array, index), generate


@intrinsic
def gather_pair(typing_context, array, index):
    """Return pairs of neighbours of an array of uint16, the first in the lower half."""
    result = _numbered(index, types.uint32)

    def generate(context, builder, sig, args):
        items = []
        for at in each_index(context, builder, index, args[1]):
            pointer = pointer_to(context, builder, array, args[0], at)
            items.append(loaded(builder, builder.bitcast(pointer, I32.as_pointer()), 2))
        return _collected(builder, result, items)

    return result(array, index), generate


@intrinsic
def gather_pair_after(typing_context, array, index, step):
    """Return the same as `gather_pair(array, index + step)`, for one step of all lanes.

    If both are gathered, the indices are taken out of the lanes only once.
    """
    result = _numbered(index, types.uint32)

    def generate(context, builder, sig, args):
        step = context.cast(builder, args[2], sig.args[2], types.int64)
        items = []
        for at in each_index(context, builder, index, args[1]):
            pointer = pointer_to(context, builder, array, args[0], at)
            pointer = builder.bitcast(builder.gep(pointer, [step]), I32.as_pointer())
            items.append(loaded(builder, pointer, 2))
        return _collected(builder, result, items)

    return result(array, index, step), generate


def _two_of_each(builder: Any, pointers: list[ir.Value]) -> tuple[ir.Value, ir.Value]:
    """Return the 32 bits at some places, and the 32 bits after them, as uint32."""
    if len(pointers) == 1:
        first = pointers[0]
        return builder.load(first), builder.load(builder.gep(first, [I64(1)]))
    # Two lanes fill half a register, in the order that one shuffle puts right. They are moved as
    # doubles, which LLVM loads straight into their place.
    halves = []
    for lanes in ((0, 1, 4, 5), (2, 3, 6, 7)):
        value = ir.Constant(ir.VectorType(ir.DoubleType(), 4), ir.Undefined)
        for k, lane in enumerate(lanes):
            pointer = builder.bitcast(pointers[lane], ir.DoubleType().as_pointer())
            value = builder.insert_element(value, loaded(builder, pointer, 4), I32(k))
        halves.append(builder.bitcast(value, ir_type(U4, threads=False)))
    order = [0, 2, 8, 10, 4, 6, 12, 14]
    first = builder.shuffle_vector(*halves, order_of(order))
    return first, builder.shuffle_vector(*halves, order_of([k + 1 for k in order]))


@intrinsic
def gather_square(typing_context, array, index, step):
    """Return the elements at some indices of an array of uint32, those after them, and the same two
    `step` elements on, one step for all lanes: half the loads of four `gather`.
    """
    result = types.UniTuple(_numbered(index, types.uint32), 4)

    def generate(context, builder, sig, args):
        step = context.cast(builder, args[2], sig.args[2], types.int64)
        upper = [
            pointer_to(context, builder, array, args[0], at)
            for at in each_index(context, builder, index, args[1])
        ]
        lower = [builder.gep(pointer, [step]) for pointer in upper]
        four = [*_two_of_each(builder, upper), *_two_of_each(builder, lower)]
        return context.make_tuple(builder, result, four)

    return result(array, index, step), generate


@intrinsic
def gather_column(typing_context, array, index, column, width):
    """Return `array[index, column]` of rows of `width` elements."""
    result = _numbered(index, array.dtype)

    def generate(context, builder, sig, args):
        offset = context.cast(builder, args[2], sig.args[2], types.int64)
        step = context.cast(builder, args[3], sig.args[3], types.int64)
        items = []
        for row in each_index(context, builder, index, args[1]):
            at = builder.add(builder.mul(row, step), offset)
            items.append(builder.load(pointer_to(context, builder, array, args[0], at)))
        return _collected(builder, result, items)

    return result(array, index, column, width), generate


@intrinsic
def transposed(typing_context, array, index, first, width, guide):
    """Return `array[index, first + k]` for k from 0 to 7, of rows of `width` float32.

    Eight loads and shuffles take the place of 64 loads; where all lanes of `guide` are the same, as
    many are, so must those of `index` be, and each number is loaded into all of them. Loads that
    follow each other have one guide: the processor then foresees all branches but the first. Where
    lanes are threads, each loads four numbers at once: in arrays of whole rows, `width` and `first`
    must be multiples of four.
    """
    result = types.UniTuple(_numbered(index, types.float32), 8)

    def generate(context, builder, sig, args):
        offset = context.cast(builder, args[2], sig.args[2], types.int64)
        step = context.cast(builder, args[3], sig.args[3], types.int64)

        def row_at(row: ir.Value) -> ir.Value:
            at = builder.add(builder.mul(row, step), offset)
            return pointer_to(context, builder, array, args[0], at)

        def numbers_of(row: ir.Value) -> list[ir.Value]:
            return [builder.load(builder.gep(row_at(row), [I64(k)])) for k in range(8)]

        def halves_of(row: ir.Value) -> list[ir.Value]:
            four = ir.VectorType(ir.FloatType(), 4)
            place = builder.bitcast(row_at(row), four.as_pointer())
            halves = [builder.load(builder.gep(place, [I64(k)]), align=16) for k in range(2)]
            return [builder.extract_element(half, I32(k)) for half in halves for k in range(4)]

        places = each_index(context, builder, index, args[1])
        if lanes_are_threads(context):
            return context.make_tuple(builder, result, halves_of(places[0]))
        if not isinstance(index, Lanes):
            return context.make_tuple(builder, result, numbers_of(places[0]))
        kind = ir_type(F4, threads=False)
        with builder.if_else(_all_alike(builder, args[4])) as (alike, apart):
            with alike:
                broad = [_in_all(builder, number) for number in numbers_of(places[0])]
                from_one = builder.block
            with apart:
                pointers = [builder.bitcast(row_at(row), kind.as_pointer()) for row in places]
                columns = _columns_of(builder, [loaded(builder, p, 4) for p in pointers])
                from_all = builder.block
        values = []
        for one, column in zip(broad, columns, strict=True):
            value = builder.phi(kind)
            value.add_incoming(one, from_one)
            value.add_incoming(column, from_all)
            values.append(value)
        return context.make_tuple(builder, result, values)

    return result(array, index, first, width, guide), generate


@intrinsic
def prefetch(typing_context, array, index):
    """Have elements, and what lies beside them, brought into the cache, to be loaded later.

    Where lanes are threads, nothing is done: others work while some wait.
    """

    def generate(context, builder, sig, args):
        if lanes_are_threads(context):
            return context.get_dummy_value()
        byte = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [byte, I32, I32, I32])
        fetch = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0i8")
        for at in each_index(context, builder, index, args[1]):
            pointer = builder.bitcast(pointer_to(context, builder, array, args[0], at), byte)
            builder.call(fetch, [pointer, I32(0), I32(3), I32(1)])  # to be read, often, data
        return context.get_dummy_value()

    return types.void(array, index), generate


def _loading(result: types.Type) -> Any:
    def generate(context, builder, sig, args):
        kind = ir_type(result, threads=lanes_are_threads(context))
        size = max(result.element.bitwidth // 8, 1)
        return loaded(builder, *place_of_lanes(context, builder, sig, args, kind, size))

    return generate


@intrinsic
def load(typing_context, array, at):
    """Return eight elements in a row, from index `at` on."""
    result = Lanes(array.dtype)
    return result(array, at), _loading(result)


@intrinsic
def load_words(typing_context, array, at):
    """Return eight uint32 from an array of bytes, from byte `at` on."""
    return U4(array, at), _loading(U4)


def _loading_two(result: types.Type) -> Any:
    def generate(context, builder, sig, args):
        number = result.element.bitwidth // 8
        size = number // (sig.args[0].dtype.bitwidth // 8)
        kind, align = ir.VectorType(ir_type(result, threads=True), WIDTH // 2), number // size
        if lanes_are_threads(context):
            kind, align = ir_type(result, threads=True), number
        halves = []
        for half in range(1 if lanes_are_threads(context) else 2):
            pointer = place_of_half(context, builder, sig, args, size, half)
            halves.append(loaded(builder, builder.bitcast(pointer, kind.as_pointer()), align))
        if len(halves) == 1:
            return halves[0]
        return builder.shuffle_vector(*halves, order_of(range(WIDTH)))

    return generate


@intrinsic
def load_two(typing_context, array, at, step):
    """Return four elements in a row, from index `at` on, and four from `step` after it on."""
    result = Lanes(array.dtype)
    return result(array, at, step), _loading_two(result)


@intrinsic
def load_words_two(typing_context, array, at, step):
    """Return uint32 from an array of bytes, as `load_two` does."""
    return U4(array, at, step), _loading_two(U4)


def _in_all(builder: ir.IRBuilder, item: ir.Value) -> ir.Value:
    """Return a number in all lanes."""
    kind = ir.VectorType(item.type, WIDTH)
    lanes = builder.insert_element(ir.Constant(kind, ir.Undefined), item, I32(0))
    return builder.shuffle_vector(lanes, lanes, order_of([0] * WIDTH))


def _all_alike(builder: ir.IRBuilder, index: ir.Value) -> ir.Value:
    """Return whether all lanes hold the same integer."""
    first = builder.shuffle_vector(index, index, order_of([0] * WIDTH))
    same = builder.bitcast(builder.icmp_unsigned("==", index, first), ir.IntType(WIDTH))
    return builder.icmp_unsigned("==", same, ir.Constant(same.type, -1))


def _columns_of(builder: ir.IRBuilder, rows: list[ir.Value]) -> list[ir.Value]:
    """Return the columns of eight rows: pairs, then fours, then halves are exchanged."""

    def mixed(a: ir.Value, b: ir.Value, order: list[int]) -> ir.Value:
        return builder.shuffle_vector(a, b, order_of(order))

    low, high = [0, 8, 1, 9, 4, 12, 5, 13], [2, 10, 3, 11, 6, 14, 7, 15]
    pairs = []
    for k in range(0, 8, 2):
        pairs += [mixed(rows[k], rows[k + 1], low), mixed(rows[k], rows[k + 1], high)]
    even, odd = [0, 1, 8, 9, 4, 5, 12, 13], [2, 3, 10, 11, 6, 7, 14, 15]
    fours = []
    for k in (0, 4):
        fours += [mixed(pairs[k], pairs[k + 2], even), mixed(pairs[k], pairs[k + 2], odd)]
        fours += [mixed(pairs[k + 1], pairs[k + 3], even), mixed(pairs[k + 1], pairs[k + 3], odd)]
    first, last = [0, 1, 2, 3, 8, 9, 10, 11], [4, 5, 6, 7, 12, 13, 14, 15]
    columns = [mixed(fours[k], fours[k + 4], first) for k in range(4)]
    return columns + [mixed(fours[k], fours[k + 4], last) for k in range(4)]
