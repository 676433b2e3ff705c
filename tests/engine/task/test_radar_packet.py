import math

import numpy as np

from eyas.engine.task.packets import INPUT_FIELDS, REWARD_FIELDS, InputPacket, RewardPacket
from eyas.engine.task.radar_packet import RADAR_FIELDS, RadarPacket


def test_radar_rows_pass_through_records_unchanged():
    assert len(RADAR_FIELDS) == len(set(RADAR_FIELDS)) == 2000
    numbers = np.random.default_rng(0).normal(size=2000)
    numbers[3::5] = 0
    numbers[10:12] = math.inf
    packet = RadarPacket.from_row(numbers)
    assert len(packet.points) == 400
    assert list(packet.to_row()) == list(numbers)
    point = packet.points[7]
    named = dict(zip(RADAR_FIELDS, numbers, strict=True))
    assert (point.x, point.y, point.time) == (named["x_7"], named["y_7"], named["time_7"])
    assert point.distance == math.hypot(point.x, point.y)
    assert packet.points[2].distance == math.inf


def test_input_rows_pass_through_records_unchanged():
    row = np.array([40.0, -3.0, 0.01, 2.0, 1.0])
    packet = InputPacket.from_row(row)
    assert packet == InputPacket(40.0, -3.0, 0.01, 2.0, reset=True)
    assert list(packet.to_row()) == list(row)
    assert InputPacket().to_row().tolist() == [0.0] * len(INPUT_FIELDS)


def test_the_manual_s_reward_packet_lacks_one_number():
    numbers = np.arange(60.0)
    numbers[[58, 59]] = 1.0, 3.0
    row = RewardPacket.from_row(numbers, "Bus").to_manual_row()
    assert len(row) == 59
    place = REWARD_FIELDS.index("start_direction")
    assert list(row) == [*numbers[:place], *numbers[place + 1 :]]
