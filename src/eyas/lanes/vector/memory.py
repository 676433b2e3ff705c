"""Loads and stores of lanes. Arrays are seen as one row, so they must be contiguous."""

from collections.abc import Iterable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from eyas.lanes.vector import WIDTH, threads
from eyas.lanes.vector.kinds import F4, U4, Lanes, as_lanes, ir_type, lanes_are_threads

__all__ = [
    "agree", "claim_some", "gather", "gather_column", "gather_pair", "gather_pair_after",
    "gather_square", "load", "load_two", "load_words", "load_words_two", "prefetch", "scatter",
    "store",
    "store_greater", "store_largest", "store_triples", "store_triples_two", "store_where",
    "store_words", "transposed",
]  # fmt: skip

_I32, _I64 = ir.IntType(32), ir.IntType(64)


def _pointer(context: Any, builder: Any, array: Any, value: Any, at: Any) -> ir.Value:
    data = context.make_array(array)(context, builder, value).data
    return builder.gep(data, [at])


def _load(builder: Any, pointer: Any, align: int) -> ir.Value:
    value = builder.load(pointer)
    value.align = align
    return value


def _each(context: Any, builder: Any, kind: types.Type, index: ir.Value) -> list[ir.Value]:
    """Return the indices in the lanes, or the one index, as 64 bits; none is negative.

    A thread has one: its own.
    """
    if not isinstance(kind, Lanes) or lanes_are_threads(context):
        return [index if index.type == _I64 else builder.zext(index, _I64)]
    items = [builder.extract_element(index, _I32(k)) for k in range(WIDTH)]
    return [builder.zext(item, _I64) for item in items]


def _collected(builder: Any, kind: types.Type, items: list[ir.Value]) -> ir.Value:
    if len(items) == 1:
        return items[0]
    value = ir.Constant(ir_type(kind, threads=False), ir.Undefined)
    for k, item in enumerate(items):
        value = builder.insert_element(value, item, _I32(k))
    return value


def _numbered(kind: types.Type, element: types.Type) -> types.Type:
    return Lanes(element) if isinstance(kind, Lanes) else element


@intrinsic
def gather(typing_context, array, index):
    """Return the elements at some indices, none negative; smaller types become uint32."""
    element = array.dtype if array.dtype.bitwidth >= 32 else types.uint32
    result = _numbered(index, element)

    def generate(context, builder, sig, args):
        places = _each(context, builder, index, args[1])
        items = [builder.load(_pointer(context, builder, array, args[0], at)) for at in places]
        if array.dtype.bitwidth >= 32:
            return _collected(builder, result, items)
        if len(items) == 1:
            return builder.zext(items[0], _I32)
        # Widened together: once, and each is loaded straight into its place.
        small = ir.Constant(ir.VectorType(items[0].type, WIDTH), ir.Undefined)
        for k, item in enumerate(items):
            small = builder.insert_element(small, item, _I32(k))
        return builder.zext(small, ir.VectorType(_I32, WIDTH))

    return result(array, index), generate


@intrinsic
def gather_pair(typing_context, array, index):
    """Return pairs of neighbours of an array of uint16, the first in the lower half."""
    result = _numbered(index, types.uint32)

    def generate(context, builder, sig, args):
        items = []
        for at in _each(context, builder, index, args[1]):
            pointer = _pointer(context, builder, array, args[0], at)
            items.append(_load(builder, builder.bitcast(pointer, _I32.as_pointer()), 2))
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
        for at in _each(context, builder, index, args[1]):
            pointer = _pointer(context, builder, array, args[0], at)
            pointer = builder.bitcast(builder.gep(pointer, [step]), _I32.as_pointer())
            items.append(_load(builder, pointer, 2))
        return _collected(builder, result, items)

    return result(array, index, step), generate


def _two_of_each(builder: Any, pointers: list[ir.Value]) -> tuple[ir.Value, ir.Value]:
    """Return the 32 bits at some places, and the 32 bits after them, as uint32."""
    if len(pointers) == 1:
        first = pointers[0]
        return builder.load(first), builder.load(builder.gep(first, [_I64(1)]))
    # Two lanes fill half a register, in the order that one shuffle puts right. They are moved as
    # doubles, which LLVM loads straight into their place.
    halves = []
    for lanes in ((0, 1, 4, 5), (2, 3, 6, 7)):
        value = ir.Constant(ir.VectorType(ir.DoubleType(), 4), ir.Undefined)
        for k, lane in enumerate(lanes):
            pointer = builder.bitcast(pointers[lane], ir.DoubleType().as_pointer())
            value = builder.insert_element(value, _load(builder, pointer, 4), _I32(k))
        halves.append(builder.bitcast(value, ir_type(U4, threads=False)))
    order = [0, 2, 8, 10, 4, 6, 12, 14]
    first = builder.shuffle_vector(*halves, _order_of(order))
    return first, builder.shuffle_vector(*halves, _order_of([k + 1 for k in order]))


@intrinsic
def gather_square(typing_context, array, index, step):
    """Return the elements at some indices of an array of uint32, those after them, and the same two
    `step` elements on, one step for all lanes: half the loads of four `gather`.
    """
    result = types.UniTuple(_numbered(index, types.uint32), 4)

    def generate(context, builder, sig, args):
        step = context.cast(builder, args[2], sig.args[2], types.int64)
        upper = [
            _pointer(context, builder, array, args[0], at)
            for at in _each(context, builder, index, args[1])
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
        for row in _each(context, builder, index, args[1]):
            at = builder.add(builder.mul(row, step), offset)
            items.append(builder.load(_pointer(context, builder, array, args[0], at)))
        return _collected(builder, result, items)

    return result(array, index, column, width), generate


@intrinsic
def transposed(typing_context, array, index, first, width):
    """Return `array[index, first + k]` for k from 0 to 7, of rows of `width` float32.

    Eight loads and shuffles take the place of 64 loads; where all lanes want the same row, as many
    do, each number is loaded into all of them.
    """
    result = types.UniTuple(_numbered(index, types.float32), 8)

    def generate(context, builder, sig, args):
        offset = context.cast(builder, args[2], sig.args[2], types.int64)
        step = context.cast(builder, args[3], sig.args[3], types.int64)

        def pointer_to(row: ir.Value) -> ir.Value:
            at = builder.add(builder.mul(row, step), offset)
            return _pointer(context, builder, array, args[0], at)

        def numbers_of(row: ir.Value) -> list[ir.Value]:
            return [builder.load(builder.gep(pointer_to(row), [_I64(k)])) for k in range(8)]

        places = _each(context, builder, index, args[1])
        if not isinstance(index, Lanes) or lanes_are_threads(context):
            return context.make_tuple(builder, result, numbers_of(places[0]))
        kind = ir_type(F4, threads=False)
        with builder.if_else(_all_alike(builder, args[1])) as (alike, apart):
            with alike:
                broad = [_in_all(builder, number) for number in numbers_of(places[0])]
                from_one = builder.block
            with apart:
                pointers = [builder.bitcast(pointer_to(row), kind.as_pointer()) for row in places]
                columns = _columns_of(builder, [_load(builder, p, 4) for p in pointers])
                from_all = builder.block
        values = []
        for one, column in zip(broad, columns, strict=True):
            value = builder.phi(kind)
            value.add_incoming(one, from_one)
            value.add_incoming(column, from_all)
            values.append(value)
        return context.make_tuple(builder, result, values)

    return result(array, index, first, width), generate


@intrinsic
def prefetch(typing_context, array, index):
    """Have elements, and what lies beside them, brought into the cache, to be loaded later.

    Where lanes are threads, nothing is done: others work while some wait.
    """

    def generate(context, builder, sig, args):
        if not lanes_are_threads(context):
            for at in _each(context, builder, index, args[1]):
                pointer = _pointer(context, builder, array, args[0], at)
                pointer = builder.bitcast(pointer, ir.IntType(8).as_pointer())
                kinds = [pointer.type, _I32, _I32, _I32]
                name, kind = f"llvm.prefetch.{pointer.type.intrinsic_name}", ir.VoidType()
                call = cgutils.get_or_insert_function(
                    builder.module, ir.FunctionType(kind, kinds), name
                )
                builder.call(call, [pointer, _I32(0), _I32(3), _I32(1)])  # to read, often, data
        return context.get_dummy_value()

    return types.void(array, index), generate


def _place(
    context: Any, builder: Any, sig: Any, args: Any, kind: ir.Type, size: int
) -> tuple[ir.Value, int]:
    """Return where lanes of a type are read or written, and how that is aligned [bytes].

    Args:
        context: numba's.
        builder: numba's.
        sig: Signature of an operation on an array and an index.
        args: Its arguments.
        kind: LLVM's type of what lies there.
        size: That of one lane, and of an element of the array if that is smaller [bytes].
    """
    at = context.cast(builder, args[1], sig.args[1], types.int64)
    element = sig.args[0].dtype.bitwidth // 8
    if lanes_are_threads(context):
        lane = builder.zext(threads.lane_number(builder), _I64)
        at = builder.add(at, builder.mul(lane, _I64(size // element)))
    pointer = _pointer(context, builder, sig.args[0], args[0], at)
    align = size if lanes_are_threads(context) else element
    return builder.bitcast(pointer, kind.as_pointer()), align


def _loading(result: types.Type) -> Any:
    def generate(context, builder, sig, args):
        kind = ir_type(result, threads=lanes_are_threads(context))
        size = max(result.element.bitwidth // 8, 1)
        return _load(builder, *_place(context, builder, sig, args, kind, size))

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


def _place_of_half(
    context: Any, builder: Any, sig: Any, args: Any, size: int, half: int
) -> ir.Value:
    """Return the pointer to the first element of a half of the lanes; a thread's own element.

    Args:
        context: numba's.
        builder: numba's.
        sig: Signature of an operation on an array, an index, and where the second half begins.
        args: Its arguments.
        size: Elements of the array that a lane takes.
        half: 0 or 1.
    """
    at, step = (context.cast(builder, args[k], sig.args[k], types.int64) for k in (1, 2))
    if lanes_are_threads(context):
        lane = builder.zext(threads.lane_number(builder), _I64)
        aside = builder.mul(builder.and_(lane, _I64(WIDTH // 2 - 1)), _I64(size))
        second = builder.icmp_unsigned(">=", lane, _I64(WIDTH // 2))
        at = builder.add(at, builder.add(aside, builder.select(second, step, _I64(0))))
    elif half:
        at = builder.add(at, step)
    return _pointer(context, builder, sig.args[0], args[0], at)


def _loading_two(result: types.Type) -> Any:
    def generate(context, builder, sig, args):
        number = result.element.bitwidth // 8
        size = number // (sig.args[0].dtype.bitwidth // 8)
        kind, align = ir.VectorType(ir_type(result, threads=True), WIDTH // 2), number // size
        if lanes_are_threads(context):
            kind, align = ir_type(result, threads=True), number
        halves = []
        for half in range(1 if lanes_are_threads(context) else 2):
            pointer = _place_of_half(context, builder, sig, args, size, half)
            halves.append(_load(builder, builder.bitcast(pointer, kind.as_pointer()), align))
        if len(halves) == 1:
            return halves[0]
        return builder.shuffle_vector(*halves, _order_of(range(WIDTH)))

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
        pointer, align = _place(context, builder, sig, args, args[2].type, size)
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
        pointer, align = _place(context, builder, sig, args, args[2].type, 8)
        greater = builder.icmp_signed(">", args[2], args[3])
        if not lanes_are_threads(context):
            chosen = _greatest(builder, args[2], args[3])
            return _store(context, builder, chosen, pointer, align)
        with builder.if_then(greater):
            builder.atomic_rmw("max", pointer, args[2], "monotonic")
        return context.get_dummy_value()

    return types.void(array, at, value, old), generate


@intrinsic
def store_largest(typing_context, array, at, value):
    """Write an int64 if it is greater than what is there, atomically."""

    def generate(context, builder, sig, args):
        index = context.cast(builder, args[1], sig.args[1], types.int64)
        pointer = _pointer(context, builder, array, args[0], index)
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
        found = cgutils.alloca_once_value(builder, _I64(0))
        first = builder.icmp_unsigned("==", threads.lane_number(builder), _I32(0))
        with builder.if_then(first):
            builder.store(builder.atomic_rmw("add", pointer, count, "monotonic"), found)
        return threads.from_lane(builder, builder.load(found), _I32(0))

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
        for k, at in enumerate(_each(context, builder, index, args[1])):
            wanted = args[2] if number else builder.extract_element(args[2], _I32(k))
            element = args[3] if number else builder.extract_element(args[3], _I32(k))
            with builder.if_then(wanted):
                builder.store(element, _pointer(context, builder, array, args[0], at))
        return context.get_dummy_value()

    return types.void(array, index, mask, value), generate


@intrinsic
def store_words(typing_context, array, at, value):
    """Write eight uint32 into an array of bytes, from byte `at` on."""
    return types.void(array, at, value), _storing(4)


@intrinsic
def store_where(typing_context, array, at, mask, value):
    """Write those of eight elements in a row whose mask is set; the others are written back."""
    kind = Lanes(array.dtype)

    def generate(context, builder, sig, args):
        size = array.dtype.bitwidth // 8
        held = ir_type(kind, threads=lanes_are_threads(context))
        pointer, align = _place(context, builder, sig, args, held, size)
        new = as_lanes(context, builder, sig.args[3], args[3], kind)
        if lanes_are_threads(context):  # others may write beside what is wanted
            with builder.if_then(args[2]):
                builder.store(new, pointer).align = align
            threads.agree(builder)
            return context.get_dummy_value()
        chosen = builder.select(args[2], new, _load(builder, pointer, align))
        return _store(context, builder, chosen, pointer, align)

    return types.void(array, at, mask, value), generate


@intrinsic
def store_triples(typing_context, array, at, packed):
    """Write the lower three bytes of each lane one after the other, from byte `at` on."""

    def generate(context, builder, sig, args):
        index = context.cast(builder, args[1], sig.args[1], types.int64)
        if lanes_are_threads(context):
            _store_triple(context, builder, (array, args[0]), index, args[2])
            return context.get_dummy_value()
        pointer = _pointer(context, builder, array, args[0], index)
        bytes_ = builder.bitcast(args[2], ir.VectorType(ir.IntType(8), 4 * WIDTH))
        order = _order_of(4 * (k // 3) + k % 3 for k in range(3 * WIDTH))
        three = builder.shuffle_vector(bytes_, ir.Constant(bytes_.type, ir.Undefined), order)
        builder.store(three, builder.bitcast(pointer, three.type.as_pointer())).align = 1
        return context.get_dummy_value()

    return types.void(array, at, packed), generate


@intrinsic
def store_triples_two(typing_context, array, at, step, packed):
    """Write what `store_triples` does, the second four `step` after the first."""

    def generate(context, builder, sig, args):
        pointer = _place_of_half(context, builder, sig, args, 3, 0)
        if lanes_are_threads(context):
            _store_bytes(builder, pointer, args[3])
            return context.get_dummy_value()
        bytes_ = builder.bitcast(args[3], ir.VectorType(ir.IntType(8), 4 * WIDTH))
        for half in range(2):
            lanes = range(half * WIDTH // 2, (half + 1) * WIDTH // 2)
            order = _order_of(4 * lane + k for lane in lanes for k in range(3))
            three = builder.shuffle_vector(bytes_, ir.Constant(bytes_.type, ir.Undefined), order)
            pointer = _place_of_half(context, builder, sig, args, 3, half)
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
    lane = builder.zext(threads.lane_number(builder), _I64)
    first = builder.add(index, builder.mul(lane, _I64(3)))
    _store_bytes(builder, _pointer(context, builder, *array, first), packed)


def _store_bytes(builder: Any, pointer: ir.Value, packed: ir.Value) -> None:
    """Write the lower three bytes of a number of each thread."""
    for k in range(3):
        byte = builder.trunc(builder.lshr(packed, _I32(8 * k)), ir.IntType(8))
        builder.store(byte, builder.gep(pointer, [_I64(k)]))
    threads.agree(builder)


def _order_of(numbers: Iterable[int]) -> ir.Constant:
    """Return the mask of a `shufflevector` that takes the lanes of these numbers."""
    items = [_I32(number) for number in numbers]
    return ir.Constant(ir.VectorType(_I32, len(items)), items)


def _in_all(builder: ir.IRBuilder, item: ir.Value) -> ir.Value:
    """Return a number in all lanes."""
    kind = ir.VectorType(item.type, WIDTH)
    lanes = builder.insert_element(ir.Constant(kind, ir.Undefined), item, _I32(0))
    return builder.shuffle_vector(lanes, lanes, _order_of([0] * WIDTH))


def _all_alike(builder: ir.IRBuilder, index: ir.Value) -> ir.Value:
    """Return whether all lanes hold the same integer."""
    first = builder.shuffle_vector(index, index, _order_of([0] * WIDTH))
    same = builder.bitcast(builder.icmp_unsigned("==", index, first), ir.IntType(WIDTH))
    return builder.icmp_unsigned("==", same, ir.Constant(same.type, -1))


def _columns_of(builder: ir.IRBuilder, rows: list[ir.Value]) -> list[ir.Value]:
    """Return the columns of eight rows: pairs, then fours, then halves are exchanged."""

    def mixed(a: ir.Value, b: ir.Value, order: list[int]) -> ir.Value:
        return builder.shuffle_vector(a, b, _order_of(order))

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
