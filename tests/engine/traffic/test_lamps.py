"""Lamps with which vehicles signal, against how they move."""

from collections import Counter

import numpy as np
import pytest

from eyas.engine.render.kernels.surface.signalling import BRAKING, LEFT, RIGHT
from eyas.engine.sim.scenes import load_network
from eyas.engine.state.motion import SAMPLE, Lamp, SampledMotion, joined
from eyas.engine.state.terrain import Terrain
from eyas.engine.traffic.lamps import BLINKS, LaneMap, lamps_of, shining
from eyas.engine.traffic.recording_file import RecordingFile
from eyas.lanes import exact, interpreted
from eyas.maps.citystreet import CITYSTREET

from ...kit.motions import recorded_motion

RATE = 10.0


@pytest.fixture(scope="module")
def network():
    return load_network("citystreet", 0)


@pytest.fixture(scope="module")
def driven(network):
    """Two minutes of a shipped recording of citystreet, and its lamps."""
    file = next(one for one in CITYSTREET.shipped_traffic() if one.name == "traffic.npz")
    recording = RecordingFile.read(file).load()
    for name in ("position", "yaw", "present"):
        setattr(recording, name, getattr(recording, name)[:1201])
    kind = np.zeros(recording.actors, np.int32)
    motion = recorded_motion(recording, Terrain.flat(0.0), kind).sampled()
    return motion, lamps_of(motion.table, motion.rate, network)


def straight(speed: np.ndarray) -> np.ndarray:
    """The samples of one car that drives east at the speeds [m/s] of each sample."""
    table = np.zeros((len(speed), 1), SAMPLE)
    table["present"] = 1.0
    table["velocity_x"][:, 0] = speed
    table["x"][:, 0] = table["travelled"][:, 0] = np.cumsum(speed) / RATE
    return table


def test_brake_lamps_are_lit_while_a_car_slows_down_and_stands(network):
    phases = [(3.0, 0.0), (3.0, -4.0), (4.0, 0.0), (4.0, 3.0), (4.0, -0.5), (3.0, 0.0)]
    gained = np.concatenate([np.full(round(RATE * time), rate) for time, rate in phases])
    lit = lamps_of(straight(12.0 + np.cumsum(gained) / RATE), RATE, network)[:, 0] & Lamp.BRAKE > 0
    times = np.flatnonzero(np.diff(lit.astype(int))) / RATE
    # From the beginning of the braking until the foot leaves the pedal, and not when it coasts.
    assert times == pytest.approx([3.0, 9.7], abs=0.4)


def test_brake_lamps_agree_with_a_shipped_recording(driven):
    motion, lamps = driven
    speed = exact.hypot(motion.table["velocity_x"].astype(float), motion.table["velocity_y"])
    gained = (speed[4:] - speed[:-4]) * (RATE / 4.0)
    lit = (lamps[2:-2] & Lamp.BRAKE) > 0
    assert lit[gained < -2.5].mean() > 0.97
    assert lit[gained > 2.0].mean() < 0.03
    off = np.diff(np.flatnonzero(np.diff(lit[:, 0].astype(int))))
    assert off.min() >= 6  # they do not flicker


def test_drivers_signal_before_they_turn_where_roads_meet(driven):
    motion, lamps = driven
    graph, yaw = CITYSTREET.roads(0), motion.table["yaw"]
    ways = Counter(edge.end for edge in graph.edges)
    meet = np.array([(node.x, node.y) for node in graph.nodes if ways[node.name] >= 3])
    turned, signals = yaw[30:] - yaw[:-30], []
    for actor in range(yaw.shape[1]):
        sharp = np.flatnonzero(abs(turned[:, actor]) > 1.0)
        for first in sharp[np.diff(sharp, prepend=-100) > 50].tolist():
            middle = motion.table[first + 15, actor]
            away = np.abs(meet - (middle["x"], middle["y"])).max(axis=1).min()
            if first < 40 or away > 12.0:
                continue
            side = Lamp.LEFT if turned[first, actor] > 0.0 else Lamp.RIGHT
            # A second before the wheel is turned, and while it is.
            signals.append(
                [lamps[at, actor] & ~Lamp.BRAKE == side for at in (first - 10, first + 15)]
            )
    assert len(signals) > 50
    assert np.mean(signals, axis=0).min() > 0.95


def test_drivers_signal_before_they_change_lanes(network):
    lanes = LaneMap(network)
    edge = int(np.flatnonzero(lanes.index == 1)[0])
    ends = [slice(*network.lane_first[lane : lane + 2]) for lane in (edge - 1, edge)]
    right, left = (network.lane_points[span] for span in ends)
    part = np.linspace(0.2, 0.8, 121)[:, None]
    over = np.clip((part - 0.5) * 20.0 + 0.5, 0.0, 1.0)
    way = (right[0] + part * (right[-1] - right[0])) * (1.0 - over)
    way = way + (left[0] + part * (left[-1] - left[0])) * over
    table = straight(np.full(121, 8.0))
    table["x"][:, 0], table["y"][:, 0] = way.T
    signals = lamps_of(table, RATE, network)[:, 0]
    crossed = int(np.flatnonzero(np.diff(lanes.at(*way.T)))[0])
    assert not signals[: crossed - 40].any()
    assert (signals[crossed - 25 : crossed + 5] == Lamp.LEFT).all()
    assert not signals[crossed + 25 :].any()


def test_indicators_blink_and_no_two_in_step():
    lamps = np.full((101, 2), Lamp.LEFT | Lamp.BRAKE, np.uint8)
    lamps[:, 1] = Lamp.RIGHT
    whole = SampledMotion(np.zeros(lamps.shape, SAMPLE), np.zeros(2, np.int32), RATE, 0.0, lamps)
    motion = whole.packed()
    at = interpreted(shining)
    times = np.arange(0.0, 10.0, 0.01)
    first = np.array([at(motion, 0, time) for time in times])
    second = np.array([at(motion, 1, time) for time in times])
    assert (first & BRAKING == BRAKING).all()
    assert np.isin(first & ~BRAKING, (0, LEFT)).all()
    lit = first & LEFT > 0
    assert lit.mean() == pytest.approx(0.5, abs=0.01)
    assert np.count_nonzero(np.diff(lit.astype(int)) > 0) == pytest.approx(10 * BLINKS, abs=1)
    assert np.isin(second, (0, RIGHT)).all()
    assert 0.2 < (lit == (second > 0)).mean() < 0.8


def test_who_is_no_vehicle_signals_nothing():
    table = np.zeros((3, 1), SAMPLE)
    kind = np.zeros(1, np.int32)
    dark, lit = SampledMotion(table, kind, RATE).packed(), np.ones((3, 1), np.uint8)
    assert joined([dark, dark]).lamps.size == 0
    assert joined([dark, dark._replace(lamps=lit)]).lamps.tolist() == [[0, 1]] * 3
