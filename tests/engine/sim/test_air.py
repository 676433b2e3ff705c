"""Wind, smoke and spray around trackers."""

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.build import build_simulation, in_one_wind
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.catalogue import KINDS

BREEZE = {"speed": {"uniform": [3.0, 12.0]}, "direction": {"uniform": [-3.1, 3.1]}}


def started(count=1, seed=0, **world):
    simulation = build_simulation(SimConfig(seed=seed, world=world), each_alone(count))
    simulation.reset()
    return simulation


def pictures(simulation, trackers=None):
    chosen = np.arange(simulation.count) if trackers is None else np.array(trackers)
    picture = Picture.create(len(chosen), 60, 84)
    simulation.draw(chosen.astype(np.int32), picture)
    return picture.rgb


def test_each_episode_has_a_wind_of_its_own_and_always_the_same():
    simulation = started(3, wind=BREEZE)
    light = simulation.snapshot.light
    speed = np.hypot(light.wind_x, light.wind_y)
    assert ((speed > 2.9) & (speed < 12.1)).all()
    assert len({*speed.tolist()}) == 3
    again = started(3, wind=BREEZE)
    np.testing.assert_array_equal(pictures(again), pictures(simulation))
    simulation.reset()
    assert (np.hypot(light.wind_x, light.wind_y) != speed).all()


def test_without_wind_the_air_is_calm_and_pictures_are_the_old_ones():
    simulation = started(2)
    assert not np.any(simulation.snapshot.light.wind_x)
    calm = started(2, wind={"speed": 0.0})
    np.testing.assert_array_equal(pictures(calm), pictures(simulation))


def test_a_flown_drone_feels_the_wind_that_moves_the_trees():
    flown = {"supervised": False, "drag_area": 0.03}
    config = SimConfig(world={"wind": {"speed": 7.0, "direction": 0.5}}, tracker=flown)
    wind = in_one_wind(config).wind
    assert (wind.speed, wind.direction) == (7.0, 0.5)
    still = SimConfig(world={"wind": {"speed": 7.0}})
    assert in_one_wind(still) == still.tracker
    with pytest.raises(ConfigError, match=r"left out with world\.wind"):
        SimConfig(world={"wind": {}}, tracker={**flown, "wind": {"speed": 3.0}})


def test_spray_and_smoke_do_not_depend_on_who_else_is_drawn():
    on = {"weather": "rain", "spray": True, "smoke": 6, "wind": BREEZE}
    simulation = started(4, **on)
    together = pictures(simulation)
    for k in range(4):
        np.testing.assert_array_equal(pictures(simulation, [k])[0], together[k])
    dry = started(4, **{**on, "spray": False, "smoke": 0})
    assert (pictures(dry) != together).any()


def test_roads_that_are_dry_give_no_spray():
    np.testing.assert_array_equal(pictures(started(2, spray=True)), pictures(started(2)))


@pytest.fixture(scope="module")
def crowded():
    config = SimConfig(airborne={"birds": 40, "drones": 5}, world={"wind": {}})
    simulation = build_simulation(config, each_alone(3))
    simulation.reset()
    return simulation


def test_what_flies_is_labelled_but_never_a_target(crowded):
    kind = [KINDS[k].name for k in crowded.traffic.motion.kind.tolist()]
    assert kind.count("bird") == 40
    assert kind.count("Quadrotor") == 5
    for _ in range(4):
        crowded.reset()
        assert {kind[a] for a in crowded.snapshot.targets.actor.tolist()} <= {"passenger", "bus",
                "truck", "motorcycle", "trailer", "delivery", "moped"}  # fmt: skip


def test_boxes_hold_the_pixels_of_birds_and_drones(crowded):
    """Seen from above each, as its picture and its ids have it."""
    state, _ = crowded._worlds.actors_around(0, int(crowded.snapshot.episodes.tick[0]))
    kind = [KINDS[k].name for k in crowded.traffic.motion.kind.tolist()]
    down = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    seen = 0
    flying = [a for a, name in enumerate(kind) if name in ("bird", "Quadrotor")]
    for actor in flying[::4]:
        if not state.present[0, actor]:
            continue
        cameras = crowded.snapshot.cameras
        first = {name: getattr(cameras, name)[:1].copy() for name in cameras._fields}
        first["position"] = state.position[0, actor][None] + [[0.0, 0.0, 6.0]]
        first["rotation"] = down[None]
        picture = Picture.create(1, 60, 84, object_id=True, actors=crowded.traffic.actors)
        crowded.view.pictures.draw_from(np.zeros(1, np.int32), CameraState(**first), picture, None)
        rows, columns = np.nonzero(picture.object_id[0] == ACTOR_OBJECT + actor)
        assert len(rows) > 3, kind[actor]
        box = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
        np.testing.assert_array_equal(picture.actor_visible_box[0, actor], box)
        seen += 1
    assert seen > 6


def test_phrases_do_not_speak_of_what_flies(crowded):
    kind = [KINDS[k].name for k in crowded.traffic.motion.kind.tolist()]
    bird, cameras = kind.index("bird"), crowded.snapshot.cameras
    state = crowded.view.actors(0).state
    cameras.position[0] = state.position[0, bird] + [0.0, 0.0, 6.0]
    cameras.rotation[0] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    said = {kind[actor] for actor in crowded.view.in_view(0).actor.tolist()}
    assert not said & {"bird", "Quadrotor"}


@pytest.fixture(scope="module")
def aloft():
    config = SimConfig(
        target="Quadrotor", objects={"behaviour": "cruise"}, start={"height": 6.0, "pitch": 0.9}
    )
    simulation = build_simulation(config, each_alone(4))
    simulation.reset()
    return simulation


def test_the_reward_uses_the_level_plane_through_a_target_that_flies(aloft):
    targets, cameras, episodes = (
        getattr(aloft.snapshot, name) for name in ("targets", "cameras", "episodes")
    )
    assert targets.flies.all()
    assert (targets.centre[:, 2] > 7.0).all()
    forward = cameras.rotation[:, :, 0]
    depth = (targets.centre[:, 2] - cameras.position[:, 2]) / forward[:, 2]
    middle = cameras.position + depth[:, None] * forward
    np.testing.assert_allclose(episodes.view_centre, middle, atol=1e-6)
    away = np.hypot(*(targets.centre - middle)[:, :2].T)
    np.testing.assert_allclose(episodes.offset, away, atol=1e-6)


def test_a_target_that_flies_is_in_the_picture_and_moves_up_and_down(aloft):
    picture = Picture.create(4, 240, 320, object_id=True)
    aloft.draw(np.arange(4, dtype=np.int32), picture)
    for k in range(4):
        own = picture.object_id[k] == ACTOR_OBJECT + aloft.snapshot.targets.actor[k]
        assert own.sum() > 20
    begun = aloft.snapshot.targets.centre.copy()
    for _ in range(200):
        aloft.carry(10)
    moved = np.abs(aloft.snapshot.targets.centre - begun)
    assert np.hypot(*moved[:, :2].T).min() > 3.0
    assert not aloft.snapshot.targets.lost.any()
