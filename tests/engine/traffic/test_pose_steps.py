import hashlib

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from eyas.engine.traffic.pose_steps import _table, packed, unpacked

SHAPE = st.tuples(st.integers(1, 3), st.integers(2, 9))


@given(st.data(), SHAPE)
def test_any_poses_come_back(data: st.DataObject, shape: tuple[int, int]):
    actors, samples = shape
    places = st.integers(-100_000_000, 100_000_000)
    position = data.draw(arrays(np.int64, (actors, 2, samples), elements=places))
    yaw = data.draw(arrays(np.int64, shape, elements=st.integers(-1_000_000, 1_000_000)))
    back = unpacked(packed(position, yaw))
    np.testing.assert_array_equal(back[0], position)
    np.testing.assert_array_equal(back[1], yaw)


def test_who_drives_straight_on_takes_hardly_any_numbers():
    east = np.rint(np.arange(500) * 123.4 * np.cos(0.7)).astype(np.int64)
    north = np.rint(np.arange(500) * 123.4 * np.sin(0.7)).astype(np.int64)
    parts = packed(np.stack([east, north])[None], np.full((1, 500), 700))
    assert abs(parts["aside"]).max() <= 2
    assert abs(parts["ahead"][0, 1:]).max() <= 2
    assert not parts["yaw_second"].any()


def test_every_machine_has_the_same_slopes():
    """Files of one machine could not be read on another if one of them were different."""
    digest = hashlib.sha256()
    for column in _table():
        digest.update(column.tobytes())
    assert digest.hexdigest()[:16] == "28527b7555cf7423"
