import numpy as np
import pytest

from eyas.state.draw import DrawList
from eyas.state.motion import ActorState
from eyas.state.scene import ACTOR_OBJECT
from eyas.targets.catalogue import VEHICLES, models_of
from eyas.targets.rig import LEAN_LIMIT, STEER_LIMIT, build_rigs
from eyas.traffic.config import VehicleType

RIGS = {vehicle_type: build_rigs(vehicle_type) for vehicle_type in VehicleType}
TYPES = list(VehicleType)


def posed(vehicle_type, actors, model=None):
    """The draw list of actors, model m for actor m of each world if not told."""
    rigs = RIGS[vehicle_type]
    worlds, count = actors.yaw.shape
    if model is None:
        own = models_of(vehicle_type)
        model = np.tile([own[a % len(own)] for a in range(count)], (worlds, 1))
    colour = np.linspace(0, 1, worlds * count * 3).reshape(worlds, count, 3).astype(np.float32)
    out = DrawList.create(worlds, count * rigs.slots_per_actor)
    rigs.pose(actors, model.astype(np.int32), colour, out)
    return out, colour


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
    return [(vehicle_type, model) for vehicle_type in TYPES for model in models_of(vehicle_type)]


@pytest.mark.parametrize(("vehicle_type", "model"), every_model())
def test_wheels_stand_on_the_road_and_the_middle_is_behind_the_reference(vehicle_type, model):
    yaw, place = 0.7, np.array([30.0, -12.0])
    parts, poses = one(vehicle_type, model, position=[*place, 0.0], yaw=yaw)
    heading = np.array([np.cos(yaw), np.sin(yaw)])
    middle = place - 1.0 * heading  # the point that the original rewards
    assert poses[0, :2, 3] == pytest.approx(middle, abs=1e-5)
    assert poses[0, 2, 3] == 0.0
    lowest = []
    ends = []
    for part, pose in zip(parts, poses, strict=True):
        world = RIGS[vehicle_type].library.parts[part][0].positions @ pose[:, :3].T + pose[:, 3]
        lowest.append(world[:, 2].min())
        ends += [(world[:, :2] @ heading).min(), (world[:, :2] @ heading).max()]
    assert lowest[1:] == pytest.approx(np.zeros(len(lowest) - 1), abs=1e-5)
    assert (min(ends) + max(ends)) / 2 == pytest.approx(middle @ heading, abs=0.05)


@pytest.mark.parametrize(("vehicle_type", "model"), every_model())
def test_wheels_roll_without_slip(vehicle_type, model):
    step = 1e-3
    _, before = one(vehicle_type, model, travelled=123.456)
    _, after = one(vehicle_type, model, travelled=123.456 + step, position=[step, 0.0, 0.0])
    assert after[0, 0, 3] - before[0, 0, 3] == pytest.approx(step, abs=1e-6)
    for a, b in zip(before[1:], after[1:], strict=True):
        contact = a[:, :3].T @ [0.0, 0.0, -VEHICLES[model].wheel_radius]
        moved = b[:, :3] @ contact + b[:, 3] - a[:, :3] @ contact - a[:, 3]
        assert moved == pytest.approx(np.zeros(3), abs=1e-5)
        assert not np.allclose(a[:, :3], b[:, :3], atol=1e-4)


def steer_of(pose):
    """How far a wheel's axle is turned about the upward axis [rad]."""
    return np.arctan2(-pose[0, 1], pose[1, 1])


def test_front_wheels_steer_along_the_curve():
    model, speed, rate = models_of(VehicleType.PASSENGER)[0], 8.0, 0.5
    _, poses = one(VehicleType.PASSENGER, model, speed=speed, yaw_rate=rate, travelled=5.0)
    expected = np.arctan(VEHICLES[model].wheelbase * rate / speed)
    assert [steer_of(pose) for pose in poses] == pytest.approx([0, expected, expected, 0], abs=1e-6)
    assert expected > 0.1  # a left curve turns them to the left, which is counter-clockwise
    assert poses[1, 1, 3] > 0 > poses[2, 1, 3]


def test_steering_is_bounded_also_at_rest():
    model = models_of(VehicleType.PASSENGER)[0]
    for rate in (9.0, -9.0):
        _, poses = one(VehicleType.PASSENGER, model, speed=0.0, yaw_rate=rate)
        assert steer_of(poses[1]) == pytest.approx(np.sign(rate) * STEER_LIMIT, abs=1e-6)


@pytest.mark.parametrize(("rate", "lean"), [(0.1, 0.1), (3.0, LEAN_LIMIT), (-3.0, -LEAN_LIMIT)])
def test_two_wheelers_lean_into_the_curve_and_cars_do_not(rate, lean):
    bike = models_of(VehicleType.MOTORCYCLE)[1]
    _, poses = one(VehicleType.MOTORCYCLE, bike, speed=10.0, yaw_rate=rate)
    left, up = poses[0, 1, 2], poses[0, 2, 2]
    assert np.arctan2(left, up) == pytest.approx(lean, abs=1e-6)
    _, poses = one(VehicleType.PASSENGER, models_of(VehicleType.PASSENGER)[0], yaw_rate=rate)
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
    rigs = RIGS[VehicleType.PASSENGER]
    model = np.zeros((2, 5), np.int32)
    colour = np.ones((2, 5, 3), np.float32)
    out = DrawList.create(2, 5 * rigs.slots_per_actor + 3)
    rigs.pose(actors, model, colour, out)
    full = out.part.copy()
    actors.present[1, 3] = False
    rigs.pose(actors, model, colour, out)
    first = 3 * rigs.slots_per_actor
    assert (out.part[1, first : first + rigs.slots_per_actor] == -1).all()
    assert (out.part != full).sum() == rigs.slots_per_actor
    actors.present[1, 3] = True
    rigs.pose(actors, model, colour, out)
    assert np.array_equal(out.part, full)
    assert (out.part[:, -3:] == -1).all()


def test_models_with_fewer_wheels_leave_slots_empty_and_have_their_own_body():
    for vehicle_type in TYPES:
        actors = random_actors(1, 7)
        out, colour = posed(vehicle_type, actors)
        slots = RIGS[vehicle_type].slots_per_actor
        parts = out.part.reshape(7, slots)
        own = models_of(vehicle_type)
        assert len(set(parts[:, 0])) == len(own)
        assert parts.max() < len(RIGS[vehicle_type].library.parts)
        for a in range(7):
            axles = VEHICLES[own[a % len(own)]].axles
            wheels = sum(2 if axle.steered and axle.track else 1 for axle in axles)
            assert (parts[a] >= 0).sum() == 1 + wheels
            window = slice(a * slots, (a + 1) * slots)
            assert (out.object_id[0, window] == ACTOR_OBJECT + a).all()
            assert (out.colour[0, window] == colour[0, a]).all()


def test_order_of_worlds_changes_no_byte():
    actors = random_actors(4, 9)
    out, _ = posed(VehicleType.PASSENGER, actors)
    order = [2, 0, 3, 1]
    shuffled = ActorState(
        actors.position[order].copy(), *(
            getattr(actors, name)[order].copy()
            for name in ("yaw", "slope", "speed", "yaw_rate", "travelled", "present")
        )
    )  # fmt: skip
    again, _ = posed(VehicleType.PASSENGER, shuffled)
    assert np.array_equal(out.part[order], again.part)
    assert np.array_equal(out.pose[order], again.pose)
