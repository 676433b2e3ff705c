import math

import numpy as np
import pytest

from eyas.task.columns import (
    DIRECTION,
    MEMORY_COLUMNS,
    RELATIVE_ACCELERATION,
    RELATIVE_POSITION,
    RELATIVE_VELOCITY,
    REWARD,
    START_DIRECTION,
    VIEW_CENTRE,
)
from eyas.task.direction import TargetDirection
from eyas.task.observe import observe, start_episode


def triple(memory, column):
    return memory[column : column + 3]


@pytest.fixture
def see(rules_with, look):
    """Observe a target from a drone at a place and a heading, with a camera 1 m above it."""
    rules = rules_with()
    memory = np.full(MEMORY_COLUMNS, 7.0)
    start_episode(0.25, memory)

    def observed(target, target_yaw=0.0, position=(0.0, 0.0, 20.0), yaw=0.0):
        position = np.array(position)
        orientation = np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)])
        target = np.array(target, np.float64)
        camera = position + np.array([0.0, 0.0, 1.0])
        rotation = look(yaw, 1.0)
        observe(rules, camera, rotation, position, orientation, target, target_yaw, target, memory)
        return memory

    return observed


def test_a_new_episode_remembers_only_its_start_direction(see):
    memory = np.full(MEMORY_COLUMNS, 7.0)
    start_episode(0.25, memory)
    assert memory[START_DIRECTION] == 0.25
    assert np.count_nonzero(memory) == 1


def test_reward_and_middle_of_the_view(see):
    reach = 21.1 / math.tan(1.0)
    memory = see((reach, 0.0, 0.3))
    assert memory[REWARD] == pytest.approx(math.tanh(4.0))
    assert memory[VIEW_CENTRE : VIEW_CENTRE + 2] == pytest.approx([reach, 0.0])
    assert see((-reach, 0.0, 0.3))[REWARD] == 0.0


def test_relative_position_is_in_the_body_frame(see):
    memory = see((1.0, 5.0, 0.5), position=(1.0, 2.0, 20.0), yaw=math.pi / 2)
    assert triple(memory, RELATIVE_POSITION) == pytest.approx([3.0, 0.0, -19.5])


def test_first_sample_has_no_velocity_and_second_no_acceleration(see):
    memory = see((5.0, 0.0, 0.0))
    assert not triple(memory, RELATIVE_VELOCITY).any()
    memory = see((5.02, 0.0, 0.0))
    assert triple(memory, RELATIVE_VELOCITY) == pytest.approx([10.0, 0.0, 0.0])
    assert not triple(memory, RELATIVE_ACCELERATION).any()
    memory = see((5.05, 0.0, 0.0))
    assert triple(memory, RELATIVE_VELOCITY) == pytest.approx([15.0, 0.0, 0.0])
    assert triple(memory, RELATIVE_ACCELERATION) == pytest.approx([2500.0, 0.0, 0.0], abs=1e-6)


def test_relative_velocity_feels_the_turning_frame(see):
    see((5.0, 0.0, 0.0))
    memory = see((5.0, 0.0, 0.0), yaw=0.002)
    assert triple(memory, RELATIVE_VELOCITY) == pytest.approx([0.0, -5.0, 0.0], abs=6e-3)


def test_direction_is_known_from_the_second_sample(see):
    assert see((5.0, 0.0, 0.0), 3.0)[DIRECTION] == TargetDirection.STOP
    assert see((5.02, 0.0, 0.0), 3.0)[DIRECTION] == TargetDirection.STRAIGHT
    assert see((5.04, 0.0, 0.0), 3.001)[DIRECTION] == TargetDirection.LEFT
    assert see((5.06, 0.0, 0.0), 3.0)[DIRECTION] == TargetDirection.RIGHT
    assert see((5.06, 0.0, 0.0), 3.0)[DIRECTION] == TargetDirection.STOP
