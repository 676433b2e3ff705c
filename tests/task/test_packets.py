import math

import numpy as np
import pytest

from eyas.sensors.config import CameraConfig
from eyas.task import columns
from eyas.task.direction import TargetDirection
from eyas.task.done import DoneReason
from eyas.task.packet_rows import (
    BASIC_COLUMNS,
    REWARD_COLUMNS,
    fill_basic,
    fill_reward,
    reward_rows,
)
from eyas.task.packets import BASIC_FIELDS, REWARD_FIELDS, BasicPacket, RewardPacket
from eyas.trackers.columns import GIMBAL_PITCH
from eyas.trackers.columns import MEMORY_COLUMNS as TRACKER_COLUMNS

YAW = 0.6


@pytest.fixture
def memory():
    row = np.zeros(columns.MEMORY_COLUMNS)
    row[columns.STEP_COUNT] = 12
    row[columns.REWARD] = 0.123456789
    row[columns.START_DIRECTION] = -0.3
    row[columns.VIEW_CENTRE : columns.VIEW_CENTRE + 2] = [31.0, 32.0]
    row[columns.RELATIVE_POSITION : columns.RELATIVE_ACCELERATION + 3] = np.arange(1, 10)
    row[columns.DIRECTION] = TargetDirection.LEFT
    return row


def basic(memory):
    row = np.full(BASIC_COLUMNS, np.nan)
    orientation = np.array([math.cos(YAW / 2), 0.0, 0.0, math.sin(YAW / 2)])
    fill_basic(
        np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]), np.zeros(3), orientation,
        np.array([0.0, 0.0, YAW]), np.array([0.1, 0.2, 0.3]), memory, row,
    )  # fmt: skip
    return row


def reward(memory, look, euler_yaw=YAW, target_yaw=-2.0):
    row = reward_rows(2, CameraConfig())[1]
    tracker_memory = np.zeros(TRACKER_COLUMNS)
    tracker_memory[GIMBAL_PITCH] = 1.37
    fill_reward(
        -0.1, tracker_memory, np.array([1.0, 2.0, 22.5]), np.array([0.0, 0.0, euler_yaw]),
        np.array([1.1, 2.1, 22.0]), look(YAW, 1.37), target_yaw, np.array([7.0, 8.0, 0.3]),
        memory, row,
    )  # fmt: skip
    return row


def test_basic_packet_has_the_original_s_22_numbers(memory):
    row = basic(memory)
    expected = [
        12, 1, 2, 3, 4, 5, 6, 0, 0, 9.81, 0.1, 0.2, 0.3, math.cos(0.3), 0, 0, math.sin(0.3),
        0, 0, 0.6, 0.123456789, 0,
    ]  # fmt: skip
    assert row == pytest.approx(expected, abs=1e-12)
    memory[columns.REASON] = DoneReason.NO_REWARD
    assert basic(memory)[21] == 1.0


def test_reward_packet_has_the_original_s_60_numbers(memory, look):
    row = reward(memory, look)
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


def test_relative_yaw_is_wrapped(memory, look):
    row = reward(memory, look, euler_yaw=3.0, target_yaw=-3.0)
    assert row[48] == pytest.approx(2 * math.pi - 6.0)


@pytest.mark.parametrize("breach", DoneReason)
def test_crash_is_told_though_the_episode_goes_on(memory, look, breach):
    memory[columns.BREACH] = breach
    crash = breach in (DoneReason.DISTANCE, DoneReason.YAW_RATE)
    assert reward(memory, look)[58] == crash


def test_every_column_has_its_own_name(memory, look):
    assert len(set(BASIC_FIELDS)) == len(BASIC_FIELDS) == BASIC_COLUMNS
    assert len(set(REWARD_FIELDS)) == len(REWARD_FIELDS) == REWARD_COLUMNS
    row = dict(zip(REWARD_FIELDS, reward(memory, look), strict=True))
    assert row["camera_pose_23"] == pytest.approx(22.1)
    assert row["relative_velocity_y"] == 5.0
    assert row["target_centre_z"] == pytest.approx(0.4)
    assert dict(zip(BASIC_FIELDS, basic(memory), strict=True))["yaw"] == YAW


def test_records_hold_what_the_rows_hold(memory, look):
    packet = BasicPacket.from_row(basic(memory))
    assert packet.step_count == 12
    assert packet.euler == (0.0, 0.0, YAW)
    assert packet.done is False
    other = RewardPacket.from_row(reward(memory, look), "BmwX5Simple")
    assert other.relative_velocity == (4.0, 5.0, 6.0)
    assert other.target_direction is TargetDirection.LEFT
    assert other.target_type == "BmwX5Simple"


def test_rows_pass_through_records_unchanged():
    numbers = np.random.default_rng(0).normal(size=REWARD_COLUMNS)
    numbers[[0, 1, 58, 59]] = [84, 63, 1, 3]
    assert list(RewardPacket.from_row(numbers, "Bus").to_row()) == list(numbers)
    numbers = numbers[:BASIC_COLUMNS]
    numbers[[0, 21]] = [1500, 1]
    assert list(BasicPacket.from_row(numbers).to_row()) == list(numbers)
