"""numpy's random streams in kernels: the same numbers as `eyas.engine.core.rng.stream`, bit by bit.

A reset draws from several streams, and making one in Python takes longer than all that is drawn
from it. The algorithms are those of numpy's documentation and papers: `SeedSequence` (O'Neill's
`seed_seq_fe`), PCG64 (O'Neill 2014, variant XSL RR 128/64), bounded whole numbers (Lemire 2019).

A state is an array of `STATE` numbers: state and increment in four words of 32 bits each, lowest
first, then whether half of the last 64 bits is still unused, and that half. Words of 32 bits, since
kernels know signed numbers of 64 bits only.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel

Words = NDArray[np.int64]

STATE: Final = 10  # Length of a state

_WORD = 0xFFFFFFFF
_INC, _HAS_HALF, _HALF = 4, 8, 9

_MULTIPLIER = (0x9FCCF645, 0x4385DF64, 0x1FC65DA4, 0x2360ED05)


@kernel
def begin_stream(
    state: Words,  # The state, shape (`STATE`,)
    seed: int,  # Seed of the run, from 0 to 2^63 - 1
    room: int,  # Hash of the room's name, see `eyas.engine.core.rng.room_key`
    tracker: int,  # Number of the tracker, from 0 to 2^32 - 1
    episode: int,  # Number of the episode, the same
) -> None:
    """Begin the stream of a room in an episode, see `eyas.engine.core.rng.EpisodeKey`."""
    a, b, c, d = _pool(seed, room, tracker, episode)
    const = 0x8B51F9DD
    for word in range(8):
        value = a
        a, b, c, d = b, c, d, a
        value ^= const
        const = (const * 0x58F38DED) & _WORD
        value = (value * const) & _WORD
        value ^= value >> 16
        # The seed's two numbers of 64 bits come with the higher one first, and so do the stream's.
        state[(word & 4) + (word + 2) % 4] = value
    s0, s1, s2, s3 = state[0], state[1], state[2], state[3]
    i0, i1, i2, i3 = state[4], state[5], state[6], state[7]
    state[4] = ((i0 << 1) | 1) & _WORD
    state[5] = ((i1 << 1) | (i0 >> 31)) & _WORD
    state[6] = ((i2 << 1) | (i1 >> 31)) & _WORD
    state[7] = ((i3 << 1) | (i2 >> 31)) & _WORD
    for word in range(4):  # the first step of a state of zeros
        state[word] = state[_INC + word]
    carry = state[0] + s0
    state[0] = carry & _WORD
    carry = (carry >> 32) + state[1] + s1
    state[1] = carry & _WORD
    carry = (carry >> 32) + state[2] + s2
    state[2] = carry & _WORD
    state[3] = ((carry >> 32) + state[3] + s3) & _WORD
    _step(state)
    state[_HAS_HALF] = 0


@kernel
def fraction(state: Words) -> float:
    """Return the next number from 0 to below 1, as `Generator.random`."""
    high, low = _next(state)
    return ((high << 21) | (low >> 11)) * (1.0 / 9007199254740992.0)


@kernel
def whole(
    state: Words,
    count: int,  # From 1 to 2^32 - 1
) -> int:
    """Return the next whole number from 0 to below `count`, as `Generator.integers`."""
    if count == 1:
        return 0
    product = word(state) * count
    left = product & _WORD
    if left < count:
        least = (0x100000000 - count) % count
        while left < least:
            product = word(state) * count
            left = product & _WORD
    return (product >> 32) & _WORD


@kernel
def word(state: Words) -> int:
    """Return the next 32 bits, as `Generator.integers` of 2^32."""
    if state[_HAS_HALF] == 1:
        state[_HAS_HALF] = 0
        return int(state[_HALF])
    high, low = _next(state)
    state[_HAS_HALF] = 1
    state[_HALF] = high
    return low


@kernel
def _next(state: Words) -> tuple[int, int]:
    """Return the next 64 bits, the higher and the lower half."""
    _step(state)
    high, low = state[3] ^ state[1], state[2] ^ state[0]
    turn = state[3] >> 26
    if turn >= 32:
        high, low = low, high
        turn -= 32
    back = 32 - turn
    return ((high >> turn) | (low << back)) & _WORD, ((low >> turn) | (high << back)) & _WORD


@kernel
def _step(state: Words) -> None:
    """Multiply the state by the multiplier and add the increment, modulo 2^128."""
    s0, s1, s2, s3 = state[0], state[1], state[2], state[3]
    m0, m1, m2, m3 = _MULTIPLIER
    # Columns of the product: of each product of two words, the higher half counts in the next one.
    p00, p01, p10 = s0 * m0, s0 * m1, s1 * m0
    p02, p11, p20 = s0 * m2, s1 * m1, s2 * m0
    column = (p00 & _WORD) + state[4]
    state[0] = column & _WORD
    column = (column >> 32) + _upper(p00) + (p01 & _WORD) + (p10 & _WORD) + state[5]
    state[1] = column & _WORD
    column = (column >> 32) + _upper(p01) + _upper(p10) + state[6]
    column += (p02 & _WORD) + (p11 & _WORD) + (p20 & _WORD)
    state[2] = column & _WORD
    column = (column >> 32) + _upper(p02) + _upper(p11) + _upper(p20) + state[7]
    column += (s0 * m3 & _WORD) + (s1 * m2 & _WORD) + (s2 * m1 & _WORD) + (s3 * m0 & _WORD)
    state[3] = column & _WORD


@kernel
def _upper(product: int) -> int:
    """Return the upper 32 bits of a product of two words."""
    return (product >> 32) & _WORD


@kernel
def _pool(seed: int, room: int, tracker: int, episode: int) -> tuple[int, int, int, int]:
    """Return the four words of a `SeedSequence`."""
    const = 0x43B0D7E5
    a, const = _hashed(seed & _WORD, const)
    b, const = _hashed((seed >> 32) & _WORD, const)
    c, const = _hashed(0, const)
    d, const = _hashed(0, const)
    for source in range(4):
        if source != 0:
            a, const = _mixed(a, b if source == 1 else (c if source == 2 else d), const)
        if source != 1:
            b, const = _mixed(b, a if source == 0 else (c if source == 2 else d), const)
        if source != 2:
            c, const = _mixed(c, a if source == 0 else (b if source == 1 else d), const)
        if source != 3:
            d, const = _mixed(d, a if source == 0 else (b if source == 1 else c), const)
    for number in range(3):
        word = room if number == 0 else (tracker if number == 1 else episode)
        a, const = _mixed(a, word, const)
        b, const = _mixed(b, word, const)
        c, const = _mixed(c, word, const)
        d, const = _mixed(d, word, const)
    return a, b, c, d


@kernel
def _hashed(value: int, const: int) -> tuple[int, int]:
    """Return a word hashed with a constant, and the next constant."""
    value ^= const
    const = (const * 0x931E8875) & _WORD
    value = (value * const) & _WORD
    return value ^ (value >> 16), const


@kernel
def _mixed(word: int, other: int, const: int) -> tuple[int, int]:
    """Return a word of the pool mixed with another word, and the next constant."""
    other, const = _hashed(other, const)
    word = (0xCA01F9DD * word - 0x4973F715 * other) & _WORD
    return word ^ (word >> 16), const
