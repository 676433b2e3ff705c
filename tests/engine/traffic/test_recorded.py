from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.behaviours.groups import SampleClock
from eyas.engine.sim.crowd import NOBODY
from eyas.engine.sim.crowd_motion import CrowdSurroundings, with_crowd
from eyas.engine.state.motion import ActorState
from eyas.engine.state.terrain import Terrain
from eyas.engine.traffic import recorded
from eyas.engine.traffic.config import Demand
from eyas.engine.traffic.interpolation import interpolate_actors
from eyas.engine.traffic.recorded import recorded_vehicles
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.recording_file import RecordingFile, to_bytes

from ...kit.motions import recorded_motion

EAST, NORTH = 0.05, -0.02


def on(recording: TrafficRecording, terrain: Terrain, time: np.ndarray) -> ActorState:
    motion = recorded_motion(recording, terrain, np.zeros(recording.actors, np.int32))
    out = ActorState.create(len(time), recording.actors)
    interpolate_actors(motion, time, out)
    return out


@pytest.fixture(scope="module")
def plane() -> Terrain:
    """A slanting plane of 2 km, so that heights and slopes are known."""
    points = 200.0 * np.arange(-10, 11)
    relief = 7.0 + EAST * points[None, :] + NORTH * points[:, None]
    return Terrain(-0.1, relief.astype(np.float32), -2000.0, -2000.0, 200.0)


def test_flat_ground_has_no_heights_and_no_slopes(wandering):
    flat = on(wandering, Terrain.flat(-0.1), np.arange(0.0, 20.0, 0.07))
    assert not flat.position[..., 2].any()
    assert not flat.slope.any()


def test_roads_rise_and_pitch_with_the_relief(wandering, plane):
    time = np.arange(0.0, 20.0, 0.07)
    hilly, flat = on(wandering, plane, time), on(wandering, Terrain.flat(-0.1), time)
    x, y, z = np.moveaxis(hilly.position[:, :2], -1, 0)
    np.testing.assert_allclose(z, 7.0 + EAST * x + NORTH * y, atol=1e-3)
    along = EAST * np.cos(hilly.yaw) + NORTH * np.sin(hilly.yaw)
    np.testing.assert_allclose(np.tan(hilly.slope[:, :2]), along[:, :2], atol=1e-3)
    assert np.abs(hilly.slope).max() > 0.01
    np.testing.assert_array_equal(hilly.position[..., :2], flat.position[..., :2])
    for name in ("yaw", "speed", "yaw_rate", "travelled", "present"):
        np.testing.assert_array_equal(getattr(hilly, name), getattr(flat, name))


def test_heights_between_samples_follow_the_motion(wandering, plane):
    """A curve through the samples that took its slope from elsewhere would leave the plane."""
    coarse = wandering.rate / 10.0
    motion = recorded_motion(wandering, plane, np.zeros(3, np.int32))
    few = motion.of(motion.table[::10])._replace(rate=coarse)
    out = ActorState.create(400, 3)
    interpolate_actors(few, np.linspace(0.0, 20.0, 400), out)
    x, y, z = np.moveaxis(out.position[:, :2], -1, 0)
    np.testing.assert_allclose(z, 7.0 + EAST * x + NORTH * y, atol=2e-3)


def kept_motion(recording, terrain, kind):
    file = RecordingFile(to_bytes(recording), "drive.npz")
    vehicles = recorded_vehicles(file, terrain, kind, None)
    clock = SampleClock(vehicles.samples, vehicles.rate)
    motion, targets = with_crowd(NOBODY, CrowdSurroundings(None, clock, 0, vehicles))
    assert targets.all()
    return motion


def test_a_motion_is_smoothed_once_and_then_read_from_the_cache(
    wandering, plane, tmp_path, monkeypatch
):
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    smoothed, before = [], recorded.smooth
    monkeypatch.setattr(recorded, "smooth", lambda found: smoothed.append(0) or before(found))
    kind = np.zeros(wandering.actors, np.int32)
    expected = recorded_motion(wandering, plane, kind)
    for _ in range(2):
        kept = kept_motion(wandering, plane, kind)
        assert kept.table.dtype == expected.table.dtype
        assert kept.table.flags.aligned
        np.testing.assert_array_equal(kept.sampled().table, expected.sampled().table)
        np.testing.assert_array_equal(kept.kind, expected.kind)
        assert (kept.rate, kept.first_time) == (expected.rate, expected.first_time)
        assert kept.lamps.size == 0
    assert len(smoothed) == 2  # the expected one, and one to keep
    kept_motion(wandering, Terrain.flat(0.0), kind)
    assert len(smoothed) == 3
    config = wandering.provenance.config.model_copy(update={"demand": Demand.RESPAWN})
    groups = replace(wandering, provenance=replace(wandering.provenance, config=config))
    brisk = kept_motion(groups, plane, kind)  # the same poses, smoothed less
    assert len(smoothed) == 4
    assert not np.array_equal(brisk.table, expected.table)
