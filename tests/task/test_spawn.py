import math

import numpy as np
import pytest

from eyas.core.errors import SpawnError
from eyas.core.variation import Mirrored, Uniform
from eyas.task.config import StartConfig
from eyas.task.spawn import Start, choose_target, sample_start, start_pose

PLAIN = {
    "pitch": 1.37,
    "height": 22.0,
    "direction": 0.0,
    "horizontal_bias": 0.0,
    "vertical_bias": 0.0,
}


def start(**changes):
    return Start(**{**PLAIN, **changes})


def in_drone_frame(position, yaw, target):
    offset = np.asarray(target) - position
    c, s = math.cos(yaw), math.sin(yaw)
    return [c * offset[0] + s * offset[1], -s * offset[0] + c * offset[1], offset[2]]


@pytest.mark.parametrize("target_yaw", [0.0, 2.0, -3.0])
@pytest.mark.parametrize("direction", [0.0, 1.57, -3.0])
@pytest.mark.parametrize(("pitch", "share"), [(1.37, 0.2035), (1.0, 0.642), (0.6, 1.4617)])
def test_target_is_seen_ahead_right_and_below(target_yaw, direction, pitch, share):
    drawn = start(pitch=pitch, direction=direction, horizontal_bias=3.0, vertical_bias=2.0)
    target = (10.0, -5.0, 0.4)
    position, yaw = start_pose(drawn, target, target_yaw, -1.0)
    ahead = share * 22.0 + 1.0 - 2.0
    assert in_drone_frame(position, yaw, target) == pytest.approx([ahead, -3.0, -22.0], abs=3e-3)
    assert math.cos(yaw - target_yaw - direction) == pytest.approx(1.0)
    assert -math.pi <= yaw <= math.pi


def test_targets_that_are_no_vehicles_have_no_compensation():
    position, _ = start_pose(start(), (0.0, 0.0, 0.0), 0.0, ahead=0.0)
    assert position == pytest.approx([-math.tan(math.pi / 2 - 1.37) * 22.0, 0.0, 22.0])


def test_the_place_is_for_the_pitch_as_drawn_even_beyond_the_gimbal_s_limit():
    position, _ = start_pose(start(pitch=math.pi / 2), (0.0, 0.0, 0.0), 0.0, -1.0)
    assert position == pytest.approx([-1.0, 0.0, 22.0])


def test_draws_come_in_the_original_s_order():
    config = StartConfig(
        pitch=Uniform(uniform=(0.6, 1.38)),
        height=Uniform(uniform=(13.0, 22.0)),
        direction=Uniform(uniform=(-3.0, 3.0)),
        horizontal_bias=Uniform(uniform=(-4.0, 4.0)),
        vertical_bias=Mirrored(mirrored=(2.5, 4.5)),
    )
    drawn = sample_start(config, np.random.default_rng(5))
    rng = np.random.default_rng(5)
    assert drawn.pitch == rng.uniform(0.6, 1.38)
    assert drawn.horizontal_bias == rng.uniform(-4.0, 4.0)
    sign = 1.0 if rng.random() < 0.5 else -1.0
    assert drawn.vertical_bias == sign * rng.uniform(2.5, 4.5)
    assert drawn.height == rng.uniform(13.0, 22.0)
    assert drawn.direction == rng.uniform(-3.0, 3.0)


def test_each_free_target_is_as_likely():
    available = np.array([True, True, False, True, True])
    rng = np.random.default_rng(0)
    counts = np.bincount([choose_target(available, {1}, rng) for _ in range(3000)], minlength=5)
    assert counts[1] == counts[2] == 0
    assert counts[[0, 3, 4]] == pytest.approx(1000, abs=120)


def test_no_free_target_is_one_line_that_counts_them():
    with pytest.raises(SpawnError) as caught:
        choose_target(np.array([True, False, True]), {-1, 0, 2}, np.random.default_rng(0))
    assert str(caught.value).startswith("start: no target is free: 2 in the world, 2 foll")
    assert str(caught.value).endswith("as trackers, or same_target")
    assert "\n" not in str(caught.value)
