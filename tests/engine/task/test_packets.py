import math

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.direction import TargetDirection
from eyas.engine.task.done import DoneReason
from eyas.engine.task.packet_rows import PacketRows
from eyas.engine.task.packets import (
    BASIC_COLUMNS,
    BASIC_FIELDS,
    REWARD_COLUMNS,
    REWARD_FIELDS,
    BasicPacket,
    RewardPacket,
)

N = 1
YAW = 0.6


@pytest.fixture
def told(snapshot, look):
    """A tracker of which every number is told: its snapshot."""
    trackers, cameras, targets, episodes, _ = snapshot
    trackers.position[N], trackers.velocity[N] = (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)
    trackers.orientation[N] = math.cos(YAW / 2), 0.0, 0.0, math.sin(YAW / 2)
    trackers.euler[N, 2] = YAW
    trackers.smoothed[N, 1, 3:] = 0.1, 0.2, 0.3
    trackers.commanded_position[N] = 1.0, 2.0, 22.5
    trackers.commanded_gimbal[N, 0] = 1.37
    cameras.position[N], cameras.rotation[N] = (1.1, 2.1, 22.0), look(YAW, 1.37)
    cameras.field_of_view[N] = 0.7854
    targets.centre[N], targets.yaw[N] = (7.0, 8.0, 0.3), -2.0
    episodes.step_count[N] = 12
    episodes.reward[N] = 0.123456789
    episodes.start_offset[N, 3] = -0.3
    episodes.view_centre[N] = 31.0, 32.0, -0.1
    episodes.relative_position[N] = 1, 2, 3
    episodes.relative_velocity[N] = 4, 5, 6
    episodes.relative_acceleration[N] = 7, 8, 9
    episodes.direction[N] = TargetDirection.LEFT
    return snapshot


def packets(snapshot):
    """Return the basic and the reward packet of tracker 1."""
    basic, reward = PacketRows(snapshot, CameraConfig(), Terrain.flat(-0.1)).now()
    assert (basic.shape, reward.shape) == ((3, 22), (3, 60))
    return basic[N], reward[N]


def test_basic_packet_has_the_original_s_22_numbers(told):
    row, _ = packets(told)
    expected = [
        12, 1, 2, 3, 4, 5, 6, 0, 0, 9.81, 0.1, 0.2, 0.3, math.cos(0.3), 0, 0, math.sin(0.3),
        0, 0, 0.6, 0.123456789, 0,
    ]  # fmt: skip
    assert row == pytest.approx(expected, abs=1e-12)
    told.episodes.reason[N] = DoneReason.NO_REWARD
    assert packets(told)[0][21] == 1.0


def test_reward_packet_has_the_original_s_60_numbers(told, look):
    _, row = packets(told)
    assert row[:4] == pytest.approx([320, 240, 0.7854, 386.27], abs=5e-3)
    assert list(row[4:7]) == [1.37, 22.5, -0.3]
    camera_pose = np.eye(4)
    camera_pose[:3, :3], camera_pose[:3, 3] = look(YAW, 1.37), [1.1, 2.1, 22.1]
    assert row[7:23].reshape(4, 4) == pytest.approx(camera_pose)
    target_pose = np.eye(4)
    target_pose[:3, :3], target_pose[:3, 3] = look(-2.0, 0.0), [7.0, 8.0, 0.4]
    assert row[23:39].reshape(4, 4) == pytest.approx(target_pose)
    assert list(row[39:42]) == [31.0, 32.0, -0.1]
    assert row[42:45] == pytest.approx([7.0, 8.0, 0.4])
    assert row[45:48] == pytest.approx([1.1, 2.1, 22.1])
    assert row[48] == pytest.approx(-2.6)
    assert list(row[49:58]) == list(range(1, 10))
    assert list(row[58:]) == [0.0, TargetDirection.LEFT]


def test_relative_yaw_is_wrapped(told):
    told.trackers.euler[N, 2], told.targets.yaw[N] = 3.0, -3.0
    assert packets(told)[1][48] == pytest.approx(2 * math.pi - 6.0)


@pytest.mark.parametrize("crash", [False, True])
def test_crash_is_told_though_the_episode_goes_on(told, crash):
    told.episodes.crash[N] = crash
    assert packets(told)[1][58] == crash


def test_the_columns_of_a_part_are_where_its_numbers_are_named():
    for columns, names in ((BASIC_COLUMNS, BASIC_FIELDS), (REWARD_COLUMNS, REWARD_FIELDS)):
        for part, where in columns.items():
            if isinstance(where, int):
                assert names[where] == part
            else:
                own = names[where]
                assert (
                    own == ("roll", "pitch", "yaw")
                    if part == "euler"
                    else all(name.startswith(f"{part}_") for name in own)
                )
        assert sum(1 if isinstance(w, int) else w.stop - w.start for w in columns.values()) == len(
            names
        )


def test_every_column_has_its_own_name(told):
    assert len(set(BASIC_FIELDS)) == len(BASIC_FIELDS) == 22
    assert len(set(REWARD_FIELDS)) == len(REWARD_FIELDS) == 60
    basic, reward = packets(told)
    row = dict(zip(REWARD_FIELDS, reward, strict=True))
    assert row["camera_pose_23"] == pytest.approx(22.1)
    assert row["relative_velocity_y"] == 5.0
    assert row["target_centre_z"] == pytest.approx(0.4)
    assert dict(zip(BASIC_FIELDS, basic, strict=True))["yaw"] == YAW


def test_records_hold_what_the_rows_hold(told):
    basic, reward = packets(told)
    packet = BasicPacket.from_row(basic)
    assert packet.step_count == 12
    assert packet.euler == (0.0, 0.0, YAW)
    assert packet.done is False
    other = RewardPacket.from_row(reward, "BmwX5Simple")
    assert other.relative_velocity == (4.0, 5.0, 6.0)
    assert other.target_direction is TargetDirection.LEFT
    assert other.target_type == "BmwX5Simple"


def test_packets_tell_the_state_as_it_is_now_and_later_ones_leave_them_alone(told):
    rows = PacketRows(told, CameraConfig(), Terrain.flat(-0.1))
    before = rows.now()
    kept = [array.copy() for array in before]
    told.trackers.position[N] += 1.0
    told.targets.centre[N] += 1.0
    after = rows.now()
    assert after[0][N, 1:4] == pytest.approx([2.0, 3.0, 4.0])
    assert after[1][N, 42:45] == pytest.approx([8.0, 9.0, 1.4])
    for array, copy in zip(before, kept, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_rows_pass_through_records_unchanged():
    numbers = np.random.default_rng(0).normal(size=len(REWARD_FIELDS))
    numbers[[0, 1, 58, 59]] = [84, 63, 1, 3]
    assert list(RewardPacket.from_row(numbers, "Bus").to_row()) == list(numbers)
    numbers = numbers[: len(BASIC_FIELDS)]
    numbers[[0, 21]] = [1500, 1]
    assert list(BasicPacket.from_row(numbers).to_row()) == list(numbers)
