"""Kinds of frames and episodes, at their limits."""

from types import SimpleNamespace

import numpy as np
import pytest

from eyas.datasets.formats.uavdt import HIGH, LONG_TERM, LOW, STEEP
from eyas.datasets.statistics import episode_kinds
from eyas.datasets.tracking.one_pass import track_episode
from eyas.datasets.tracking.run import near_look_alikes


@pytest.mark.parametrize(
    ("moved", "changes", "count"),
    [(199.0, {}, 1), (201.0, {}, 0), (10.0, {"class_id": 12}, 0), (10.0, {"parked": True}, 0)],
)
def test_look_alikes_count_within_four_diagonals_of_the_target(moved, changes, count):
    other = {"class_id": 9, "box": [moved, 0.0, moved + 30.0, 40.0], **changes}
    label = {"target_box": [0.0, 0.0, 30.0, 40.0], "target_class_id": 9, "others": [other]}
    assert near_look_alikes(label) == count


@pytest.mark.parametrize(
    ("hidden", "told"), [(0, "none"), (1, "some"), (24, "some"), (25, "much"), (100, "much")]
)
def test_an_episode_of_which_a_quarter_is_hidden_is_much_occluded(hidden, told):
    frame = {"size": 40.0, "speed": 5.0, "alike": 0.0}
    shares = [0.4] * hidden + [0.5] * (100 - hidden)
    kinds = episode_kinds([{**frame, "visible": share} for share in shares])
    assert f"occlusion: {told}" in kinds


def test_limits_of_uavdt_are_those_of_its_owners():
    assert (LOW, HIGH, LONG_TERM) == (30.0, 70.0, 1500)
    assert np.degrees(STEEP) == pytest.approx(60.0)


class Lost:
    """A box tracker that never overlaps its target."""

    def begin(self, picture, box):
        pass

    def update(self, picture):
        return 500.0, 500.0, 5.0, 5.0


def test_a_tracker_is_restarted_five_frames_after_a_failure():
    frame = SimpleNamespace(picture=lambda: np.zeros((8, 8, 3), np.uint8))
    arrays = {"target_box": np.tile([1, 1, 4, 4], (14, 1)), "visible_fraction": np.ones(14)}

    class Episode(dict):
        def __getitem__(self, number):
            return frame

        def array(self, name):
            return arrays[name]

    track = track_episode(Lost, Episode(), restarts=True)
    assert np.flatnonzero(track.told).tolist() == [0, 6, 12]
    assert track.failures == 3
