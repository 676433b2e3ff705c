"""Trailers: they swing behind their trucks, and no wheel slides."""

import math
from dataclasses import replace

import numpy as np

from eyas.engine.state.motion import ActorState
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.catalogue import kind_index, model_index
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs
from eyas.engine.targets.vehicles.pose import VEHICLE_AHEAD
from eyas.engine.traffic import trailer
from eyas.engine.traffic.config import VehicleType
from eyas.engine.traffic.trailer import Links, tow

from ...kit.motions import recorded_motion

RATE, SPEED, RADIUS = 50.0, 5.0, 12.0
LENGTH = 16.5  # of SUMO's trailer


def bend():
    """Return a path: 60 m straight on, a quarter to the left, 60 m straight on."""
    way = np.arange(0.0, 120.0 + 0.5 * math.pi * RADIUS, SPEED / RATE)
    turn = np.clip((way - 60.0) / RADIUS, 0.0, 0.5 * math.pi)
    after = way - 60.0 - turn * RADIUS
    east = np.where(way < 60.0, way, 60.0 + RADIUS * np.sin(turn))
    north = np.where(way < 60.0, 0.0, RADIUS * (1.0 - np.cos(turn)))
    return np.stack([east, np.where(after > 0.0, north + after, north)], axis=-1)


def parts(motion):
    """Return the poses of truck and trailer as they are drawn, shape (S, 3, 4) each."""
    rigs = Rigs(np.array([kind_index("trailer")], np.int32))
    count = len(motion.heading)
    actors = ActorState.create(count, 1)
    actors.position[:, 0, :2], actors.yaw[:, 0] = motion.centre, motion.heading
    actors.hitch[:, 0], actors.present[:] = motion.hitch, True
    model = np.full((count, 1), model_index("TruckTrailerSimple"), np.int32)
    drawn = rigs.draw_list(count)
    rigs.pose(actors, Looks(model, np.ones((count, 1, 3), np.float32)), drawn)
    towed = [slot for slot in range(1, drawn.part.shape[1]) if drawn.pose[0, slot, 2, 3] == 0.0]
    return drawn.pose[:, 0].astype(float), drawn.pose[:, towed[0]].astype(float)


def placed(pose, x):
    """Return where a point on the middle line of a part is."""
    return pose[:, :2, 3] + x * pose[:, :2, 0]


def test_the_reference_point_is_ahead_of_the_middle_as_of_all_vehicles():
    assert trailer._REFERENCE == -VEHICLE_AHEAD


def test_a_trailer_swings_in_a_bend_and_is_straight_before_and_long_after():
    motion = tow(bend(), LENGTH, Links.straight(0.0))
    assert np.abs(motion.hitch[: int(50.0 / SPEED * RATE)]).max() < 1e-6
    assert -0.9 < motion.hitch.min() < -0.4  # it points less far to the left
    assert abs(motion.hitch[-1]) < 0.01
    assert abs(motion.heading[-1] - 0.5 * math.pi) < 0.01


def test_the_bumper_stays_on_the_lane():
    path = bend()
    truck, _ = parts(tow(path, LENGTH, Links.straight(0.0)))
    bumper = placed(truck, 0.5 * (trailer.BUMPER_AHEAD + trailer.TAIL_BEHIND))[100:-100]
    off = np.linalg.norm(bumper[:, None] - path[None, ::5], axis=-1).min(axis=1)
    assert off.max() < 0.4


def test_no_axle_slides_and_both_parts_meet_at_the_kingpin():
    truck, towed = parts(tow(bend(), LENGTH, Links.straight(0.0)))
    kingpin = 0.5 * (trailer.TAIL_BEHIND - trailer.BUMPER_AHEAD)
    np.testing.assert_allclose(placed(truck, kingpin), placed(towed, kingpin), atol=1e-4)
    fixed = (truck, kingpin - trailer.REAR_AXLE), (towed, kingpin - trailer.AXLES_BEHIND)
    for pose, x in fixed:
        moved = np.diff(placed(pose, x), axis=0)
        aside = pose[:-1, 1, 0] * moved[:, 0] - pose[:-1, 0, 0] * moved[:, 1]
        assert np.abs(aside).max() * RATE < 0.05 * SPEED


def test_turning_on_and_on_is_no_jump():
    """The headings of a ring go past half a turn, where the direction of the pull jumps."""
    angle = np.linspace(0.0, 6.0 * math.pi, 4000)
    path = 15.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    motion = tow(path, LENGTH, Links.straight(0.5 * math.pi))
    assert np.abs(np.diff(motion.heading)).max() < 0.02
    assert np.abs(np.diff(motion.hitch)).max() < 0.02
    assert motion.heading[-1] - motion.heading[0] > 5.0 * math.pi
    # Each follows its ring in a smaller one: the truck's axle, the axles of the trailer.
    lead = 0.5 * LENGTH - 0.5 * (trailer.BUMPER_AHEAD + trailer.TAIL_BEHIND) + trailer._REFERENCE
    squared = 15.0**2 - lead**2 - (trailer.BUMPER_AHEAD + trailer.REAR_AXLE) ** 2
    kingpin = squared + trailer.REAR_AXLE**2
    axles = kingpin - trailer.AXLES_BEHIND**2
    truck, towed = parts(motion)
    fifth = 0.5 * (trailer.TAIL_BEHIND - trailer.BUMPER_AHEAD)
    for pose, x, wanted in (
        (truck, fifth - trailer.REAR_AXLE, squared),
        (towed, fifth, kingpin),
        (towed, fifth - trailer.AXLES_BEHIND, axles),
    ):
        radius = np.linalg.norm(placed(pose, x)[-500:], axis=-1)
        np.testing.assert_allclose(radius, math.sqrt(wanted), atol=0.02)


def test_the_motion_can_be_taken_up_at_any_pose():
    path = bend()
    whole = tow(path, LENGTH, Links.straight(0.0))
    at = 700
    links = Links.of(path[at], whole.centre[at], float(whole.heading[at]), float(whole.hitch[at]))
    rest = tow(path[at:], LENGTH, links)
    np.testing.assert_allclose(rest.centre, whole.centre[at:], atol=1e-9)
    np.testing.assert_allclose(rest.hitch, whole.hitch[at:], atol=1e-9)


def test_recorded_trailers_swing(make_recording):
    path = bend()[:: round(RATE / 10.0)]
    yaw = np.unwrap(np.arctan2(*np.gradient(path, axis=0).T[::-1]))
    recording = make_recording(path[:, None], yaw[:, None])
    kind = np.array([kind_index("trailer")], np.int32)
    flat = Terrain.flat(0.0)
    truck = replace(
        recording, vehicle_types=(VehicleType.TRAILER,), vehicle_length=np.array([LENGTH])
    )
    assert recorded_motion(truck, flat, kind).sampled().table["hitch"].min() < -0.3
    assert not recorded_motion(recording, flat, kind).sampled().table["hitch"].any()
