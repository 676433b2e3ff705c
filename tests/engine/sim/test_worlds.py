"""Who shares a world, and what is shared in it."""

import tracemalloc

import numpy as np
import pytest

from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import ALONE, Worlds, each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.looks import LookSampler
from eyas.engine.world.config import LightConfig

GROUPS = [0, 0, 1, ALONE]
"""Trackers 0 and 1 together, 2 in a lasting world, 3 in one that begins anew."""


def started(config: SimConfig, world_of):
    simulation = build_simulation(config, np.array(world_of))
    simulation.reset()
    return simulation


def flown(simulation, tracker: int) -> list[bytes]:
    """Fly one tracker; return its packets, and what it sees and covers at last."""
    commands = np.zeros((simulation.count, 4))
    commands[tracker] = 8.0, -3.0, 0.002, 0.4
    said = []
    for _ in range(20):
        result = simulation.advance(commands, 4)
        said += [packets[tracker].tobytes() for packets in simulation.packets()]
        said.append(result.reward[tracker].tobytes())
    picture = Picture.create(1, 48, 64, depth=True, object_id=True, subject=True)
    simulation.draw(np.array([tracker], np.int32), picture)
    wanted = (picture.rgb, picture.depth, picture.object_id, picture.subject_box)
    return said + [array.tobytes() for array in wanted]


def seen_from_above(simulation, trackers) -> np.ndarray:
    """Pictures of the worlds of trackers from one and the same camera over the first target."""
    x, y, _ = simulation.snapshot.targets.centre[0]
    down = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    count = len(trackers)
    cameras = CameraState(
        np.tile((x, y, 60.0), (count, 1)),
        np.ascontiguousarray(np.tile(down, (count, 1, 1))),
        np.full(count, 1.2),
    )
    picture = Picture.create(count, 96, 128, depth=True)
    simulation.draw_from(np.array(trackers, np.int32), cameras, picture, overlay=False)
    return picture.rgb


def models_around(simulation, tracker: int) -> list[int]:
    """Models of the first 20 actors in the world of a tracker."""
    models = []
    for actor in range(20):
        simulation.follow(tracker, actor)
        models.append(int(simulation.snapshot.targets.model[tracker]))
    return models


def test_trackers_of_a_world_share_its_time_and_follow_different_targets(config):
    simulation = started(config, GROUPS)
    episodes, targets = simulation.snapshot.episodes, simulation.snapshot.targets
    assert episodes.tick[0] == episodes.tick[1]
    assert targets.actor[0] != targets.actor[1]
    simulation.carry(50)
    simulation.reset(np.array([False, True, False, True]))
    assert episodes.tick[0] == episodes.tick[1] == episodes.tick[2] == 310 + 50
    assert episodes.tick[3] != 360
    assert episodes.number.tolist() == [0, 1, 0, 1]
    assert targets.actor[0] != targets.actor[1]


def test_a_world_looks_the_same_to_all_in_it_and_other_worlds_look_otherwise(config):
    simulation = started(config, GROUPS)
    first, second, other, _ = seen_from_above(simulation, range(4))
    assert np.array_equal(first, second)
    # At the same time of the same traffic: only the looks differ.
    assert simulation.snapshot.episodes.tick[0] == simulation.snapshot.episodes.tick[2]
    assert (first != other).any()
    models = [models_around(simulation, tracker) for tracker in range(4)]
    assert models[0] == models[1]
    assert len({tuple(each) for each in models}) == 3


def test_looks_of_a_lasting_world_stay_when_its_trackers_begin_anew(config):
    simulation = started(config, GROUPS)
    before = [models_around(simulation, tracker) for tracker in range(4)]
    simulation.reset()
    after = [models_around(simulation, tracker) for tracker in range(4)]
    assert before[:3] == after[:3]
    assert before[3] != after[3]


def test_light_is_one_in_each_world_and_its_leader_draws_it(config):
    light = LightConfig(background={"uniform": [0.4, 1.6]}, background_replaces=True)
    simulation = started(config.model_copy(update={"light": light}), GROUPS)
    sky = simulation.snapshot.light.sky
    assert sky[0] == sky[1]
    assert len(set(sky.tolist())) == 3
    before = sky.copy()
    simulation.reset(np.array([False, True, False, False]))
    assert np.array_equal(sky, before)
    simulation.reset(np.array([True, False, False, False]))
    assert sky[0] == sky[1] != before[0]
    assert np.array_equal(sky[2:], before[2:])


@pytest.mark.parametrize("tracker", [0, 3])
def test_a_tracker_in_a_world_of_its_own_does_the_same_whoever_else_is_there(config, tracker):
    alone = started(config, each_alone(tracker + 1))
    groups = [0, 0, 1, ALONE, 1, 0]
    groups[tracker] = ALONE
    assert flown(alone, tracker) == flown(started(config, groups), tracker)


def test_a_tracker_in_a_lasting_world_does_the_same_whoever_is_in_other_worlds(config):
    assert flown(started(config, [ALONE, ALONE, 0]), 2) == flown(started(config, GROUPS), 2)


def test_worlds_are_counted_in_the_order_of_their_first_trackers(config, assets):
    worlds = Worlds(config, assets, np.array([7, 3, ALONE, 7, ALONE, 3]))
    assert worlds.of.tolist() == [0, 1, 2, 0, 3, 1]
    assert worlds.leader.tolist() == [0, 1, 2, 4]
    assert worlds.lasting.tolist() == [True, True, False, False]
    assert worlds.trackers_of(3).tolist() == [0, 3]
    assert Worlds(config, assets, together(3)).of.tolist() == [0, 0, 0]
    assert Worlds(config, assets, each_alone(3)).of.tolist() == [0, 1, 2]


@pytest.mark.parametrize("world_of", [[-2], [0, -7], [0.0, 1.0], [[0, 1]], ["a"], [True, False], 3])
def test_other_numbers_are_refused_in_one_line(config, assets, world_of):
    with pytest.raises(
        ValueError, match=r"^world_of: must hold one whole number, at least -1, .*\Z"
    ):
        Worlds(config, assets, np.array(world_of))


def test_drawing_other_subsets_takes_no_more_memory_than_drawing_all(config, assets):
    """One tracker fewer at each draw must not leave a buffer for each number behind."""
    count = 8
    tick = np.full(count, 500, np.int64)
    worlds = Worlds(config, assets, each_alone(count))
    sampler = LookSampler(assets.traffic.motion.kind)
    for world in range(count):
        looks = sampler.sample(np.random.default_rng(world))
        worlds.looks.model[world], worlds.looks.colour[world] = looks
    cameras = CameraState.create(count)  # with the whole town in front of them
    cameras.position[:, 0], cameras.field_of_view[:] = -2000.0, 2.5
    _, movers = worlds.draw_list(np.arange(count), tick, cameras, 1.0)
    assert (movers.part[0] >= 0).sum() > 40
    three_worlds = movers.pose[:3].nbytes
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        for last in range(count - 1, 0, -1):
            some = CameraState(*(array[:last] for array in cameras))
            rows, few = worlds.draw_list(np.arange(last), tick, some, 1.0)
            assert rows.tolist() == list(range(last))
            assert len(few.part) == last
        del few
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < three_worlds
