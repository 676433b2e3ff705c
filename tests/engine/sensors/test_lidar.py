"""The lidar, against rooms whose distances have a closed form."""

import math

import numpy as np
import pytest

from eyas.engine.camera.config import MountConfig
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.sensors.bodies import BODY
from eyas.engine.sensors.config import LidarConfig
from eyas.engine.sensors.lidar import MOUNT, Lidar
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.catalogue import MODELS, kind_of, model_index

EXACT = LidarConfig(enabled=True, noise=0.0, resolution=0.0)
POINT = np.arange(400)
AZIMUTH = -math.pi - 2 * math.pi * POINT / 400
"""Direction of each point in the body frame: point 0 looks back, 100 left, 200 ahead."""


def turned(world, config=EXACT, seed=0):
    """A lidar after a whole turn from where the trackers stand."""
    snapshot, obstacles = world
    count = len(snapshot.episodes.tick)
    lidar = Lidar(config, snapshot, obstacles, np.ones(count, np.bool_))
    for tracker in range(count):
        lidar.begin(tracker, EpisodeKey(seed + tracker, 0, 0))
    lidar.advance()
    return lidar


def room(west, south, east, north):
    """Outline of a room, seen from inside."""
    return [(west, south), (east, south), (east, north), (west, north)]


@pytest.mark.parametrize("yaw", [0.001, 0.7, -2.9])
def test_a_room_has_the_distances_of_its_walls(around, yaw):
    world = around((1.0, -0.5, 5.0, yaw), prisms=[(room(-4, -3, 6, 5), 0.0, 9.0)])
    direction = AZIMUTH + yaw
    with np.errstate(divide="ignore"):
        along = np.where(np.cos(direction) > 0, 5.0, -5.0) / np.cos(direction)
        across = np.where(np.sin(direction) > 0, 5.5, -2.5) / np.sin(direction)
    lidar = turned(world)
    assert lidar.ranges()[0] == pytest.approx(np.minimum(along, across), abs=1e-9)
    assert (lidar.things() == 1).all()


def test_a_pole_is_as_far_as_its_circle(around):
    x, y, radius = 4.0, 1.0, 0.5
    lidar = turned(around((0, 0, 5.0, 0), cylinders=[(x, y, radius, 0.0, 9.0)]))
    ahead = x * np.cos(AZIMUTH) + y * np.sin(AZIMUTH)
    under = ahead**2 - (x * x + y * y - radius**2)
    hit = (under > 0) & (ahead > 0)
    expected = np.where(hit, ahead - np.sqrt(np.maximum(under, 0.0)), np.inf)
    assert hit.sum() == 16
    assert lidar.ranges()[0] == pytest.approx(expected, abs=1e-9)
    assert lidar.things()[0].tolist() == [2 if one else -1 for one in hit]


def test_points_begin_at_the_back_and_turn_clockwise(around):
    walls = [
        ([(-3, -1), (-2, -1), (-2, 1), (-3, 1)], 0, 9),  # behind
        ([(-1, 4), (1, 4), (1, 5), (-1, 5)], 0, 9),  # to the left
        ([(6, -1), (7, -1), (7, 1), (6, 1)], 0, 9),  # ahead
        ([(-1, -9), (1, -9), (1, -8), (-1, -8)], 0, 9),  # to the right
    ]
    lidar = turned(around((0, 0, 5.0, 0), prisms=walls))
    assert lidar.ranges()[0, [0, 100, 200, 300]] == pytest.approx([2.0, 4.0, 6.0, 8.0])


def test_what_is_lower_or_higher_or_too_near_or_too_far_is_not_seen(around):
    wall = [(2, -1), (3, -1), (3, 1), (2, 1)]
    beam = 5.0 + MOUNT.z
    for bottom, top, seen in ((0, beam - 0.01, 0), (beam + 0.01, 9, 0), (0, beam + 0.01, 1)):
        lidar = turned(around((0, 0, 5.0, 0), prisms=[(wall, bottom, top)]))
        assert np.isfinite(lidar.ranges()[0, 200]) == seen
    for x, seen in ((0.19, 0), (0.21, 1), (11.9, 1), (12.1, 0)):
        wall = [(x, -1), (13, -1), (13, 1), (x, 1)]
        lidar = turned(around((0, 0, 5.0, 0), prisms=[(wall, 0, 9)]))
        assert np.isfinite(lidar.ranges()[0, 200]) == seen


def test_the_nearest_of_several_is_told(around):
    walls = [([(x, -1), (x + 1, -1), (x + 1, 1), (x, 1)], 0, 9) for x in (9, 3, 6)]
    lidar = turned(around((0, 0, 5.0, 0), prisms=walls, cylinders=[(5, 0, 0.5, 0, 9)]))
    assert lidar.ranges()[0, 200] == pytest.approx(3.0)


def test_a_tilted_body_sees_the_ground(around):
    snapshot, obstacles = around((0, 0, 2.0, 0))
    pitch = 0.5  # the nose is down
    snapshot.trackers.orientation[0] = math.cos(pitch / 2), 0.0, math.sin(pitch / 2), 0.0
    lidar = turned((snapshot, obstacles))
    height = 2.0 + MOUNT.z * math.cos(pitch) + 0.1
    assert lidar.ranges()[0, 200] == pytest.approx(height / math.sin(pitch))
    assert lidar.things()[0, 200] == 0
    assert np.isinf(lidar.ranges()[0, 0])  # the other side looks into the sky


def test_a_slope_is_as_far_as_its_plane(around):
    rise = 0.4
    grid = np.arange(-40.0, 41.0, 4.0)
    relief = np.tile((rise * grid + 20.0).astype(np.float32), (len(grid), 1))
    terrain = Terrain(0.0, relief, -40.0, -40.0, 4.0)
    lidar = turned(around((0, 0, 22.0, 0), relief=terrain))
    assert lidar.ranges()[0, 200] == pytest.approx((2.0 + MOUNT.z) / rise, abs=1e-3)
    assert np.isinf(lidar.ranges()[0, [0, 100, 300]]).all()


def test_a_car_is_where_it_drives(around):
    model = model_index("BmwX5Simple")
    size, ahead = MODELS[model].size, kind_of(model).ahead
    snapshot, obstacles = around((0, 0, 1.0, 0), cars=[(8.0, 0.0, 0.0, -10.0), (0, 99, 0, 0)])
    rear = ahead - size[0] / 2
    assert turned((snapshot, obstacles)).ranges()[0, 200] == pytest.approx(8.0 + rear, abs=1e-5)
    snapshot.episodes.tick[0] = 100  # it has come 2 m nearer
    lidar = turned((snapshot, obstacles))
    assert lidar.ranges()[0, 200] == pytest.approx(6.0 + rear, abs=1e-5)
    assert lidar.things()[0, 200] == ACTOR_OBJECT
    snapshot.trackers.position[0, 2] = size[2] + 0.1
    assert np.isinf(turned((snapshot, obstacles)).ranges()).all()


def test_a_folded_truck_is_where_its_parts_are(around):
    """Its kingpin is at the origin, its cab east of it, and its trailer south of it."""
    trailer, cab, chassis = 0.5 * 2.52, 0.5 * 2.8, 0.5 * 2.5
    for (x, y, z), west, north in (
        ((3.0, -5.0, 3.0), 3.0 - trailer, 5.0 - cab),
        ((1.7, -5.0, 3.0), 1.7 - trailer, np.inf),  # over the chassis
        ((1.7, -5.0, 1.0), 1.7 - trailer, 5.0 - chassis),
        ((3.0, 3.0, 3.0), np.inf, np.inf),
    ):
        lidar = turned(around((x, y, z, 0.0), folded=True))
        assert lidar.ranges()[0, [0, 100]] == pytest.approx([west, north], abs=1e-5)
        hit = np.isfinite(lidar.ranges()[0])
        assert set(lidar.things()[0, hit].tolist()) <= {ACTOR_OBJECT}
    # The bumper and the tail.
    west = turned(around((9.0, 0.0, 2.0, 0.0), folded=True)).ranges()[0, 0]
    north = turned(around((0.0, -12.0, 2.0, 0.0), folded=True)).ranges()[0, 100]
    assert (west, north) == pytest.approx((9.0 - 4.75, 12.0 - 9.55), abs=1e-5)


def test_only_the_points_that_turn_by_are_new(around):
    snapshot, obstacles = around((0.0, 0, 5.0, 0), prisms=[(room(-5, -5, 5, 5), 0, 9)])
    lidar = turned((snapshot, obstacles))
    before = lidar.ranges()[0]
    snapshot.trackers.position[0, 0] = 1.0
    fresh = turned((snapshot, obstacles)).ranges()[0]
    for step, points in ((1, 9), (2, 19), (5, 48), (42, 400)):  # 9.6 a step, 400 in 41.7
        snapshot.episodes.step_count[0] = step
        snapshot.episodes.tick[0] = 1000 + step
        lidar.advance()
        assert lidar.ranges()[0] == pytest.approx(np.where(points > POINT, fresh, before))
    times = lidar.packets().reshape(400, 5)[:, 4]
    assert times[[1, 12, 30, 399]] == pytest.approx([2.084, 2.004, 2.01, 2.084])


def test_a_tracker_whose_time_stands_still_measures_nothing(around):
    snapshot, obstacles = around((0.0, 0, 5.0, 0), prisms=[(room(-5, -5, 5, 5), 0, 9)])
    active = np.ones(1, np.bool_)
    lidar = Lidar(EXACT, snapshot, obstacles, active)
    lidar.begin(0, EpisodeKey(0, 0, 0))
    lidar.advance()
    before = lidar.ranges()
    snapshot.trackers.position[0, 0] = 1.0
    snapshot.episodes.step_count[0], active[0] = 10, False
    lidar.advance()
    np.testing.assert_array_equal(lidar.ranges(), before)


def test_noise_and_resolution_are_those_of_the_settings(around):
    poses = [(0.0, 0.0, 5.0, 0.0)] * 40
    world = around(*poses, cylinders=[])
    snapshot, obstacles = around(*poses, prisms=[(room(-5, -5, 5, 5), 0, 9)])
    exact = turned((snapshot, obstacles)).ranges()
    noisy = turned((snapshot, obstacles), LidarConfig(enabled=True, resolution=0.0)).ranges()
    error = (noisy - exact).ravel()  # 16,000 numbers
    assert abs(error.mean()) < 4 * 0.01 / math.sqrt(error.size)
    assert error.std() == pytest.approx(0.01, rel=0.03)
    assert np.mean(np.abs(error) < 0.01) == pytest.approx(0.6827, abs=0.02)
    # Neither trackers nor points share their noise.
    table = error.reshape(exact.shape)
    assert abs(np.corrcoef(table[:, :-1].ravel(), table[:, 1:].ravel())[0, 1]) < 0.04
    assert abs(np.corrcoef(table[:-1].ravel(), table[1:].ravel())[0, 1]) < 0.04
    told = turned((snapshot, obstacles), LidarConfig(enabled=True)).ranges()
    assert told * 100 == pytest.approx(np.round(told * 100), abs=1e-9)
    missing = turned((snapshot, obstacles), LidarConfig(enabled=True, drop_out=0.1)).ranges()
    assert np.isinf(missing).mean() == pytest.approx(0.1, abs=0.01)
    assert np.isinf(turned(world).ranges()).all()


def test_no_noise_leads_out_of_range(around):
    wall = [(11.99, -9), (13, -9), (13, 9), (11.99, 9)]
    config = LidarConfig(enabled=True, noise=0.5, resolution=0.0)
    ranges = turned(around(*[(0, 0, 5.0, 0)] * 40, prisms=[(wall, 0, 9)]), config).ranges()
    seen = ranges[np.isfinite(ranges)]
    assert seen.max() == 12.0
    assert seen.min() < 11.5
    near = room(-0.21, -0.21, 0.21, 0.21)
    ranges = turned(around((0, 0, 5.0, 0), prisms=[(near, 0, 9)]), config).ranges()
    assert ranges.min() == 0.2


def test_the_same_seed_gives_the_same_noise_and_another_seed_another(around):
    world = around((0.0, 0.0, 5.0, 0.0), prisms=[(room(-5, -5, 5, 5), 0, 9)])
    config = LidarConfig(enabled=True)
    first, again, other = (turned(world, config, seed).ranges() for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).mean() > 0.5


def test_packets_hold_points_in_the_frame_of_the_lidar(around):
    lidar = turned(around((0, 0, 5.0, 1.0), cylinders=[(3.0, 0.5, 1.0, 0, 9)]))
    rows = lidar.packets()
    assert rows.shape == (1, 2000)
    points, ranges = rows.reshape(400, 5), lidar.ranges()[0]
    seen = np.isfinite(ranges)
    assert np.hypot(points[seen, 0], points[seen, 1]) == pytest.approx(ranges[seen])
    angle = np.arctan2(points[seen, 1], points[seen, 0])
    assert np.cos(angle - AZIMUTH[seen]) == pytest.approx(1.0)
    assert np.isinf(points[~seen, :2]).all()
    assert not points[:, 2:4].any()
    filled = np.zeros((1, 400), np.float32)
    lidar.fill(filled)
    assert filled[0] == pytest.approx(np.where(seen, ranges, 12.0))


def test_a_mount_moves_and_turns_it(around):
    mount = MountConfig(x=1.0, y=-0.5, z=-0.3, yaw=0.6)
    config = EXACT.model_copy(update={"mount": mount})
    yaw = 0.9
    lidar = turned(around((1.0, -0.5, 5.0, yaw), prisms=[(room(-6, -5, 6, 5), 0.0, 9.0)]), config)
    x = 1.0 + math.cos(yaw) * 1.0 + math.sin(yaw) * 0.5
    y = -0.5 + math.sin(yaw) * 1.0 - math.cos(yaw) * 0.5
    direction = AZIMUTH + yaw + 0.6
    along = np.where(np.cos(direction) > 0, 6.0 - x, -6.0 - x) / np.cos(direction)
    across = np.where(np.sin(direction) > 0, 5.0 - y, -5.0 - y) / np.sin(direction)
    assert lidar.ranges()[0] == pytest.approx(np.minimum(along, across), abs=1e-9)
    beam = 5.0 - 0.3
    for top, seen in ((beam - 0.01, False), (beam + 0.01, True)):
        world = around((0.0, 0, 5.0, 0), prisms=[(room(-5, -5, 5, 5), 0.0, top)])
        assert np.isfinite(turned(world, config).ranges()).all() == seen


def test_a_mount_that_looks_down_or_rolls_sees_the_ground(around):
    for turn, point in (({"pitch": 0.5}, 200), ({"roll": 0.5}, 300), ({"roll": -0.5}, 100)):
        mount = MountConfig(z=-0.2, **turn)
        config = EXACT.model_copy(update={"mount": mount})
        ranges = turned(around((0, 0, 3.0, 0.3)), config).ranges()[0]
        assert ranges[point] == pytest.approx((3.0 - 0.2 + 0.1) / math.sin(0.5))
        assert np.isinf(ranges[(point + 200) % 400])
        # A packet tells points in the frame of the lidar.
        rows = turned(around((0, 0, 3.0, 0.3)), config).packets().reshape(400, 5)
        assert math.hypot(*rows[point, :2]) == pytest.approx(ranges[point])
        assert not rows[:, 2].any()


def test_a_bias_is_one_number_for_all_distances_of_an_episode(around):
    poses = [(0.0, 0.0, 5.0, 0.0)] * 300
    world = around(*poses, prisms=[(room(-5, -5, 5, 5), 0, 9)])
    exact, biased = turned(world), turned(world, EXACT.model_copy(update={"bias": 0.1}))
    error = biased.ranges() - exact.ranges()
    assert np.ptp(error, axis=1).max() < 1e-9
    assert error[:, 0].std() == pytest.approx(0.1, rel=0.15)
    assert abs(error[:, 0].mean()) < 4 * 0.1 / math.sqrt(300)


def test_late_points_are_those_of_so_many_steps_ago(around):
    snapshot, obstacles = around((0.0, 0, 5.0, 0), prisms=[(room(-5, -5, 5, 5), 0, 9)])
    on_time, delayed = EXACT, EXACT.model_copy(update={"delay_steps": 60})
    active = np.ones(1, np.bool_)
    lidars = [Lidar(c, snapshot, obstacles, active, latest=50) for c in (on_time, delayed)]
    for lidar in lidars:
        lidar.begin(0, EpisodeKey(0, 0, 0))
        lidar.advance()
    told = [(lidars[0].ranges(), lidars[0].packets())]
    for step in range(1, 180):
        snapshot.trackers.position[0, 0] = math.sin(0.05 * step)
        snapshot.episodes.step_count[0] = step
        snapshot.episodes.tick[0] = 1000 + step
        for lidar in lidars:
            lidar.advance()
        told.append((lidars[0].ranges(), lidars[0].packets()))
        for late in (0, 7, 50):
            for lidar, own in ((lidars[0], 0), (lidars[1], 60)):
                ranges, packets = told[max(step - late - own, 0)]
                np.testing.assert_array_equal(lidar.ranges(np.array([late])), ranges)
                np.testing.assert_array_equal(lidar.packets(np.array([late])), packets)


def test_other_drones_are_seen(around):
    poses = (0.0, 0.0, 5.0, 0.0), (4.0, 0.0, 5.0, 0.0)
    lidar = turned(around(*poses, bodies=True))
    assert lidar.ranges()[0, 200] == pytest.approx(4.0 - BODY[0] / 2)
    assert lidar.ranges()[1, 0] == pytest.approx(4.0 - BODY[0] / 2)
    assert lidar.things()[[0, 1], [200, 0]].tolist() == [ACTOR_OBJECT + 2, ACTOR_OBJECT + 1]
    assert np.isinf(turned(around(*poses)).ranges()).all()


@pytest.mark.parametrize("steps", [1, 20, 41, 42, 60])  # a turn takes 41.7
def test_the_first_turn_is_the_same_whenever_it_is_asked_for(around, steps):
    def flown(asked_at_once: bool) -> list:
        snapshot, obstacles = around((0.0, 0, 5.0, 0), prisms=[(room(-5, -5, 5, 5), 0, 9)])
        lidar = turned((snapshot, obstacles), LidarConfig(enabled=True))
        if asked_at_once:
            lidar.ranges()
        for step in range(1, steps + 1):
            snapshot.trackers.position[0, 0] = 0.01 * step
            snapshot.episodes.step_count[0] = step
            snapshot.episodes.tick[0] = 1000 + step
            lidar.advance()
        return [lidar.ranges(), lidar.things(), lidar.packets()]

    for late, early in zip(flown(False), flown(True), strict=True):
        np.testing.assert_array_equal(late, early)
