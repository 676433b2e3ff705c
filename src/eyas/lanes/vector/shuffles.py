"""Exchange of numbers between lanes."""

from collections.abc import Iterable

from llvmlite import ir

__all__ = ["columns_of", "order_of"]

_I32 = ir.IntType(32)


def order_of(numbers: Iterable[int]) -> ir.Constant:
    """Return the mask of a `shufflevector` that takes the lanes of these numbers."""
    items = [_I32(number) for number in numbers]
    return ir.Constant(ir.VectorType(_I32, len(items)), items)


def columns_of(builder: ir.IRBuilder, rows: list[ir.Value]) -> list[ir.Value]:
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
