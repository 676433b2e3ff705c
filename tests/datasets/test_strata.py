"""Kinds of frames and episodes, at their limits."""

import numpy as np
import pytest

from eyas.datasets.formats.uavdt import HIGH, LONG_TERM, LOW, STEEP
from eyas.datasets.statistics import episode_kinds
from eyas.datasets.tracking.clip import near_look_alikes
from eyas.datasets.tracking.one_pass import track_clip


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
    class Still:
        boxes, visible = np.tile([1.0, 1.0, 3.0, 3.0], (14, 1)), np.ones(14, np.bool_)

        def __len__(self):
            return 14

        def pictures(self):
            return iter(np.zeros((14, 8, 8, 3), np.uint8))

    track = track_clip(Lost, Still(), restarts=True)
    assert np.flatnonzero(track.told).tolist() == [0, 6, 12]
    assert track.failures == 3
