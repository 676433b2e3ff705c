import functools
from dataclasses import replace

import numpy as np
import pytest

from art.vehicles.models import VEHICLES
from art.vehicles.two_wheelers import LEAN_LIMIT
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, models_of, register
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs, part_library
from eyas.engine.targets.vehicles.pose import STEER_LIMIT
from eyas.engine.traffic.config import VehicleType

TYPES = list(VehicleType)
MADE = {vehicle.name: vehicle for vehicle in VEHICLES}


@functools.cache
def library_of(vehicle_type):
    return part_library((KINDS[kind_index(vehicle_type)],))


def rigs_of(vehicle_type, count):
    return Rigs(np.full(count, kind_index(vehicle_type), np.int32))


def own_models(vehicle_type):
    return models_of(kind_index(vehicle_type))


def wheels(vehicle_type, parts, poses):
    """The parts and poses of one actor that are wheels."""
    bodies = (parts[0], *KINDS[kind_index(vehicle_type)].trailers)
    return [(part, pose) for part, pose in zip(parts, poses, strict=True) if part not in bodies]


def colours(worlds, count):
    return np.linspace(0, 1, worlds * count * 3).reshape(worlds, count, 3).astype(np.float32)


def posed(vehicle_type, actors, model=None):
    """The draw list of actors, model m for actor m of each world if not told."""
    worlds, count = actors.yaw.shape
    rigs = rigs_of(vehicle_type, count)
    if model is None:
        own = own_models(vehicle_type)
        model = np.tile([own[a % len(own)] for a in range(count)], (worlds, 1))
    looks = Looks(model.astype(np.int32), colours(worlds, count))
    out = rigs.draw_list(worlds)
    rigs.pose(actors, looks, out)
    return out, looks.colour


def one(vehicle_type, model, **state):
    """Parts and poses of one actor, its fields given by name."""
    actors = ActorState.create(1, 1)
    actors.present[:] = True
    for name, value in state.items():
        getattr(actors, name)[:] = value
    out, _ = posed(vehicle_type, actors, np.array([[model]]))
    used = out.part[0] >= 0
    return out.part[0][used], out.pose[0][used].astype(np.float64)


def every_model():
    return [(vehicle_type, model) for vehicle_type in TYPES for model in own_models(vehicle_type)]


@pytest.mark.parametrize(("vehicle_type", "model"), every_model())
def test_wheels_stand_on_the_road_and_the_middle_is_behind_the_reference(vehicle_type, model):
    yaw, place = 0.7, np.array([30.0, -12.0])
    parts, poses = one(vehicle_type, model, position=[*place, 0.0], yaw=yaw)
    heading = np.array([np.cos(yaw), np.sin(yaw)])
    middle = place - 1.0 * heading  # the point that the original rewards
    assert poses[0, :2, 3] == pytest.approx(middle, abs=1e-5)
    assert poses[0, 2, 3] == 0.0
    lowest, ends = [], []
    for part, pose in zip(parts, poses, strict=True):
        world = library_of(vehicle_type).parts[part][0].positions @ pose[:, :3].T + pose[:, 3]
        ends += [(world[:, :2] @ heading).min(), (world[:, :2] @ heading).max()]
    for part, pose in wheels(vehicle_type, parts, poses):
        world = library_of(vehicle_type).parts[part][0].positions @ pose[:, :3].T + pose[:, 3]
        lowest.append(world[:, 2].min())
    assert len(lowest) >= 2
    assert lowest == pytest.approx(np.zeros(len(lowest)), abs=1e-5)
    assert (min(ends) + max(ends)) / 2 == pytest.approx(middle @ heading, abs=0.05)


@pytest.mark.parametrize(("vehicle_type", "model"), every_model())
def test_wheels_roll_without_slip(vehicle_type, model):
    step = 1e-3
    parts, before = one(vehicle_type, model, travelled=123.456)
    _, after = one(vehicle_type, model, travelled=123.456 + step, position=[step, 0.0, 0.0])
    assert after[0, 0, 3] - before[0, 0, 3] == pytest.approx(step, abs=1e-6)
    pairs = (wheels(vehicle_type, parts, poses) for poses in (before, after))
    for (_, a), (_, b) in zip(*pairs, strict=True):
        contact = a[:, :3].T @ [0.0, 0.0, -MODELS[model].rise]
        moved = b[:, :3] @ contact + b[:, 3] - a[:, :3] @ contact - a[:, 3]
        assert moved == pytest.approx(np.zeros(3), abs=1e-5)
        assert not np.allclose(a[:, :3], b[:, :3], atol=1e-4)


def steer_of(pose):
    """How far a wheel's axle is turned about the upward axis [rad]."""
    return np.arctan2(-pose[0, 1], pose[1, 1])


def test_front_wheels_steer_along_the_curve():
    model, speed, rate = own_models(VehicleType.PASSENGER)[0], 8.0, 0.5
    _, poses = one(VehicleType.PASSENGER, model, speed=speed, yaw_rate=rate, travelled=5.0)
    expected = np.arctan(MADE[MODELS[model].name].wheelbase * rate / speed)
    assert [steer_of(pose) for pose in poses] == pytest.approx([0, expected, expected, 0], abs=1e-6)
    assert expected > 0.1  # a left curve turns them to the left, which is counter-clockwise
    assert poses[1, 1, 3] > 0 > poses[2, 1, 3]


def test_steering_is_bounded_also_at_rest():
    model = own_models(VehicleType.PASSENGER)[0]
    for rate in (9.0, -9.0):
        _, poses = one(VehicleType.PASSENGER, model, speed=0.0, yaw_rate=rate)
        assert steer_of(poses[1]) == pytest.approx(np.sign(rate) * STEER_LIMIT, abs=1e-6)


@pytest.mark.parametrize(("rate", "lean"), [(0.1, 0.1), (3.0, LEAN_LIMIT), (-3.0, -LEAN_LIMIT)])
def test_two_wheelers_lean_into_the_curve_and_cars_do_not(rate, lean):
    bike = own_models(VehicleType.MOTORCYCLE)[1]
    _, poses = one(VehicleType.MOTORCYCLE, bike, speed=10.0, yaw_rate=rate)
    left, up = poses[0, 1, 2], poses[0, 2, 2]
    assert np.arctan2(left, up) == pytest.approx(lean, abs=1e-6)
    _, poses = one(VehicleType.PASSENGER, own_models(VehicleType.PASSENGER)[0], yaw_rate=rate)
    assert poses[0, 2, 2] == 1.0


@pytest.mark.parametrize("vehicle_type", TYPES)
def test_poses_are_rotations(vehicle_type):
    actors = random_actors(2, 6)
    out, _ = posed(vehicle_type, actors)
    rotation = out.pose[out.part >= 0][:, :, :3].astype(np.float64)
    unit = np.broadcast_to(np.eye(3), rotation.shape)
    assert rotation @ rotation.transpose(0, 2, 1) == pytest.approx(unit, abs=1e-5)
    assert np.linalg.det(rotation) == pytest.approx(np.ones(len(rotation)), abs=1e-5)


def random_actors(worlds, count):
    rng = np.random.default_rng(5)
    actors = ActorState.create(worlds, count)
    actors.position[..., :2] = rng.uniform(-200, 200, (worlds, count, 2))
    actors.yaw[:] = rng.uniform(-4, 4, (worlds, count))
    actors.speed[:] = rng.uniform(0, 20, (worlds, count))
    actors.yaw_rate[:] = rng.uniform(-1, 1, (worlds, count))
    actors.travelled[:] = rng.uniform(0, 9000, (worlds, count))
    actors.present[:] = True
    return actors


def test_absent_actors_have_empty_slots_and_come_back():
    actors = random_actors(2, 5)
    rigs = rigs_of(VehicleType.PASSENGER, 5)
    looks = Looks(np.zeros((2, 5), np.int32), np.ones((2, 5, 3), np.float32))
    out = rigs.draw_list(2)
    rigs.pose(actors, looks, out)
    full = out.part.copy()
    actors.present[1, 3] = False
    rigs.pose(actors, looks, out)
    window = slice(*rigs.first_slot[3:5])
    assert (out.part[1, window] == -1).all()
    assert (out.part != full).sum() == window.stop - window.start > 1
    actors.present[1, 3] = True
    rigs.pose(actors, looks, out)
    assert np.array_equal(out.part, full)


def test_models_with_fewer_wheels_leave_slots_empty_and_have_their_own_body():
    for vehicle_type in TYPES:
        actors = random_actors(1, 7)
        out, colour = posed(vehicle_type, actors)
        parts = out.part.reshape(7, -1)
        own = own_models(vehicle_type)
        assert len(set(parts[:, 0])) == len(own)
        assert parts.max() < len(library_of(vehicle_type).parts)
        for a in range(7):
            vehicle = MADE[MODELS[own[a % len(own)]].name]
            axles, bodies = vehicle.axles, 1 + vehicle.articulated
            wheels = sum(2 if axle.steered and axle.track else 1 for axle in axles)
            assert (parts[a] >= 0).sum() == bodies + wheels
            window = slice(a * parts.shape[1], (a + 1) * parts.shape[1])
            assert (out.object_id[0, window] == ACTOR_OBJECT + a).all()
            assert (out.colour[0, window] == colour[0, a]).all()


@pytest.mark.parametrize("vehicle_type", TYPES)
def test_no_point_of_a_vehicle_is_farther_than_its_reach(vehicle_type):
    library = library_of(vehicle_type)
    parts = np.array(
        [np.linalg.norm(levels[0].positions, axis=1).max() for levels in library.parts]
    )
    rigs = rigs_of(vehicle_type, 1)
    (reach,) = rigs.reach(parts)
    farthest = []
    count = len(own_models(vehicle_type))
    actors = random_actors(1, count)
    out, _ = posed(vehicle_type, actors)
    slots = out.part.shape[1] // count
    for slot in np.flatnonzero(out.part[0] >= 0):
        pose = out.pose[0, slot].astype(np.float64)
        points = library.parts[out.part[0, slot]][0].positions @ pose[:, :3].T + pose[:, 3]
        place = actors.position[0, slot // slots]
        farthest.append(np.linalg.norm(points - place, axis=1).max())
    assert 0.6 * reach < max(farthest) <= reach + 1e-4


def test_each_actor_has_the_slots_of_its_own_kind(walker):
    """A robot of many parts costs the cars beside it no slot."""
    robot = replace(walker, rig=lambda: walker.rig().__class__(25))
    register(robot)
    kind = np.array([kind_index(name) for name in ("passenger", "walker", "motorcycle")], np.int32)
    rigs = Rigs(np.concatenate([np.repeat(kind, [40, 1, 2]), kind]))
    slots = np.diff(rigs.first_slot)
    alone = [np.diff(Rigs(kind[k : k + 1]).first_slot)[0] for k in range(3)]
    assert alone[1] == 25
    assert slots.tolist() == [alone[0]] * 40 + [25] + [alone[2]] * 2 + alone
    assert rigs.draw_list(1).part.shape == (1, slots.sum())


@pytest.mark.slow
def test_a_mixed_world_is_posed_as_its_kinds_are_alone(walker):
    register(walker)
    names = ["bus", "walker", "passenger", "walker", "motorcycle", "passenger"]
    kind = np.array([kind_index(name) for name in names], np.int32)
    actors = random_actors(2, 6)
    actors.present[0, 3] = False
    model = np.tile([models_of(k).stop - 1 for k in kind], (2, 1)).astype(np.int32)
    looks = Looks(model, colours(2, 6))
    rigs = Rigs(kind)
    out = rigs.draw_list(2)
    rigs.pose(actors, looks, out)
    library = part_library(rigs.kinds)
    for a, name in enumerate(names):
        single = Rigs(kind[a : a + 1])
        alone = single.draw_list(2)
        alone.object_id[:] = ACTOR_OBJECT + a
        part_of = ActorState._make(array[:, a : a + 1].copy() for array in actors)
        single.pose(part_of, Looks(*(array[:, a : a + 1].copy() for array in looks)), alone)
        window = slice(*rigs.first_slot[a : a + 2])
        used = alone.part >= 0
        assert np.array_equal(out.part[:, window] >= 0, used), name
        assert np.array_equal(out.pose[:, window][used], alone.pose[used])
        assert np.array_equal(out.colour[:, window][used], alone.colour[used])
        assert (out.object_id[:, window] == ACTOR_OBJECT + a).all()
        own = part_library(single.kinds)
        for mixed, single_part in zip(out.part[:, window][used], alone.part[used], strict=True):
            there, here = library.parts[mixed][0], own.parts[single_part][0]
            assert np.array_equal(there.positions, here.positions), name
            assert library.lamps[mixed] == (name != "walker")


def test_classes_of_actors_are_those_of_their_kinds(walker):
    register(walker)
    names = ["walker", "trailer", "passenger", "motorcycle", "bus", "truck"]
    rigs = Rigs(np.array([kind_index(name) for name in names], np.int32))
    expected = ["PERSON", "TRUCK", "CAR", "MOTORCYCLE", "BUS", "TRUCK"]
    for row in rigs.draw_list(3).object_class:
        assert [ObjectClass(int(number)).name for number in row] == expected


@pytest.mark.parametrize(("vehicle_type", "model"), every_model())
def test_vehicles_stand_on_slopes(vehicle_type, model):
    """Wheels touch a road that rises by a tenth, at its height, and the nose points up."""
    slope, yaw, height = np.arctan(0.1), 0.7, 12.0
    parts, poses = one(
        vehicle_type, model, position=[30.0, -12.0, height], yaw=yaw, slope=slope, yaw_rate=0.0
    )
    along = np.array([np.cos(yaw), np.sin(yaw)])
    assert poses[0, :, 0] == pytest.approx([*(np.cos(slope) * along), np.sin(slope)], abs=1e-6)
    for part, pose in wheels(vehicle_type, parts, poses):
        world = library_of(vehicle_type).parts[part][0].positions @ pose[:, :3].T + pose[:, 3]
        road = height + 0.1 * ((world[:, :2] - [30.0, -12.0]) @ along)
        over = (world[:, 2] - road) * np.cos(slope)  # square to the road
        assert over.min() == pytest.approx(0.0, abs=2e-3)


def test_order_of_worlds_changes_no_byte():
    actors = random_actors(4, 9)
    out, _ = posed(VehicleType.PASSENGER, actors)
    order = [2, 0, 3, 1]
    shuffled = ActorState._make(array[order].copy() for array in actors)
    again, _ = posed(VehicleType.PASSENGER, shuffled)
    assert np.array_equal(out.part[order], again.part)
    assert np.array_equal(out.pose[order], again.pose)


def test_a_vehicle_keeps_its_variant_wherever_a_list_has_it():
    kind = np.full(8, kind_index("passenger"), np.int32)
    actors = random_actors(1, 8)
    model = np.full((1, 8), models_of(kind[0]).start, np.int32)
    rigs = Rigs(kind)
    out, turned = rigs.draw_list(1), rigs.draw_list(1)
    rigs.pose(actors, Looks(model, colours(1, 8)), out)
    turned.object_id[:] = out.object_id.reshape(8, -1)[::-1].reshape(1, -1)
    rigs.pose(actors, Looks(model, colours(1, 8)), turned)
    bodies = out.part.reshape(8, -1)[:, 0]
    assert len({*bodies.tolist()}) == 4
    assert np.array_equal(turned.part.reshape(8, -1)[::-1, 0], bodies)
