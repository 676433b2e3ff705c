"""Random streams of kernels are numpy's own."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eyas.engine.core.rng import room_key, stream
from eyas.lanes import interpreted, kernel
from eyas.lanes.pcg64 import STATE, begin_stream, fraction, whole

SEEDS = st.integers(0, 2**63 - 1)
NUMBERS = st.integers(0, 2**32 - 1)
COUNTS = st.one_of(st.integers(1, 50), st.integers(1, 2**32 - 1), st.just(2**31 + 1))


@given(SEEDS, NUMBERS, NUMBERS, st.lists(st.one_of(st.none(), COUNTS), max_size=20))
def test_streams_are_those_of_numpy(seed, tracker, episode, draws):
    rng, state = stream(seed, "light", tracker, episode), [0] * STATE
    interpreted(begin_stream)(state, seed, room_key("light"), tracker, episode)
    for count in draws:
        if count is None:
            assert interpreted(fraction)(state) == rng.random()
        else:
            assert interpreted(whole)(state, count) == rng.integers(count)


@kernel
def some(state, seed, tracker, fractions, wholes, count):
    begin_stream(state, seed, 3, tracker, 5)
    for k in range(len(fractions)):
        fractions[k] = fraction(state)
        wholes[k] = whole(state, count)


@pytest.mark.parametrize("seed", [0, 7, 2**32, 2**63 - 1])
@pytest.mark.parametrize("count", [1, 7, 3_000_000_001])  # the last is drawn again every third time
def test_compiled_they_are_the_same(seed, count):
    state, fractions, wholes = np.zeros(STATE, np.int64), np.zeros(500), np.zeros(500, np.int64)
    some(state, seed, 4, fractions, wholes, count)
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(3, 4, 5))))
    assert [(rng.random(), rng.integers(count)) for _ in range(500)] == list(
        zip(fractions.tolist(), wholes.tolist(), strict=True)
    )
