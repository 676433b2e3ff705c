import numpy as np
import pytest

from eyas.engine.state.motion import OFTEN, SAMPLE, SELDOM, TRACK, Motion, SampledMotion, joined


def motion(actors: int, samples: int = 5, rate: float = 10.0, first_time: float = 0.0) -> Motion:
    table = np.zeros((samples, actors), SAMPLE)
    table["x"] = 100.0 * actors + np.arange(actors)
    return SampledMotion(table, np.full(actors, actors, np.int32), rate, first_time).packed()


def test_joined_motion_has_the_actors_of_all_in_order():
    both = joined([motion(2), motion(3), motion(1)])
    assert both.table["x"][4].tolist() == [200.0, 201.0, 300.0, 301.0, 302.0, 100.0]
    assert both.kind.tolist() == [2, 2, 3, 3, 3, 1]
    assert (both.rate, both.first_time, both.table.dtype) == (10.0, 0.0, TRACK)


@pytest.mark.parametrize("other", [{"samples": 6}, {"rate": 5.0}, {"first_time": 1.0}])
def test_motions_of_other_times_are_refused(other):
    with pytest.raises(ValueError, match="allowed: the same in all"):
        joined([motion(2), motion(2, **other)])


def test_a_sample_is_aligned_for_kernels():
    assert TRACK.isalignedstruct
    assert TRACK.itemsize == 32


def test_what_is_packed_is_the_same_samples():
    table = np.zeros((45, 3), SAMPLE)
    rng = np.random.default_rng(1)
    for name in OFTEN:
        table[name] = rng.normal(size=table.shape)
    for name in SELDOM:
        table[name] = rng.integers(2, size=table.shape)
    table["z"][:, 1] = table["z"][0, 1]
    table[12:34, 0] = table[11, 0]  # it stands, from and to the middle of a block
    first, second = (
        SampledMotion(half, np.zeros(half.shape[1], np.int32), 10.0).packed()
        for half in (table[:, :2], table[:, 2:])
    )
    np.testing.assert_array_equal(joined([first, second]).sampled().table, table)


def test_what_does_not_change_lies_there_once():
    still = motion(2, samples=50)
    assert len(still.footing) == 2
    assert len(still.track) == 14  # in each of seven blocks, once for each actor
