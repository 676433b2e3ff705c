"""What flies: smooth ways above all that stands, as its seed has them."""

import numpy as np

from eyas.engine.behaviours.airborne import chases, flocks
from eyas.engine.behaviours.airspace import Space
from eyas.engine.behaviours.groups import SampleClock
from eyas.engine.core.rng import stream
from eyas.engine.state.motion import SAMPLE, SampledMotion

CLOCK = SampleClock(900, 10.0)
EXTENT = np.array([600.0, 600.0])


def heights(points):
    """Towers of 30 m east of the middle."""
    return np.where(points[..., 0] > 0.0, 30.0, 0.0)


def birds(count=9, seed=4):
    return flocks(count, 3, Space(EXTENT, heights), CLOCK, stream(seed, "birds"), 11.0)


def places(motion):
    return np.stack([motion.table[axis] for axis in "xyz"], axis=-1).astype(float)


def test_birds_fly_above_what_stands_there_and_not_out_of_sight():
    place = places(birds())
    above = place[..., 2] - heights(place[..., :2])
    assert above.min() > 1.0
    assert place[..., 2].max() < 70.0
    assert (np.abs(place[..., :2]) < 0.5 * EXTENT).all()


def test_their_motion_is_smooth_and_as_fast_as_is_said():
    motion = birds()
    place, table = places(motion), motion.table
    velocity = np.stack([table[f"velocity_{axis}"] for axis in "xyz"], axis=-1)
    steps = np.diff(place, axis=0) * CLOCK.rate
    np.testing.assert_allclose(steps, 0.5 * (velocity[1:] + velocity[:-1]), atol=0.15)
    speed = np.hypot(table["velocity_x"], table["velocity_y"])
    assert 8.0 < np.median(speed) < 15.0
    assert np.abs(np.diff(table["yaw"], axis=0)).max() < 0.3


def test_the_seed_decides():
    np.testing.assert_array_equal(birds().table, birds().table)
    assert (birds().table["x"] != birds(seed=5).table["x"]).any()


def test_a_drone_follows_its_vehicle_from_above_while_that_is_there():
    table = np.zeros((600, 3), SAMPLE)
    time = np.arange(600) / 10.0
    for k in range(3):
        table["x"][:, k], table["y"][:, k], table["present"][:, k] = 9.0 * time, 20.0 * k, 1.0
    table["present"][300:, 1] = 0.0
    vehicles = SampledMotion(table, np.zeros(3, np.int32), 10.0)
    drones = chases(3, 7, vehicles, stream(1, "drones"))
    assert drones.kind.tolist() == [7, 7, 7]
    of = np.round(drones.table["y"][200] / 20.0).astype(int)
    assert sorted(of) == [0, 1, 2]
    behind = table["x"][200, of] - drones.table["x"][200]
    np.testing.assert_allclose(behind, 13.5, atol=0.1)
    assert ((drones.table["z"] > 10.0) & (drones.table["z"] < 27.0)).all()
    there = drones.table["present"][:, of.tolist().index(1)] > 0.5
    assert there[:270].all()
    assert not there[330:].any()
