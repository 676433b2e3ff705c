"""Lidar, contacts and errors of sensors in a simulation."""

import numpy as np
import pytest

from eyas.engine.envs.information import information, of_one
from eyas.engine.sensors.config import CameraErrors, LidarConfig, ReadingConfig, SensorsConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import DRONE_CLASS, ObjectClass
from eyas.engine.task.config import Crash, StartConfig
from eyas.engine.task.done import DoneReason
from eyas.engine.trackers.config import TrackerConfig

ALL = {
    "lidar": LidarConfig(enabled=True),
    "sensors": SensorsConfig(
        gps_position=ReadingConfig(noise=1.0, rate=10.0), imu=ReadingConfig(noise=0.01, bias=0.01)
    ),
}


def sensing(config, crash=Crash.CONTACT, **others):
    """The settings with every sense on."""
    done = config.done.model_copy(update={"crash": crash, "min_height": -100.0})
    return config.model_copy(update={**ALL, "done": done, **others})


def started(config, count=2, world_of=each_alone):
    simulation = build_simulation(config, world_of(count))
    simulation.reset()
    return simulation


def drawn(simulation):
    picture = Picture.create(simulation.count, 48, 64)
    simulation.draw(np.arange(simulation.count, dtype=np.int32), picture)
    return picture.rgb


def test_senses_change_nothing_but_what_is_sensed(config, assets):
    plain, sensed = started(config), started(sensing(config))
    command = np.array([[9.0, -3.0, 0.0, 0.4]] * 2)
    for simulation in (plain, sensed):
        for _ in range(20):
            simulation.advance(command, 4)
    for ours, theirs in zip(plain.snapshot, sensed.snapshot, strict=True):
        for name in getattr(ours, "_fields", ()):
            np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), name)
    np.testing.assert_array_equal(drawn(plain), drawn(sensed))
    basic, reward = plain.packets()
    felt, same = sensed.packets()
    np.testing.assert_array_equal(reward, same)
    np.testing.assert_array_equal(np.delete(basic, [1, 2, 3, *range(13, 20)], 1),
                                  np.delete(felt, [1, 2, 3, *range(13, 20)], 1))  # fmt: skip
    assert (basic[:, 1:4] != felt[:, 1:4]).all()


def test_what_is_sensed_depends_on_seed_and_tracker_only(config, assets):
    # Beside its target, 1 m above the road.
    start = StartConfig(height=1.0, pitch=1.5, horizontal_bias=4.0)
    low = sensing(config, start=start)

    def seen(count, chunks):
        simulation = started(low, count)
        command = np.zeros((count, 4))
        command[0] = 6.0, 2.0, 0.0, 0.5
        for steps in chunks:
            simulation.advance(command, steps)
        lidar = simulation.view.lidar
        return lidar.ranges()[0], lidar.packets()[0], simulation.packets()[0][0]

    first = seen(1, [4] * 30)
    assert np.isfinite(first[0]).any()
    for other in (seen(1, [4] * 30), seen(7, [4] * 30), seen(1, [1, 7, 52, 60])):
        for ours, theirs in zip(first, other, strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_a_drone_that_sinks_onto_its_target_crashes_into_it(config, assets):
    low = sensing(config, Crash.END, start=StartConfig(height=3.0, pitch=1.5))
    simulation = started(low, 1)
    simulation.snapshot.episodes.start_offset[:, :2] = 0.0
    offset, episodes = simulation.snapshot.episodes.start_offset, simulation.snapshot.episodes
    while not episodes.crash[0]:
        offset[0, 2] -= 0.005
        simulation.carry(1)
        assert offset[0, 2] > 0.0
    target = simulation.snapshot.targets
    top = target.size[0, 2] - target.rise[0]  # above the reference point
    assert offset[0, 2] - 0.183 == pytest.approx(top, abs=0.02)
    assert episodes.contact_object[0] == 65536 + target.actor[0]
    assert simulation.classes_of(episodes.contact_object).tolist() == [ObjectClass.CAR]
    result = simulation.carry(100)
    assert result.reason.tolist() == [DoneReason.CRASH]
    simulation.reset()
    assert not episodes.crash.any()
    assert episodes.contact_object.tolist() == [-1]


def test_trackers_of_one_world_and_those_that_wait_are_sensed_too(config, assets):
    shared = started(sensing(config, start=StartConfig(height=4.0)), 3, together)
    shared.advance(np.zeros((3, 4)), 8)
    assert shared.view.lidar.ranges().shape == (3, 400)
    alone = started(sensing(config, start=StartConfig(height=4.0)), 2)
    before = alone.view.lidar.ranges()[1]
    alone.advance(np.full((2, 4), 3.0), 40, np.array([True, False]))
    np.testing.assert_array_equal(alone.view.lidar.ranges()[1], before)


def test_noise_of_the_camera_is_only_in_its_pictures(config, assets):
    noisy = config.model_copy(update={"sensors": SensorsConfig(camera=CameraErrors(noise=5.0))})
    clean, grain = drawn(started(config)).astype(int), drawn(started(noisy)).astype(int)
    assert (grain - clean).std() == pytest.approx(5.0, rel=0.1)
    assert np.array_equal(grain, drawn(started(noisy)))


def test_drones_of_a_shared_world_crash_into_each_other(config, assets):
    shared = started(sensing(config, Crash.END, same_target=True), 2, together)
    trackers, episodes = shared.snapshot.trackers, shared.snapshot.episodes
    # Onto the other one, in an instant: where it is told to be is where it is.
    trackers.position[1] = trackers.commanded_position[1] = trackers.position[0] + [0.5, 0, 0.1]
    result = shared.advance(np.zeros((2, 4)), 101)
    assert result.reason.tolist() == [DoneReason.CRASH] * 2
    others = [65536 + shared.actors + 1, 65536 + shared.actors]
    assert episodes.contact_object.tolist() == others
    assert shared.classes_of(episodes.contact_object).tolist() == [DRONE_CLASS] * 2
    info = of_one(information(shared), 0)
    assert info["contact_class"] == "drone"
    # Cars have no bodies.
    car = config.model_copy(update={"tracker": TrackerConfig(kind="car")})
    cars = started(sensing(car, Crash.CONTACT, same_target=True), 2, together)
    cars.snapshot.trackers.commanded_position[1] = cars.snapshot.trackers.position[0]
    cars.advance(np.zeros((2, 4)), 4)
    assert 65536 + cars.actors not in cars.snapshot.episodes.contact_object
