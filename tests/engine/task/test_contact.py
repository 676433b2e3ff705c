"""Contacts of the body with walls, poles, the ground and vehicles."""

import numpy as np
import pytest

from eyas.engine.sensors.bodies import BODY
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.catalogue import MODELS, kind_of, model_index
from eyas.engine.task.contact import Contacts
from eyas.engine.task.done import DoneReason

HALF, HIGH = BODY[0] / 2, BODY[2] / 2
WALL = ([(5.0, -3.0), (5.01, -3.0), (5.01, 3.0), (5.0, 3.0)], 0.0, 9.0)


class Flight:
    """Trackers that are moved by hand, and their contacts."""

    def __init__(self, world, *, ends=False, grace_steps=0):
        self.snapshot, obstacles = world
        self.trackers, self.episodes = self.snapshot.trackers, self.snapshot.episodes
        self.active = np.ones(len(self.episodes.tick), np.bool_)
        self.contacts = Contacts(self.snapshot, obstacles, self.active, grace_steps, ends=ends)
        for tracker in range(len(self.active)):
            self.contacts.begin(tracker, np.random.default_rng(0))

    def step(self, *motion, command=True):
        """Move all by one physics step; return whether the first has crashed."""
        if command:
            self.contacts.renew()
        self.trackers.position[self.active] += motion
        self.episodes.step_count[self.active] += 1
        self.episodes.tick[self.active] += 1
        self.contacts.advance()
        return bool(self.episodes.crash[0])


@pytest.mark.parametrize("speed", [1.0, 40.0, 5000.0])
def test_a_wall_is_hit_at_any_speed_where_it_stands(around, speed):
    flight = Flight(around((0.0, 0.5, 5.0, 0.0), prisms=[WALL]))
    steps = 0
    while not flight.step(speed * 0.002, 0.0, 0.0):
        steps += 1
        assert flight.episodes.contact_object[0] == -1
    # Not a step too early or late.
    assert steps == int((5.0 - HALF) / (speed * 0.002))
    assert flight.episodes.contact[0, 0] == pytest.approx(5.0)
    assert abs(flight.episodes.contact[0, 1] - 0.5) <= HALF + 1e-9
    assert flight.episodes.contact[0, 2] == pytest.approx(5.0)
    assert flight.episodes.contact_object[0] == 1


def test_one_flies_over_a_wall_and_beside_it(around):
    for x, y, z in ((0, 0, 9.0 + HIGH + 0.01), (0, 3.0 + HALF + 0.01, 5.0)):
        flight = Flight(around((x, y, z, 0.0), prisms=[WALL]))
        assert not any(flight.step(0.08, 0.0, 0.0) for _ in range(130))
    flight = Flight(around((0, 0, 9.0 + HIGH - 0.01, 0.0), prisms=[WALL]))
    assert any(flight.step(0.08, 0.0, 0.0) for _ in range(130))


def test_a_roof_is_landed_on(around):
    roof = ([(-5, -5), (5, -5), (5, 5), (-5, 5)], 0.0, 9.0)
    flight = Flight(around((0, 0, 10.0, 0.0), prisms=[roof]))
    steps = 1
    while not flight.step(0.0, 0.0, -0.01):
        steps += 1
    assert 10.0 - 0.01 * steps - HIGH == pytest.approx(9.0, abs=0.011)
    assert flight.episodes.contact[0, 2] == pytest.approx(9.0)


def test_a_pole_and_the_flat_ground_are_things(around):
    flight = Flight(around((0, 0, 5.0, 0.0), cylinders=[(2.0, 0.0, 0.1, 0.0, 6.0)]))
    while not flight.step(0.05, 0.0, 0.0):
        pass
    assert flight.trackers.position[0, 0] == pytest.approx(1.9 - HALF, abs=0.051)
    assert flight.episodes.contact_object[0] == 2
    flight = Flight(around((0, 0, 1.0, 0.0)))
    while not flight.step(0.0, 0.0, -0.05):
        pass
    assert flight.trackers.position[0, 2] == pytest.approx(-0.1 + HIGH, abs=0.051)
    assert flight.episodes.contact_object[0] == 0
    assert flight.episodes.contact[0, 2] == pytest.approx(-0.1)


def test_a_hill_is_hit_on_its_slope_and_cannot_be_jumped_through(around):
    x = np.arange(-40.0, 41.0, 4.0)
    ridge = np.maximum(10.0 - np.abs(x), 0.0).astype(np.float32)
    terrain = Terrain(0.0, np.tile(ridge, (len(x), 1)), -40.0, -40.0, 4.0)
    for speed in (40.0, 10_000.0):
        flight = Flight(around((-20, 0, 5.0, 0.0), relief=terrain))
        while not flight.step(speed * 0.002, 0.0, 0.0):
            assert flight.trackers.position[0, 0] < 20.0
        if speed == 40.0:  # its front, HIGH below the middle, is on the slope
            front = flight.trackers.position[0, 0] + HALF
            assert -10.0 + 5.0 - HIGH <= front <= -10.0 + 5.0 - HIGH + 0.09


def test_a_car_is_hit_from_above_and_hits_what_stands_in_its_way(around):
    model = model_index("BmwX5Simple")
    length, _, height = MODELS[model].size
    flight = Flight(around((0, 0, height + 1.0, 0.0), cars=[(0.0, 0.0, 0.3, 0.0)]))
    while not flight.step(0.0, 0.0, -0.02):
        pass
    assert flight.trackers.position[0, 2] == pytest.approx(height + HIGH, abs=0.021)
    assert flight.episodes.contact_object[0] == ACTOR_OBJECT
    # At 20 m/s, into a drone that hovers 1 m above the road.
    front = kind_of(model).ahead + length / 2
    flight = Flight(around((10.0, 0, 1.0, 0.0), cars=[(0.0, 0.0, 0.0, 20.0)]))
    steps = 1
    while not flight.step(0.0, 0.0, 0.0):
        steps += 1
    assert steps == pytest.approx((10.0 - HALF - front) / 0.04, abs=1.01)
    # A car that comes towards a fast drone is not passed through.
    flight = Flight(around((8.0, 0, 1.0, 0.0), cars=[(0.0, 0.0, 0.0, 20.0)]))
    assert flight.step(-20.0, 0.0, 0.0)


def test_a_folded_truck_is_hit_where_it_is_and_not_on_its_chord(around):
    """Its kingpin is at the origin, its bumper east of it, the tail of its trailer south of it."""
    for x, y, met in (
        (0.0, 0.0, True),
        (-0.9, 1.2, True),  # 4 m from the chord
        (4.5, 1.2, True),
        (0.0, -9.3, True),
        (2.4, -4.8, False),  # the middle of the chord
        (3.0, -3.0, False),
        (-2.0, -2.0, False),
    ):
        flight = Flight(around((x, y, 2.0, 0.0), folded=True))
        assert flight.step(0.0, 0.0, 0.0) == met, (x, y)
        assert flight.episodes.contact_object[0] == (ACTOR_OBJECT if met else -1)


def test_a_crash_lasts_for_the_command_and_its_place_until_the_reset(around):
    flight = Flight(around((0, 0, 5.0, 0.0), prisms=[WALL]))
    assert flight.step(4.7, 0.0, 0.0)
    assert flight.step(2.0, 0.0, 0.0, command=False)  # it touches while leaving
    assert flight.step(2.0, 0.0, 0.0, command=False)  # no longer, but in the same command
    assert not flight.step(2.0, 0.0, 0.0)
    assert flight.episodes.contact_object[0] == 1
    assert flight.episodes.reason[0] == DoneReason.NONE


def test_a_crash_ends_the_episode_where_it_is_an_end(around):
    flight = Flight(around((0, 0, 5.0, 0.0), prisms=[WALL]), ends=True, grace_steps=2)
    assert flight.step(4.7, 0.0, 0.0)
    assert flight.episodes.reason[0] == DoneReason.NONE  # within the grace steps
    assert flight.step(0.0, 0.0, 0.0)
    assert flight.episodes.reason[0] == DoneReason.CRASH
    flight.episodes.reason[0] = DoneReason.NONE  # as the next step may judge
    flight.step(-4.0, 0.0, 0.0)
    assert flight.episodes.reason[0] == DoneReason.CRASH


def test_numbers_that_are_none_are_told_before_a_crash(around):
    flight = Flight(around((0, 0, 5.0, 0.0), prisms=[WALL]), ends=True)
    flight.step(4.7, 0.0, 0.0)
    flight.episodes.reason[0] = DoneReason.NOT_A_NUMBER
    flight.step(0.0, 0.0, 0.0)
    assert flight.episodes.reason[0] == DoneReason.NOT_A_NUMBER


def test_a_new_episode_begins_without_a_crash_also_within_a_command(around):
    flight = Flight(around((0, 0, 5.0, 0.0), prisms=[WALL]), ends=True)
    assert flight.step(4.7, 0.0, 0.0)
    assert flight.episodes.reason[0] == DoneReason.CRASH
    flight.trackers.position[0] = -20.0, 0.0, 5.0
    flight.episodes.step_count[0] = 0
    flight.episodes.crash[0], flight.episodes.reason[0] = False, DoneReason.NONE
    flight.contacts.begin(0, np.random.default_rng(0))
    assert not flight.step(0.01, 0.0, 0.0, command=False)
    assert flight.episodes.reason[0] == DoneReason.NONE


def test_each_tracker_has_its_own_contacts_and_those_that_stand_still_none(around):
    poses = [(4.7, 0, 5.0, 0.0), (0.0, 0, 5.0, 0.0), (4.7, 0, 5.0, 0.0)]
    flight = Flight(around(*poses, prisms=[WALL]))
    flight.active[2] = False
    flight.step(0.0, 0.0, 0.0)
    assert flight.episodes.crash.tolist() == [True, False, False]
    assert flight.episodes.contact_object.tolist() == [1, -1, -1]


def test_a_tilted_body_is_as_high_as_its_corners(around):
    world = around((0.0, 0.0, 0.25, 0.0))
    flat = Flight(world)
    assert not flat.step(0.0, 0.0, 0.0)
    world[0].trackers.orientation[0] = np.cos(0.3), np.sin(0.3), 0.0, 0.0  # 0.6 rad of roll
    assert flat.step(0.0, 0.0, 0.0)


def meeting(around, speed, aside=0.0, **others):
    """Two drones 10 m apart that fly towards each other, with the steps until they crash."""
    poses = (0.0, 0.0, 20.0, 0.0), (10.0, aside, 20.0, 0.0)
    flight = Flight(around(*poses, bodies=True, **others))
    velocity = np.array([[speed, 0.0, 0.0], [-speed, 0.0, 0.0]])
    flight.trackers.velocity[:] = velocity
    steps = 0
    while not flight.episodes.crash[0] and steps < 20.0 / (speed * 0.004):
        flight.trackers.position[:] += velocity * 0.002
        flight.step(0.0, 0.0, 0.0)
        steps += 1
    return flight, steps


@pytest.mark.parametrize("speed", [1.0, 40.0, 3000.0])
def test_drones_of_a_world_collide_at_any_speed(around, speed):
    flight, steps = meeting(around, speed)
    assert flight.episodes.crash.tolist() == [True, True]
    assert steps == pytest.approx((10.0 - 2 * HALF) / (speed * 0.004), abs=2.01)
    assert flight.episodes.contact_object.tolist() == [ACTOR_OBJECT + 2, ACTOR_OBJECT + 1]
    assert np.abs(flight.episodes.contact[:, 1]).max() <= HALF + 1e-9
    assert flight.episodes.contact[:, 2] == pytest.approx([20.0, 20.0])


def test_a_drone_that_hovers_is_hit_by_one_that_flies_through_it_in_a_step(around):
    flight = Flight(around((0.0, 0.0, 20.0, 0.0), (5.0, 0.0, 20.0, 0.0), bodies=True))
    flight.trackers.velocity[1] = -5000.0, 0.0, 0.0
    flight.trackers.position[1, 0] -= 10.0
    flight.step(0.0, 0.0, 0.0)
    assert flight.episodes.crash.tolist() == [True, True]


def test_drones_that_pass_each_other_do_not(around):
    assert not meeting(around, 40.0, aside=2 * HALF + 0.01)[0].episodes.crash.any()
    assert meeting(around, 40.0, aside=2 * HALF - 0.01)[0].episodes.crash.all()


def test_nobody_collides_with_itself_nor_with_another_world(around):
    flight = Flight(around(*[(0.0, 0.0, 20.0, 0.0)] * 3, bodies=True))
    flight.step(0.0, 0.0, 0.0)
    assert flight.episodes.crash.tolist() == [True] * 3
    for bodies, worlds in ((False, [0, 0, 0]), (True, [0, 1, 2])):
        snapshot, obstacles = around(*[(0.0, 0.0, 20.0, 0.0)] * 3, bodies=bodies)
        model = np.tile(obstacles.movers.model, (3, 1))
        movers = obstacles.movers._replace(world=np.array(worlds, np.int32), model=model)
        apart = Flight((snapshot, obstacles._replace(movers=movers)))
        apart.step(0.0, 0.0, 0.0)
        assert not apart.episodes.crash.any()


def test_a_tilted_drone_is_as_high_as_it_stands(around):
    flight = Flight(around((0.0, 0.0, 20.0, 0.0), (0.0, 0.0, 20.5, 0.0), bodies=True))
    assert not flight.step(0.0, 0.0, 0.0)
    flight.trackers.orientation[1] = np.cos(0.4), np.sin(0.4), 0.0, 0.0
    assert flight.step(0.0, 0.0, 0.0)
