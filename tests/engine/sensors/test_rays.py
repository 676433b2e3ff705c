"""Rays, against a plain search through everything there is."""

import math

import numpy as np
import pytest

from eyas.engine.camera.config import MountConfig
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.sensors.config import LidarConfig
from eyas.engine.sensors.lidar import Lidar
from eyas.engine.state.terrain import Terrain, ground_at

REACH = 150.0
MIDDLE = MountConfig(x=0.0, y=0.0, z=0.0)
CONFIG = LidarConfig(
    enabled=True, points=180, min_range=0.0, max_range=REACH, noise=0.0, resolution=0.0
)


def scanned(world):
    """Distances and things around the first tracker, and the rays in the world frame."""
    snapshot, obstacles = world
    lidar = Lidar(CONFIG, snapshot, obstacles, np.ones(1, np.bool_), mount=MIDDLE)
    lidar.begin(0, EpisodeKey(0, 0, 0))
    lidar.advance()
    return lidar.ranges()[0], lidar.things()[0]


def rays(yaw, pitch=0.0):
    """Directions of the points of a body that is turned, shape (P, 3)."""
    angle = -math.pi - 2 * math.pi / CONFIG.points * np.arange(CONFIG.points)
    x, y = np.cos(angle), np.sin(angle)
    ahead, up = x * math.cos(pitch), -x * math.sin(pitch)
    east = ahead * math.cos(yaw) - y * math.sin(yaw)
    return np.column_stack([east, ahead * math.sin(yaw) + y * math.cos(yaw), up])


def tilted(snapshot, yaw, pitch):
    c, s, p, q = (f(0.5 * a) for a in (yaw, pitch) for f in (math.cos, math.sin))
    snapshot.trackers.orientation[0] = c * p, -s * q, c * q, s * p


def blocks(rng, count, half):
    """Turned boxes that stand anywhere, many of them in each other."""
    found = []
    for _ in range(count):
        x, y = rng.uniform(-half, half, 2)
        long, wide, yaw = rng.uniform(0.2, 15.0), rng.uniform(0.2, 6.0), rng.uniform(0.0, 3.2)
        corners = np.array([[-long, -wide], [long, -wide], [long, wide], [-long, wide]])
        turn = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
        low = rng.uniform(0.0, 4.0)
        found.append((0.5 * corners @ turn + (x, y), low, low + rng.uniform(0.5, 9.0)))
    return found


def nearest_block(origin, ray, found):
    """The distance of the first box that a ray meets, by planes of its sides and ends."""
    best = math.inf
    for corners, low, high in found:
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            side, way = b - a, a - origin[:2]
            across = ray[0] * side[1] - ray[1] * side[0]
            t = (way[0] * side[1] - way[1] * side[0]) / across
            share = (way[0] * ray[1] - way[1] * ray[0]) / across
            if 0 <= share <= 1 and 0 <= t < best and low <= origin[2] + t * ray[2] <= high:
                best = t
        for end in (low, high):
            t = (end - origin[2]) / ray[2] if ray[2] else math.inf
            if not 0 <= t < best:
                continue
            at = origin[:2] + t * ray[:2]
            sides = np.roll(corners, -1, axis=0) - corners
            if (sides[:, 0] * (at - corners)[:, 1] >= sides[:, 1] * (at - corners)[:, 0]).all():
                best = t
    return best if best <= REACH else math.inf


@pytest.mark.slow
@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (0.3, 0.0), (-2.0, 0.05), (1.6, -0.4)])
def test_no_solid_in_the_way_of_a_ray_is_passed_by(around, yaw, pitch):
    found = blocks(np.random.default_rng(5), 150, 140.0)
    origin = np.array([3.0, -7.0, 5.0])
    snapshot, obstacles = around((*origin, 0.0), prisms=found)
    tilted(snapshot, yaw, pitch)
    ranges, things = scanned((snapshot, obstacles))
    expected = np.array([nearest_block(origin, ray, found) for ray in rays(yaw, pitch)])
    ground = np.array([5.1 / -ray[2] if ray[2] < 0 else math.inf for ray in rays(yaw, pitch)])
    ground[ground > REACH] = math.inf
    assert ranges == pytest.approx(np.minimum(expected, ground), abs=1e-6)
    assert (things[expected < ground] == 1).all()
    assert np.isfinite(expected).sum() > 10


@pytest.mark.parametrize("yaw", [0.0, 1.5707, 2.5, -2.0])
def test_of_solids_at_the_same_distance_the_southernmost_and_westernmost_counts(around, yaw):
    # A room, one wall of which is also that of a solid to its south, and one to its east.
    ring = [(-30.0, -30.0), (30.0, -30.0), (30.0, 30.0), (-30.0, 30.0)]
    south, east = [*ring[:2], (30, -60), (-30, -60)], [*ring[1:3], (60, 30), (60, -30)]
    walls = [(outline, 0, 9) for outline in (ring, south, east)]
    snapshot, obstacles = around((0.0, 0.0, 5.0, yaw), prisms=walls)
    solids = obstacles.solids._replace(thing=np.array([7, 8, 9], np.int32))
    ranges, things = scanned((snapshot, obstacles._replace(solids=solids)))
    southern = rays(yaw)[:, 1] * ranges < -29.999
    assert set(things[southern].tolist()) == {8}
    assert set(things[~southern].tolist()) == {7}


@pytest.mark.parametrize("height", [0.4, 3.0, 12.0])
def test_hills_are_met_where_small_steps_meet_them(around, height):
    rng = np.random.default_rng(8)
    relief = np.repeat(np.repeat(rng.uniform(0.0, 6.0, (15, 15)), 5, 0), 5, 1).astype(np.float32)
    terrain = Terrain(0.0, relief, -148.0, -148.0, 4.0)
    z = height + ground_at(terrain, 2.0, 1.0)
    snapshot, obstacles = around((2.0, 1.0, z, 0.0), relief=terrain)
    tilted(snapshot, 0.4, 0.1)
    ranges, _ = scanned((snapshot, obstacles))
    steps = int(REACH / 2.0) + 1
    met = []
    for ray in rays(0.4, 0.1):
        along = REACH * np.arange(1, steps + 1) / steps
        under = [z + t * ray[2] <= ground_at(terrain, 2.0 + t * ray[0], 1.0 + t * ray[1])
                 for t in along]  # fmt: skip
        met.append(REACH * (under.index(True) + 0.5) / steps if any(under) else math.inf)
    assert np.isfinite(met).sum() > 10
    assert ranges == pytest.approx(np.array(met), abs=0.5 * REACH / steps + 1e-6)
