import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import EpisodeKey, room_key
from eyas.engine.core.variation import Choice, Mirrored, Uniform, bounds, rule_of, sample, sampled
from eyas.lanes import interpreted
from eyas.lanes.pcg64 import STATE, begin_stream

numbers = st.floats(-1e6, 1e6)
pairs = st.tuples(numbers, numbers)
variations = st.one_of(
    numbers,
    pairs.map(lambda pair: Uniform(uniform=pair)),
    pairs.map(lambda pair: Mirrored(mirrored=pair)),
    st.lists(numbers, min_size=1).map(lambda values: Choice(choice=tuple(values))),
)


@given(variations, st.integers(0, 2**32))
def test_every_draw_is_within_the_bounds(variation, seed):
    low, high = bounds(variation)
    assert low <= sample(variation, np.random.default_rng(seed)) <= high


def test_a_number_is_drawn_as_it_is():
    assert sample(2.5, np.random.default_rng(0)) == 2.5


def test_mirrored_draws_both_signs_and_never_what_lies_between():
    rng = np.random.default_rng(0)
    drawn = np.array([sample(Mirrored(mirrored=(2.5, 4.5)), rng) for _ in range(200)])
    assert ((np.abs(drawn) >= 2.5) & (np.abs(drawn) <= 4.5)).all()
    assert 60 < (drawn > 0).sum() < 140


def test_uniform_reaches_both_halves():
    rng = np.random.default_rng(0)
    drawn = np.array([sample(Uniform(uniform=(22.0, 13.0)), rng) for _ in range(200)])
    assert 60 < (drawn > 17.5).sum() < 140


def test_choice_takes_each_value():
    rng = np.random.default_rng(0)
    drawn = {sample(Choice(choice=(1.0, 2.0, 5.0)), rng) for _ in range(100)}
    assert drawn == {1.0, 2.0, 5.0}


def test_nothing_to_choose_from_is_refused():
    with pytest.raises(ConfigError):
        Choice(choice=())


@pytest.mark.parametrize(
    "variation",
    [
        2.5,
        Uniform(uniform=(22.0, 13.0)),
        Mirrored(mirrored=(-4.5, 2.5)),
        Choice(choice=(1.0, 2.0, 5.0)),
    ],
)
def test_kernels_draw_the_same(variation):
    key = EpisodeKey(7, 3, 2)
    rng, state = key.stream("start"), [0] * STATE
    interpreted(begin_stream)(state, 7, room_key("start"), 3, 2)
    for _ in range(50):
        assert interpreted(sampled)(rule_of(variation), state) == sample(variation, rng)
