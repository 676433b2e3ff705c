"""Deflate (RFC 1951) of what a picture's filter leaves: runs of one byte, and a Huffman code.

It finds no other repetitions, and needs none: filtered by Paeth's predictor, pictures are smaller
by this than by zlib's level 1, and maps of ids and depth smaller than by its level 6, in a sixth of
the time. And bytes do not depend on the machine, as those of zlib-ng do, which Pillow brings.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import PackedBundle, compiled, kernel

_SYMBOLS = 286  # Bytes, the end (256), and lengths of runs from 257 on
_END = 256  # Symbol of the end of a block (RFC 1951, 3.2.5)
_MOST_BITS = 15  # Length of the longest code that deflate allows
_LONGEST, _SHORTEST = 258, 3  # Lengths of runs
_WORD = 32  # Bits that are written at once


class _Tables(NamedTuple):
    """Symbol of each length of a run, and how many bits of the length follow it; shape (259,)."""

    symbol: NDArray[np.int64]
    bits: NDArray[np.int64]
    rest: NDArray[np.int64]  # Values of these bits


class _Work(NamedTuple):
    """Input, working memory and output."""

    data: NDArray[np.uint8]  # Shape (N,)
    words: NDArray[np.int64]  # The bytes, eight at once, shape (N / 8,)
    counts: NDArray[np.int64]  # Number of occurrences of each symbol, shape (286,)
    length: NDArray[np.int64]  # Bits of its code, shape (286,)
    code: NDArray[np.int64]  # The code, its first bit lowest, shape (286,)
    order: NDArray[np.int64]  # The symbols that occur, the rarest first, shape (286,)
    weight: NDArray[np.int64]
    """Weights of the items of this and the last level, see `_set_lengths`, shape (2, 572)."""
    leaf: NDArray[np.bool_]  # Whether each item of each level is a symbol, shape (15, 572)
    out: NDArray[np.uint32]  # The stream in words of four bytes, the lowest byte first
    used: NDArray[np.int64]  # Bytes of `out` that are written, shape (1,)


def deflated(data: NDArray[np.uint8]) -> bytes:
    """Return bytes as a deflate stream of one block."""
    work = _Work(
        data=data,
        words=data[: data.size & -8].view(np.int64),
        counts=np.zeros(_SYMBOLS, np.int64),
        length=np.zeros(_SYMBOLS, np.int64),
        code=np.zeros(_SYMBOLS, np.int64),
        order=np.zeros(_SYMBOLS, np.int64),
        weight=np.zeros((2, 2 * _SYMBOLS), np.int64),
        leaf=np.zeros((_MOST_BITS, 2 * _SYMBOLS), np.bool_),
        # No code of all symbols needs more than 9 bits for each; the best needs less.
        out=np.empty((data.size + data.size // 8 + 512) // 4, "<u4"),
        used=np.zeros(1, np.int64),
    )
    _deflate(_TABLES, work)
    return work.out.view(np.uint8)[: work.used[0]].tobytes()


def _tables() -> _Tables:
    lengths = np.arange(_LONGEST + 1)
    bits = [max(int(length - _SHORTEST).bit_length() - 3, 0) for length in lengths]
    tables = _Tables(*np.zeros((3, _LONGEST + 1), np.int64))
    for length in range(_SHORTEST, _LONGEST):
        more, beyond = bits[length], length - _SHORTEST
        tables.symbol[length] = 257 + 4 * more + (beyond >> more)
        tables.bits[length], tables.rest[length] = more, beyond & ((1 << more) - 1)
    tables.symbol[_LONGEST] = 285
    return tables


_TABLES = PackedBundle(_tables())


@compiled
def _deflate(tables: _Tables, work: _Work) -> None:
    """Write `_Work.out`."""
    data, counts = work.data, work.counts
    at = 0
    while at < len(data):
        run = _run(data, work.words, at)
        if run >= _SHORTEST:
            counts[tables.symbol[run]] += 1
            at += run
        else:
            counts[data[at]] += 1
            at += 1
    counts[_END] = 1
    _set_lengths(work)
    _set_codes(work)
    _write(tables, work)


@kernel(inline=True)
def _run(data: NDArray[np.uint8], words: NDArray[np.int64], at: int) -> int:
    """Return how many bytes from `at` on are the same as the one before, at most `_LONGEST`."""
    if at == 0 or data[at] != data[at - 1]:
        return 0
    before, end, k = data[at], min(at + _LONGEST, len(data)), at + 1
    eight = before * 0x0101010101010101
    while k < end and data[k] == before:
        k += 8 if (k & 7) == 0 and k + 8 <= end and words[k >> 3] == eight else 1
    return k - at


@kernel
def _set_lengths(work: _Work) -> None:
    """Set the lengths of the best code that is not longer than `_MOST_BITS`: by package and merge.

    Items of a level are the symbols, and pairs of neighbouring items of the level before, in the
    order of their weights. Each time that a symbol is among the 2 n - 2 lightest items of the last
    level, directly or in pairs, its code gets a bit longer.
    """
    counts, order, length, leaf = work.counts, work.order, work.length, work.leaf
    symbols = 0
    for symbol in range(_SYMBOLS):
        length[symbol] = 0
        if counts[symbol] > 0:
            k = symbols
            while k > 0 and counts[order[k - 1]] > counts[symbol]:
                order[k] = order[k - 1]
                k -= 1
            order[k] = symbol
            symbols += 1
    items = 0
    for level in range(_MOST_BITS):
        items = _merge(work, level, symbols, items)
    chosen = 2 * symbols - 2
    for level in range(_MOST_BITS - 1, -1, -1):
        leaves = 0
        for k in range(chosen):
            if leaf[level, k]:
                length[order[leaves]] += 1
                leaves += 1
        chosen = 2 * (chosen - leaves)


@kernel
def _merge(work: _Work, level: int, symbols: int, before: int) -> int:
    """Set the items of a level from those of the level before, and return their number."""
    weight, last = work.weight[level & 1], work.weight[1 - (level & 1)]
    items, k, pair = 0, 0, 0
    while k < symbols or 2 * pair + 1 < before:
        pairs = 2 * pair + 1 < before
        both = last[2 * pair] + last[2 * pair + 1] if pairs else 0
        is_leaf = k < symbols and (not pairs or work.counts[work.order[k]] <= both)
        weight[items] = work.counts[work.order[k]] if is_leaf else both
        work.leaf[level, items] = is_leaf
        items += 1
        if is_leaf:
            k += 1
        else:
            pair += 1
    return items


@kernel
def _set_codes(work: _Work) -> None:
    """Set the codes for their lengths: in order of length, then of symbols."""
    following = 0
    for bits in range(1, _MOST_BITS + 1):
        following <<= 1
        for symbol in range(_SYMBOLS):
            if work.length[symbol] == bits:
                reverse = 0
                for bit in range(bits):
                    reverse |= ((following >> bit) & 1) << (bits - 1 - bit)
                work.code[symbol] = reverse
                following += 1


class _Bits(NamedTuple):
    """Bits that are not written yet."""

    bits: int
    have: int
    at: int  # Index of the next word


@kernel(inline=True)
def _put(out: NDArray[np.uint32], left: _Bits, value: int, count: int) -> _Bits:
    """Write some bits, the lowest first, at most 31."""
    bits, have, at = left.bits | (value << left.have), left.have + count, left.at
    if have >= _WORD:
        out[at] = bits & 0xFFFFFFFF
        bits >>= _WORD
        have -= _WORD
        at += 1
    return _Bits(bits, have, at)


@kernel
def _write(tables: _Tables, work: _Work) -> None:
    """Write one block with its code, and the data in it."""
    data, out, length, code = work.data, work.out, work.length, work.code
    # The last block, with a code of its own, for 286 symbols and the distances 1 to 4.
    kind = 1 | (2 << 1) | ((_SYMBOLS - 257) << 3) | (3 << 8) | (15 << 13)
    left = _put(out, _Bits(0, 0, 0), kind, 17)
    # Lengths of codes are themselves four bits each: those from 0 to 15, in deflate's order.
    left = _put(out, left, 0, 9)
    for _ in range(16):
        left = _put(out, left, 4, 3)
    for symbol in range(_SYMBOLS + 4):
        # One bit says which distance, 1 or 4: the first and the last of these.
        bits = length[symbol] if symbol < _SYMBOLS else int((symbol - _SYMBOLS) % 3 == 0)
        reverse = (bits >> 3) | ((bits >> 1) & 2) | ((bits << 1) & 4) | ((bits & 1) << 3)
        left = _put(out, left, reverse, 4)
    at = 0
    while at < len(data):
        run = _run(data, work.words, at)
        if run >= _SHORTEST:
            symbol, bits = tables.symbol[run], length[tables.symbol[run]]
            value = code[symbol] | (tables.rest[run] << bits)
            bits += tables.bits[run]
            # Readers copy from four bytes ago three times as fast as from the one before.
            far = at >= 4 and data[at - 1] == data[at - 2] == data[at - 3] == data[at - 4]
            left = _put(out, left, value | (int(far) << bits), bits + 1)
            at += run
        else:
            left = _put(out, left, code[data[at]], length[data[at]])
            at += 1
    left = _put(out, left, code[_END], length[_END])
    out[left.at] = left.bits
    work.used[0] = 4 * left.at + (left.have + 7) // 8
