import numpy as np
import pytest

from eyas.engine.state.motion import SAMPLE, Motion, joined


def motion(actors: int, samples: int = 5, rate: float = 10.0, first_time: float = 0.0) -> Motion:
    table = np.zeros((samples, actors), SAMPLE)
    table["x"] = 100.0 * actors + np.arange(actors)
    return Motion(table, np.full(actors, actors, np.int32), rate, first_time)


def test_joined_motion_has_the_actors_of_all_in_order():
    both = joined([motion(2), motion(3), motion(1)])
    assert both.table["x"][4].tolist() == [200.0, 201.0, 300.0, 301.0, 302.0, 100.0]
    assert both.kind.tolist() == [2, 2, 3, 3, 3, 1]
    assert (both.rate, both.first_time, both.table.dtype) == (10.0, 0.0, SAMPLE)


@pytest.mark.parametrize("other", [{"samples": 6}, {"rate": 5.0}, {"first_time": 1.0}])
def test_motions_of_other_times_are_refused(other):
    with pytest.raises(ValueError, match="allowed: the same in all"):
        joined([motion(2), motion(2, **other)])


def test_a_sample_is_aligned_for_kernels():
    assert SAMPLE.isalignedstruct
    assert SAMPLE.itemsize == 48
