"""Targets other than vehicles, and extras, in simulations."""

import math
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.behaviours.groups import SampleClock
from eyas.engine.core.errors import ConfigError, SpawnError
from eyas.engine.exports.capture import FrameMoment, frame_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.exports.label import label_of
from eyas.engine.exports.writer import Episode
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.crowd import crowd_of, extras_of
from eyas.engine.sim.crowd_motion import CrowdSurroundings, crowd_motions, with_crowd
from eyas.engine.sim.scenes import load_scene
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.state.motion import SAMPLE, SampledMotion, joined
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import KINDS
from eyas.engine.traffic.recorded import Vehicles

from ...kit.walkers import FEW

START = {"pitch": 1.37, "height": 8.0}


def built(trackers=1, **settings):
    config = SimConfig(**{"start": START, "done": {"no_reward_steps": 10_000}, **settings})
    simulation = build_simulation(config, each_alone(trackers))
    simulation.reset()
    return simulation


@pytest.fixture(scope="module")
def walk():
    """Pedestrians to be followed, with a robot beside."""
    extras = [{"kind": "BB-8", "count": 3}, {"kind": "SUMO_VEHICLE", "count": 5}]
    return built(4, target="Pedestrian", objects=FEW, extras=extras)


def kinds_around(simulation) -> list[str]:
    return [KINDS[kind].name for kind in simulation.traffic.motion.kind.tolist()]


def test_the_world_holds_who_is_asked_for_vehicles_first(walk):
    assert kinds_around(walk) == ["passenger"] * 5 + ["Pedestrian"] * 4 + ["BB-8"] * 3


def test_only_those_of_the_asked_kind_are_followed_and_none_is_lost(walk):
    for _ in range(10):
        walk.reset()
        assert set(walk.snapshot.targets.actor.tolist()) <= {5, 6, 7, 8}
        walk.carry(1500)
        assert not walk.snapshot.targets.lost.any()


def test_a_target_on_foot_is_in_the_picture_and_in_the_labels(walk):
    walk.reset()
    walk.carry(250)
    picture = Picture.create(4, 120, 160, subject=True, class_id=True)
    walk.draw(np.arange(4, dtype=np.int32), picture)
    for tracker in range(4):
        frame = frame_of(
            FrameMoment(walk.snapshot, walk.snapshot.episodes),
            tracker,
            picture,
            tracker,
            0,
            RecordedAction(-1, None),
        )
        label = label_of(frame, Episode(Path(), "DRONE0", 0, 160, 120, np.eye(3), 25.0))
        assert (label["target_type"], frame.target.object_class) == (
            frame.target.type,
            ObjectClass.PERSON,
        )
        assert frame.target.motion.upright
        assert label["visible_fraction"] > 0.1
        assert (picture.class_id[tracker] == ObjectClass.PERSON).any()
        assert math.hypot(*label["target_velocity"]) <= 2.001
        assert label["target_travelled"] > 0.0
        assert label["direction"] in (0, 1, 2, 3)
        corners = np.array(label["target_corners"])
        ground = corners[:4, 2].mean()
        assert -0.11 < ground < 0.16
        assert corners[4:, 2].mean() - ground == pytest.approx(label["target_size"][2])
        assert np.allclose(corners.mean(axis=0)[:2], label["target_centre"][:2], atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["Pedestrian", "BB-8", "SUMO_VEHICLE"])
def test_truth_agrees_with_its_own_differences(target):
    off_road = {**FEW, "offset": {"mirrored": [30, 90]}}
    simulation = built(8, target=target, objects=off_road, world={"map": "village"})
    climbs = 0.0
    for _ in range(6):
        simulation.carry(400)
        before = simulation.snapshot.copy().targets
        simulation.carry(1)
        after = simulation.snapshot.targets
        lost = after.lost[:, None]
        went = np.where(lost, 0.0, after.position - before.position)
        mean = 0.5 * (before.velocity + after.velocity)
        assert np.allclose(went / 0.002, np.where(lost, 0.0, mean), atol=2e-3)
        gain = (after.velocity - before.velocity) / 0.002
        assert np.allclose(gain, after.acceleration, atol=1e-6)
        assert np.allclose(after.speed, np.hypot(*after.velocity[:, :2].T))
        level = np.linalg.norm(went[:, :2], axis=1)
        assert np.allclose(after.travelled - before.travelled, level, atol=2e-4)
        turning = 0.5 * (before.yaw_rate + after.yaw_rate)
        assert np.allclose((after.yaw - before.yaw) / 0.002, turning, atol=0.02)
        climbs = max(climbs, np.abs(after.velocity[:, 2]).max())
    assert (climbs > 0.02) == (target != "SUMO_VEHICLE")  # that village's streets are level


@pytest.mark.parametrize("extras", [[{"kind": "Create", "count": 2}], None])
def test_extras_leave_the_vehicles_and_their_episodes_as_they_are(extras):
    alone, among = built(3, extras=[]), built(3, extras=extras)
    cars = alone.actors
    assert among.actors > cars
    for _ in range(3):
        for field in ("actor", "model", "position", "yaw"):
            a, b = (getattr(sim.snapshot.targets, field) for sim in (alone, among))
            assert np.array_equal(a, b), field
        looks = [sim.actors_around(1)[1][:cars] for sim in (alone, among)]
        assert np.array_equal(*looks)
        alone.reset()
        among.reset()


@pytest.mark.parametrize(
    ("settings", "behaviour", "count"),
    [
        ({}, "crossing", 40),
        ({"world": {"map": "downtown"}}, "crossing", 80),
        ({"traffic": {"source": "live"}}, "pavement", 40),
        ({"target": "BB-8"}, "crossing", 40),
        ({"world": {"map": "lake"}}, "verge", 24),
        ({"world": {"map": "desert"}}, None, 0),
        ({"extras": []}, None, 0),
    ],
)
def test_pedestrians_walk_where_people_are_unless_extras_says_otherwise(settings, behaviour, count):
    found = [(who.kind, who.behaviour, who.count) for who in extras_of(SimConfig(**settings))]
    assert [who for who in found if who[1] not in ("wait", "ride")] == (
        [("Pedestrian", behaviour, count)] if count else []
    )
    assert ("Cyclist" in [kind for kind, *_ in found]) is (count > 0)


def test_the_pedestrians_of_a_city_are_in_its_simulation():
    others = kinds_around(built())[40:]
    assert others == ["Pedestrian"] * 56 + ["Cyclist"] * 10
    assert {"Pedestrian", "Cyclist"}.isdisjoint(kinds_around(built(extras=[])))


def test_who_is_half_in_the_picture_is_told_apart(monkeypatch):
    simulation = built(
        1, target="Mantis", objects={**FEW, "max_count": 2, "group_size": 2}, extras=[]
    )
    cameras, target = simulation.snapshot.cameras, int(simulation.snapshot.targets.actor[0])
    seen = simulation.actors_around
    place = seen(0)[0].position[0, target].copy()
    deep = (place - cameras.position[0]) @ cameras.rotation[0, :, 0]
    side = deep * math.tan(0.5 * cameras.field_of_view[0])  # half the picture's width
    middle = (
        place
        - (place - cameras.position[0]) @ cameras.rotation[0, :, 1] * (cameras.rotation[0, :, 1])
    )

    def moved(share: float) -> str:
        actors, models = seen(0)
        actors.present[:] = True
        actors.position[0, 1 - target] = middle + share * side * cameras.rotation[0, :, 1]
        monkeypatch.setattr(simulation.view._worlds, "actors_around", lambda *_: (actors, models))
        return simulation.view.words(0, 0.75)

    assert moved(1.1) == "a dark grey walking machine on six legs, moving"  # the other stands
    assert moved(2.5) == "a dark grey walking machine on six legs"


@pytest.mark.slow
def test_a_slow_robot_has_a_turn_direction():
    robots = built(2, target="Sojourner", objects=FEW)
    robots.carry(500)
    assert (robots.snapshot.episodes.direction > 0).all()
    assert (robots.snapshot.targets.speed < 0.05).all()


def test_more_vehicles_than_the_traffic_has_are_refused():
    extras = [{"kind": "SUMO_VEHICLE", "count": 60}]
    with pytest.raises(ConfigError, match=r"^extras: 60 vehicles .* has 40; allowed"):
        built(target="Pedestrian", objects=FEW, extras=extras)


def test_an_unknown_behaviour_is_told_with_the_nearest():
    with pytest.raises(ConfigError, match=r"^extras\.0\.behaviour: 'wonder' .* mean 'wander'"):
        SimConfig(extras=[{"behaviour": "wonder"}])


@pytest.mark.slow
def test_fewer_targets_than_trackers_is_told():
    config = SimConfig(target="Pedestrian", objects={**FEW, "max_count": 2})
    simulation = build_simulation(config, together(3))
    with pytest.raises(SpawnError, match="no target is free"):
        simulation.reset()


def test_all_are_followed_for_as_long_as_the_traffic_lasts(staying):
    """As many targets as trackers, of which the original moves all at once."""
    done = {"total_steps": 6000, "no_reward_steps": 10**6}
    objects = {**FEW, "max_count": 3}
    config = SimConfig(target="Pedestrian", objects=objects, done=done, extras=())
    simulation = build_simulation(config, together(3))
    for _ in range(20):
        simulation.reset()
        simulation.snapshot.episodes.tick[:] += 6000
        actors = simulation.snapshot.targets.actor
        assert sorted(actors) == [0, 1, 2]
        time = simulation.snapshot.episodes.tick[0] / 500.0
        assert staying(simulation.traffic, time - 12.0, time) == [0, 1, 2]


@pytest.mark.slow
def test_no_target_for_a_whole_episode_is_told():
    """Objects that come after the recording has ended."""
    settings = {"target": "Pedestrian", "objects": FEW, "done": {"total_steps": 900_000}}
    with pytest.raises(ConfigError, match=r"done\.total_steps: 900000"):
        build_simulation(SimConfig(**settings), each_alone(1))


def test_a_crowd_beside_vehicles_is_kept_with_them_and_moves_as_alone():
    crowd = crowd_of(
        SimConfig(extras=[{"kind": "Pedestrian", "count": 3}, {"kind": "BB-8", "count": 2}])
    )
    scene = load_scene("citystreet")
    table = np.zeros((101, 2), SAMPLE)
    table["x"], table["present"] = 5.0, 1.0
    driven = SampledMotion(table, np.zeros(2, np.int32), 10.0)
    vehicles = Vehicles(lambda: driven, driven.kind, driven.lamps, 101, 10.0, (table,))
    around = CrowdSurroundings(scene, SampleClock(101, 10.0), 3, vehicles)
    motion, targets = with_crowd(crowd, around)
    in_memory = joined([driven.packed(), *crowd_motions(crowd, around)])
    np.testing.assert_array_equal(motion.sampled().table, in_memory.sampled().table)
    np.testing.assert_array_equal(motion.kind, in_memory.kind)
    assert motion.kind.dtype == in_memory.kind.dtype
    assert targets.tolist() == [True, True, *[False] * (len(motion.kind) - 2)]
