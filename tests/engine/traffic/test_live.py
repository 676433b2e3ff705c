"""Traffic that SUMO drives while it is watched, against a recording of it."""

import gc
from collections.abc import Iterator

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.motion import SAMPLE, ActorState, Lamp, SampledMotion
from eyas.engine.state.roads import RoadGraph
from eyas.engine.state.terrain import Terrain
from eyas.engine.traffic.config import Demand, Mix, Source, TrafficConfig, VehicleType
from eyas.engine.traffic.live import LiveSumo
from eyas.engine.traffic.record import record, resolved
from eyas.engine.traffic.sumo import SumoRun

from ...kit.motions import recorded_motion

pytestmark = [pytest.mark.sumo, pytest.mark.usefixtures("sumo")]

DURATION = 60.0
FLAT = Terrain.flat(0.0)
KEPT = TrafficConfig(vehicle_type=Mix(passenger=8, trailer=1, motorcycle=1), max_vehicles=12)
GROUPS = TrafficConfig(
    demand=Demand.RESPAWN,
    vehicle_type=Mix(passenger=3, bus=1),
    max_vehicles=8,
    group_size=3,
    group_interval=15.0,
    route_length=(200.0, 900.0),
)


def kind(name: str) -> int:
    return list(VehicleType).index(VehicleType(name))


def started(grid: RoadGraph, config: TrafficConfig) -> LiveSumo:
    return LiveSumo(grid, resolved(config, 1), FLAT, kind, DURATION)


@pytest.fixture
def live(grid: RoadGraph) -> Iterator[LiveSumo]:
    source = started(grid, KEPT)
    yield source
    source.close()


@pytest.mark.slow
@pytest.mark.parametrize("config", [KEPT, GROUPS], ids=lambda config: config.demand.value)
@pytest.mark.parametrize("step", [0.7, 60.0])
def test_live_tracks_are_those_of_a_recording(grid: RoadGraph, config: TrafficConfig, step: float):
    recording = record("grid", 0, grid, config, DURATION, 1)
    source = started(grid, config)
    try:
        for time in np.arange(0.0, DURATION + step, step):
            source.prepare(min(time, DURATION))
    finally:
        source.close()
    expected = recorded_motion(recording, FLAT, source.motion.kind).sampled().table
    table = source.motion.sampled().table
    np.testing.assert_array_equal(table["present"], expected["present"])
    here = expected["present"] > 0.0
    assert 0.2 < here.mean()
    for name in table.dtype.names or ():
        difference = (table[name] - expected[name])[here]
        if name == "yaw":  # may count whole turns of the vehicles before
            difference = np.angle(np.exp(1j * difference))
        # Exact where vehicles stay; those that leave are placed along a path of finite length.
        assert np.abs(difference).max() <= (0.0 if config is KEPT else 1e-3), name


def test_drivers_signal_as_sumo_has_it(grid: RoadGraph):
    source = LiveSumo(grid, resolved(KEPT, 1), FLAT, kind, DURATION, lamps=True)
    try:
        source.prepare(30.0)
    finally:
        source.close()
    lamps, table = source.motion.lamps[:300], source.motion.table[:300]
    speed = np.hypot(table["velocity_x"], table["velocity_y"])
    slows = (speed[6:] - speed[:-6]) / 0.6 < -3.0
    assert (lamps[3:-3][slows] & Lamp.BRAKE > 0).mean() > 0.7
    left = lamps[table["yaw_rate"] > 0.4]
    assert (left & Lamp.LEFT > 0).mean() > (left & Lamp.RIGHT > 0).mean() + 0.3


def test_only_what_lies_ahead_can_be_changed(live: LiveSumo):
    live.prepare(10.0)
    before = live.motion.table[:110].copy()
    begun = live.ahead

    def slow(run: SumoRun, time: float) -> None:
        run.sumo.vehicle.setSpeed(run.vehicle_of(3), 2.0)

    live.reactions.append(slow)
    live.prepare(40.0)
    np.testing.assert_array_equal(live.motion.table[:110], before)
    assert begun < 10.0 + 4.0  # so much later is what is done seen
    speed = np.hypot(live.motion.table["velocity_x"], live.motion.table["velocity_y"])
    late = slice(200, 400)
    assert speed[late, 3].max() < 2.5
    assert speed[late, :3].max() > 5.0


def test_what_is_past_stays_and_what_is_too_late_is_refused(live: LiveSumo, staying):
    out = ActorState.create(2, live.actors)
    live.at(np.array([3.0, 30.0]), out)
    early = out.position[0].copy()
    live.at(np.array([30.0, 3.0]), out)
    np.testing.assert_array_equal(out.position[1], early)
    assert staying(live, 20.0, 50.0) == list(range(live.actors))
    live.close()
    with pytest.raises(ConfigError, match=r"live traffic was closed at 3\d\.\d s, but 55 s"):
        live.prepare(55.0)


def test_those_who_have_left_are_no_targets(grid: RoadGraph, staying):
    source = started(grid, GROUPS)
    try:
        present = source.motion.sampled().table["present"] > 0.0
        known = round(source.stays().known * 10)
        assert known >= 10
        there = np.flatnonzero(present[: known + 1].all(axis=0))
        assert 0 < len(there) < source.actors
        assert staying(source, 0.0, known / 10) == there.tolist()
    finally:
        source.close()


@pytest.mark.slow
def test_others_share_a_live_world_but_are_no_targets(grid: RoadGraph, live: LiveSumo, staying):
    table = np.zeros((601, 2), SAMPLE)
    table["x"], table["present"] = 7.0, 1.0
    live.close()
    walkers = SampledMotion(table, np.array([9, 9], np.int32), 10.0).packed()
    config = resolved(KEPT, 1)
    source = LiveSumo(grid, config, FLAT, kind, DURATION, others=[walkers])
    try:
        assert source.actors == 14
        source.prepare(20.0)
        assert (source.motion.table["x"][:, 12:] == 7.0).all()
        assert staying(source, 0.0, 10.0) == list(range(12))
    finally:
        source.close()


@pytest.mark.slow
def test_there_is_one_live_world_in_a_process(grid: RoadGraph, live: LiveSumo):
    with pytest.raises(ConfigError, match=r"^traffic\.source: 'live' is in use in this process"):
        started(grid, KEPT)
    with pytest.raises(ConfigError, match="SUMO already runs in this process"):
        record("grid", 0, grid, KEPT, 1.0, 1)
    live.prepare(30.0)  # it drives on
    assert live.motion.sampled().table["present"][300].all()


@pytest.mark.slow
def test_a_live_world_that_nobody_uses_ends(grid: RoadGraph):
    source: LiveSumo | None = started(grid, KEPT)
    assert source is not None
    source = None
    gc.collect()
    started(grid, KEPT).close()


def test_a_recording_is_not_live():
    with pytest.raises(ConfigError, match=r"^recording: .*left out where source is"):
        TrafficConfig(source=Source.LIVE, recording="mine.npz")
