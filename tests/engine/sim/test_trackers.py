"""Flown drones and cars in a simulation: what ends, rewards, sensors and others make of them."""

import math

import numpy as np
import pytest

from eyas.engine.camera.config import MountConfig
from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.task.config import DoneConfig, StartConfig
from eyas.engine.task.done import DoneReason
from eyas.engine.trackers.config import TrackerConfig

FLOWN, CAR = TrackerConfig(supervised=False), TrackerConfig(kind="car")
REST = StartConfig(pitch=1.37, height=22.0, velocity="rest")


def simulation_of(config, tracker, world_of=None, **changes):
    config = config.model_copy(update={"tracker": tracker, **changes})
    simulation = build_simulation(config, each_alone(2) if world_of is None else world_of)
    simulation.reset()
    return simulation


def test_a_drone_that_cannot_keep_up_with_its_commands_ends_by_its_distance(config):
    simulation = simulation_of(config, FLOWN, start=REST)
    fast, slow = [40.0, 0.0, 0.0, 0.0], [5.0, 0.0, 0.0, 0.0]
    reasons = [simulation.advance(np.array([fast, slow]), 25).reason for _ in range(40)]
    ended = [row[0] for row in reasons].index(DoneReason.DISTANCE)
    # 40 t - g tan(pi / 5) t^2 / 2 is 50 m at 1.4 s; it has to tilt first.
    assert 1.25 < (ended + 1) * 0.05 < 1.45
    assert {row[1] for row in reasons} == {DoneReason.NONE}
    assert simulation.packets()[1][0, 58] == 1.0  # `crash`, as in the original


def test_a_supervised_drone_never_does(config):
    simulation = simulation_of(config, TrackerConfig())
    result = simulation.advance(np.tile([40.0, 0.0, 0.0, 0.0], (2, 1)), 1000)
    assert DoneReason.DISTANCE not in result.reason


def test_the_sensors_of_a_flown_drone_feel_its_thrust_and_its_turning(config):
    simulation = simulation_of(config, FLOWN)
    trackers = simulation.snapshot.trackers
    for command in ([8.0, 0.0, 0.0, 0.0], [0.0, -8.0, 0.0, 1.0], [-40.0, 0.0, 0.004, -2.0]):
        for _ in range(12):
            simulation.advance(np.tile(command, (2, 1)), 4)
            basic = simulation.packets()[0]
            # Rotors pull along the body's own axis, and nothing else is felt.
            assert np.abs(basic[:, 7:9]).max() < 0.1
            upright = np.cos(trackers.euler[:, 0]) * np.cos(trackers.euler[:, 1])
            pull = (trackers.acceleration[:, 2] + 9.81) / upright
            assert basic[:, 9] == pytest.approx(pull, abs=0.1)
            assert np.array_equal(basic[:, 10:13], trackers.angular_velocity)
            assert np.array_equal(basic[:, 4:7], trackers.velocity)


def test_the_same_commands_begin_the_same_in_both_modes(config):
    commands = np.tile([2.0, -1.0, 0.001, 0.5], (2, 1))
    ends = []
    for tracker in (TrackerConfig(), FLOWN):
        simulation = simulation_of(config, tracker, start=REST)
        simulation.advance(commands, 40)
        ends.append(simulation.snapshot.trackers)
    supervised, flown = ends
    # The same command path: what differs is the heading that the flown body has by then.
    assert flown.commanded_yaw == pytest.approx(supervised.commanded_yaw, abs=1e-12)
    assert flown.commanded_position == pytest.approx(supervised.commanded_position, abs=5e-3)
    assert not np.array_equal(flown.position, supervised.position)


def test_gentle_flying_keeps_the_target_in_view_as_long_as_a_supervised_drone(config):
    simulation = simulation_of(config, FLOWN)
    simulation.carry(200)
    carried = simulation.snapshot.episodes.reward.copy()
    assert carried.min() > 0.9
    assert not simulation.snapshot.trackers.euler[:, :2].any()


@pytest.mark.parametrize("direction", [0.0, 2.0])
def test_a_flown_drone_begins_as_fast_as_its_target_and_keeps_it_where_it_is(config, direction):
    start = config.start.model_copy(update={"direction": direction})
    simulation = simulation_of(config, FLOWN, each_alone(8), start=start)
    trackers, _, targets, episodes, _ = simulation.snapshot
    simulation.advance(np.full((8, 4), 2.0), 40)
    simulation.reset()  # the second episode begins like the first
    way = np.stack([np.cos(targets.yaw), np.sin(targets.yaw)], 1)
    assert trackers.velocity[:, :2] == pytest.approx(targets.speed[:, None] * way)
    assert targets.speed.max() > 9.0
    assert not trackers.velocity[:, 2].any()
    # No sensor feels a jolt, and the target stands still in view.
    basic, _ = simulation.packets()
    assert basic[:, 4:6] == pytest.approx(targets.speed[:, None] * way)
    assert basic[:, 7:10] == pytest.approx(np.tile([0.0, 0.0, 9.81], (8, 1)), abs=1e-6)
    commands = np.zeros((8, 4))
    commands[:, 0] = np.cos(direction) * targets.speed
    commands[:, 1] = -np.sin(direction) * targets.speed
    simulation.advance(commands, 100)
    assert episodes.reward.min() > 0.6


def test_at_rest_as_in_the_original_it_falls_behind(config):
    at_rest = simulation_of(config, FLOWN, each_alone(8), start=REST)
    assert not at_rest.snapshot.trackers.velocity.any()
    # Nothing else begins otherwise; what follows its commands at once has no velocity to keep.
    going = simulation_of(config, FLOWN, each_alone(8))
    for name in ("position", "orientation", "gimbal", "euler"):
        there = [getattr(s.snapshot.trackers, name) for s in (at_rest, going)]
        assert there[0] == pytest.approx(there[1], abs=1e-12)
    commands = np.zeros((8, 4))
    commands[:, 0] = going.snapshot.targets.speed
    fast = commands[:, 0] > 8.0
    for simulation in (at_rest, going):
        simulation.advance(commands, 400)
    behind, beside = (s.snapshot.episodes.reward[fast] for s in (at_rest, going))
    assert beside.mean() > behind.mean() + 0.5
    for tracker in (TrackerConfig(), CAR):
        simulation = simulation_of(config, tracker)
        assert not simulation.snapshot.trackers.velocity.any()


def test_others_see_it_tilted_in_a_shared_world(config):
    simulation = simulation_of(config, FLOWN, together(2), start=REST, same_target=True)
    trackers, cameras = simulation.snapshot.trackers, simulation.snapshot.cameras
    seen = {}
    for name, command in (("level", [0.0] * 4), ("tilted", [40.0, 0.0, 0.0, 0.0])):
        simulation.reset()
        simulation.advance(np.tile(command, (2, 1)), 100)
        # Camera 1 looks at drone 0 from 2 m behind it, along its heading.
        yaw = trackers.euler[0, 2]
        ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
        left = np.array([-ahead[1], ahead[0], 0.0])
        cameras.position[1] = trackers.position[0] - 2.0 * ahead
        cameras.rotation[1] = np.column_stack([ahead, left, [0.0, 0.0, 1.0]])
        picture = Picture.create(1, 96, 128, object_id=True)
        simulation.draw(np.array([1], np.int32), picture)
        rows, _ = np.nonzero(picture.object_id[0] >= 65536 + simulation.actors)
        seen[name] = np.ptp(rows)
    assert seen["tilted"] > 1.3 * seen["level"] > 0


def test_a_car_is_rewarded_by_1_and_only_its_time_ends_it(config):
    simulation = simulation_of(config, CAR, done=DoneConfig(total_steps=600, no_reward_steps=50))
    result = simulation.advance(np.array([[40.0, 0.0, -0.5, 3.0], [0.0, 0.0, 0.5, 0.0]]), 599)
    assert result.reward.tolist() == [1.0, 1.0]
    assert result.reason.tolist() == [DoneReason.NONE] * 2
    assert simulation.snapshot.trackers.position[0, 2] == pytest.approx(-0.1)  # on the ground
    last = simulation.advance(np.zeros((2, 4)))
    assert last.reason.tolist() == [DoneReason.STEP_LIMIT] * 2


def test_a_car_may_be_judged_like_a_drone_and_a_drone_like_a_car(config):
    judged = simulation_of(config, CAR.model_copy(update={"judged": True}))
    far = judged.advance(np.tile([0.0, 0.0, -0.5, 0.0], (2, 1)), 200)
    assert far.reason.tolist() == [DoneReason.HEIGHT] * 2
    assert far.reward.max() < 1.0
    free = simulation_of(config, TrackerConfig(judged=False))
    far = free.advance(np.tile([0.0, 0.0, 0.5, 0.0], (2, 1)), 200)
    assert far.reason.tolist() == [DoneReason.NONE] * 2
    assert far.reward.tolist() == [1.0, 1.0]


def test_a_car_is_not_seen_by_others(config):
    simulation = simulation_of(config, CAR, together(2), same_target=True)
    picture = Picture.create(2, 48, 64, object_id=True)
    simulation.draw(np.arange(2, dtype=np.int32), picture)
    assert picture.object_id.max() < 65536 + simulation.actors


def test_wind_differs_from_episode_to_episode_and_repeats_with_the_seed(config):
    wind = {"speed": {"uniform": [3.0, 9.0]}, "direction": {"uniform": [-3.1, 3.1]}}
    windy = TrackerConfig(supervised=False, drag_area=0.05, wind={**wind, "turbulence": 10.0})

    def drift(simulation):
        simulation.reset()
        before = simulation.snapshot.trackers.position.copy()
        simulation.advance(np.zeros((2, 4)), 400)
        return simulation.snapshot.trackers.position - before

    simulation = simulation_of(config, windy)
    first, second = drift(simulation), drift(simulation)
    assert np.abs(first[:, :2]).min() > 1e-3
    assert not np.allclose(first, second, atol=1e-3)
    simulation.reseed(config.seed)
    simulation.reset()
    assert np.array_equal(drift(simulation), first)


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"wind": {"speed": 3.0}}, "drag_area: 0.0 is not allowed: must be above 0 with wind"),
        ({"drag_area": 0.1}, "drag_area: 0.1 is not allowed: must be off unless the drone is"),
        ({"kind": "car", "ground_contact": True}, "ground_contact: true is not allowed: must be"),
        ({"supervised": False, "drag_area": -1.0}, "drag_area: -1.0 is not allowed: a number from"),
        ({"wind": {"turbulence": 99.0}}, "wind.turbulence: 99.0 is not allowed: a number from 0"),
        ({"wind": {"gusts": 1.0}}, "wind.gusts: unknown key"),
    ],
)
def test_settings_without_effect_or_out_of_range_are_told_in_one_line(values, line):
    with pytest.raises(ConfigError) as caught:
        TrackerConfig(**values)
    assert str(caught.value).startswith(line)


@pytest.mark.slow
def test_a_fixed_camera_is_carried_by_the_body_and_tilts_with_it(config):
    camera = config.camera.model_copy(
        update={"mount": MountConfig(x=0.2, y=-0.1, z=0.3, pitch=1.37)}
    )
    simulation = simulation_of(config, FLOWN, camera=camera, start=REST)
    trackers, cameras = simulation.snapshot.trackers, simulation.snapshot.cameras
    begun = simulation.snapshot.episodes.reward.copy()
    assert begun.min() > 0.9  # as with a gimbal: the target is in the middle
    down = []
    for _ in range(2):
        yaw, pitch = trackers.euler[:, 2], trackers.euler[:, 1]
        ahead = np.stack([np.cos(yaw), np.sin(yaw), 0 * yaw], 1)
        left, up = np.stack([-ahead[:, 1], ahead[:, 0], 0 * yaw], 1), [0.0, 0.0, 1.0]
        sine, cosine = np.sin(pitch)[:, None], np.cos(pitch)[:, None]
        nose, top = cosine * ahead - sine * up, sine * ahead + cosine * np.array(up)
        place = trackers.position + 0.2 * nose - 0.1 * left + 0.3 * top
        assert cameras.position == pytest.approx(place, abs=2e-3)
        assert cameras.rotation[:, 2, 0] == pytest.approx(-np.sin(1.37 + pitch), abs=1e-3)
        down.append(cameras.rotation[:, 2, 0].copy())
        assert simulation.packets()[1][:, 4] == pytest.approx([1.37] * 2)
        simulation.advance(np.tile([9.0, 0.0, 0.0, 0.0], (2, 1)), 60)
    assert np.abs(down[1] - down[0]).min() > 0.005
    turned = simulation_of(
        config, CAR, camera=config.camera.model_copy(update={"mount": MountConfig(yaw=0.5)})
    )
    assert turned.snapshot.cameras.position == pytest.approx(turned.snapshot.trackers.position)
    direction = turned.snapshot.trackers.euler[:, 2] + 0.5
    assert turned.snapshot.cameras.rotation[:, 0, 0] == pytest.approx(np.cos(direction))
