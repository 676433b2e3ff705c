"""What cameras with a rate, a delay and missing pictures show, and the lidar under a latency."""

import numpy as np
import pytest

from eyas.engine.camera.config import MountConfig
from eyas.engine.envs.observation import Observer
from eyas.engine.sensors.config import CameraErrors, LidarConfig, SensorsConfig
from eyas.engine.settings.env import ObservationConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import ControlConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.task.config import StartConfig
from eyas.engine.trackers.config import TrackerConfig

FORWARD = np.tile([9.0, -2.0, 0.004, 0.7], (2, 1))
EVERY = np.arange(2, dtype=np.int32)


def simulation_of(config, late=0.0, **camera):
    """Two trackers with such a camera."""
    sensors, control = SensorsConfig(camera=CameraErrors(**camera)), ControlConfig()
    control = ControlConfig(observation_latency_steps=late)
    changes = {"sensors": sensors, "control": control, "lidar": LidarConfig(enabled=True)}
    simulation = build_simulation(config.model_copy(update=changes), each_alone(2))
    simulation.reset()
    return simulation


def exposures(simulation, steps=80):
    """The step that the pictures show after each physics step, shape (steps + 1, 2)."""
    shown, seen = simulation.view.state.shown.episodes.step_count, []
    seen.append(shown.copy())
    for _ in range(steps):
        simulation.advance(FORWARD)
        seen.append(shown.copy())
    return np.array(seen)


@pytest.mark.parametrize(
    ("camera", "late", "expected"),
    [
        ({}, 0.0, lambda step: step),
        ({"rate": 50.0}, 0.0, lambda step: step // 10 * 10),
        ({"delay_steps": 7}, 0.0, lambda step: step - 7),
        ({"delay_steps": 7, "rate": 50.0}, 0.0, lambda step: (step - 7) // 10 * 10),
        ({"delay_steps": 7, "rate": 50.0}, 5.0, lambda step: (step - 12) // 10 * 10),
    ],
)
def test_pictures_show_the_last_exposure_of_so_long_ago(config, camera, late, expected):
    shown = exposures(simulation_of(config, late, **camera))
    steps = np.maximum(expected(np.arange(81)), 0)
    assert shown.tolist() == np.stack([steps, steps], 1).tolist()


def test_a_missing_picture_is_replaced_by_the_last(config):
    simulation = simulation_of(config, rate=250.0, drop_out=0.3)
    first = exposures(simulation, 400)
    taken = np.diff(first, axis=0)[1::2] > 0
    assert 1 - taken.mean() == pytest.approx(0.3, abs=0.06)
    assert not np.array_equal(taken[:, 0], taken[:, 1])
    simulation.reseed(0)
    simulation.reset()
    second = exposures(simulation, 400)
    assert np.array_equal(first, second)
    simulation.reset()
    other = exposures(simulation, 400)
    for tracker in range(2):
        assert not np.array_equal(first[:, tracker], other[:, tracker])


def test_a_reset_of_one_is_no_exposure_of_another(config):
    for camera in ({"rate": 50.0}, {"rate": 50.0, "delay_steps": 3}):
        simulation = simulation_of(config, **camera)
        shown = exposures(simulation, 17)[-1].copy()
        simulation.reset(np.array([True, False]))
        seen = simulation.view.state.shown.episodes.step_count
        assert seen.tolist() == [0, shown[1]]
        simulation.advance(FORWARD)
        assert seen.tolist() == [0, shown[1]]


def test_only_pictures_are_late_and_they_are_whole(config):
    late, now = simulation_of(config, delay_steps=8), simulation_of(config)
    then = None
    for _ in range(4):
        pictures = [Picture.create(2, 24, 32, depth=True) for _ in range(3)]
        late.view.draw(EVERY, pictures[0])
        now.view.draw(EVERY, pictures[1])
        if then is not None:
            for name in ("rgb", "depth"):
                assert np.array_equal(getattr(pictures[0], name), getattr(then, name))
        late.draw(EVERY, pictures[2])
        assert np.array_equal(pictures[2].rgb, pictures[1].rgb)  # the truth is on time
        for ours, theirs in zip(late.view.packets(), now.view.packets(), strict=True):
            assert np.array_equal(ours, theirs)
        then = pictures[1]
        for simulation in (late, now):
            simulation.advance(FORWARD, 8)


def test_the_lidar_that_agents_see_is_as_late_as_the_rest(config):
    low = config.model_copy(
        update={"start": config.start.model_copy(update={"height": 1.0, "horizontal_bias": 4.0})}
    )
    late, now = simulation_of(low, 8.0), simulation_of(low)
    sight = ObservationConfig(parts=("lidar",))
    observers = Observer(sight, late), Observer(sight, now)
    begun, before = np.zeros(2, np.bool_), None
    for _ in range(6):
        for observer in observers:
            observer.look(EVERY, begun)
        seen, present = (np.stack([o.one(n) for n in range(2)]) for o in observers)
        if before is not None:
            assert np.array_equal(seen, before)
        before = present
        assert np.array_equal(late.view.lidar.ranges(), now.view.lidar.ranges())
        for simulation in (late, now):
            simulation.advance(FORWARD, 8)
    assert (seen != present).any()


def test_a_cars_lidar_is_where_the_originals_is(config):
    low = {"start": config.start.model_copy(update={"height": 1.0, "horizontal_bias": 4.0})}

    def ranges(tracker, mount=None):
        lidar = LidarConfig(enabled=True, noise=0.0, resolution=0.0, mount=mount)
        settings = config.model_copy(update={**low, "lidar": lidar, "tracker": tracker})
        simulation = build_simulation(settings, each_alone(4))
        simulation.reset()
        return simulation.view.lidar.ranges()

    car, drone = TrackerConfig(kind="car"), TrackerConfig()
    assert np.isfinite(ranges(car)).any()
    assert np.array_equal(ranges(car), ranges(car, MountConfig(x=-0.1)))
    assert not np.array_equal(ranges(car), ranges(drone))
    assert np.array_equal(ranges(drone), ranges(drone, MountConfig(z=0.031)))


def test_the_words_for_a_target_are_those_of_what_is_shown(config):
    wide = config.camera.model_copy(update={"field_of_view": 2.0})
    changes = {"camera": wide, "start": StartConfig(height=60.0, pitch=1.0)}
    changes["done"] = config.done.model_copy(update={"total_steps": 3000, "max_height": 100.0})
    sims = []
    for late in (0.0, 500.0):
        control = ControlConfig(observation_latency_steps=late)
        settings = config.model_copy(update={**changes, "control": control})
        sims.append(build_simulation(settings, each_alone(12)))
        sims[-1].reset()
    now, late = ([] for _ in sims)
    for _ in range(6):
        for words, simulation in zip((now, late), sims, strict=True):
            words.append([simulation.view.words(n, 0.75) for n in range(12)])
            simulation.carry(500)
    assert late[1:] == now[:-1]
    assert now[1:] != now[:-1]
