"""Actors that no view may show are left out, and no byte of a picture changes by it."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.views.actor_bounds import NOWHERE, bounds_of, made_row
from eyas.engine.sim.views.near_lights import NearLights
from eyas.engine.sim.views.visible_actors import VisibleActors
from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.catalogue import KINDS, kind_index
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.looks import LookSampler
from eyas.engine.targets.rig import Rigs
from eyas.engine.traffic.interpolation import sample_before
from eyas.engine.world.config import WorldConfig
from eyas.lanes import kernel

SIZE = (60, 80)


@pytest.fixture(scope="module", params=["day", "night"])
def town(request, config):
    return load_assets(WorldConfig(weather=request.param), config.traffic, 1)


def looks_of(motion, worlds: int) -> Looks:
    sampler = LookSampler(motion.kind)
    drawn = [sampler.sample(np.random.default_rng(w)) for w in range(worlds)]
    return Looks(*(np.stack(part) for part in zip(*drawn, strict=True)))


def near_of(assets, looks, *, everything: bool = False) -> VisibleActors:
    reach = assets.renderer.influence(assets.rigs.reach(assets.renderer.part_reach()))
    if everything:
        reach = np.full_like(reach, 1e6)
    return VisibleActors(assets.traffic.motion, assets.rigs, looks, reach)


def cameras_among(assets, times, rng) -> CameraState:
    """Cameras over an actor of each world, that look anywhere, with lenses of their own."""
    actors = ActorState.create(len(times), assets.traffic.actors)
    assets.traffic.at(times, actors)
    count = len(times)
    chosen = rng.integers(assets.traffic.actors, size=count)
    position = actors.position[np.arange(count), chosen] + rng.uniform(
        (-30, -30, 1), (30, 30, 25), (count, 3)
    )
    rotation = np.empty((count, 3, 3))
    for k, (yaw, pitch) in enumerate(rng.uniform((-3, -0.1), (3, 1.5), (count, 2))):
        cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
        rotation[k] = [[cy * cp, -sy, cy * sp], [sy * cp, cy, sy * sp], [-sp, 0, cp]]
    return CameraState(position, rotation, rng.uniform(0.4, 1.4, count))


def drawn(assets, movers: DrawList, cameras: CameraState, row) -> Picture:
    views = Views(
        position=cameras.position,
        rotation=cameras.rotation,
        world=np.asarray(row, np.int32),
        subject=np.full(len(row), -1, np.int32),
        field_of_view=cameras.field_of_view,
    )
    picture = Picture.create(len(row), *SIZE, depth=True, object_id=True, class_id=True)
    assets.renderer.draw(views, movers, picture)
    return picture


def assert_same(one: Picture, other: Picture) -> None:
    for name in ("rgb", "depth", "object_id", "class_id"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


def test_pictures_are_those_with_all_actors(town):
    """Also of two views that share a world, one of which sees what the other does not."""
    rng = np.random.default_rng(8)
    count = 24
    times = rng.uniform(5.0, 120.0, count)
    cameras = cameras_among(town, times, rng)
    worlds, row = np.arange(count - 4), np.concatenate([np.arange(count - 4), [3, 1, 3, 0]])
    times = times[: count - 4]
    looks = looks_of(town.traffic.motion, len(worlds))
    few, all_ = near_of(town, looks), near_of(town, looks, everything=True)
    short = few.of(worlds, times, row, cameras, 0.75)
    posed = int((short.part >= 0).sum())
    picture = drawn(town, short, cameras, row)
    full = all_.of(worlds, times, row, cameras, 0.75)
    assert posed < 0.4 * (full.part >= 0).sum()
    assert short.part.shape[1] < full.part.shape[1]
    assert_same(picture, drawn(town, full, cameras, row))
    assert (picture.class_id == 9).mean() > 0.005


def test_a_list_with_all_actors_is_that_of_the_rigs(town):
    motion = town.traffic.motion
    looks, times = looks_of(motion, 2), np.array([20.0, 33.3])
    actors, expected = ActorState.create(2, town.traffic.actors), town.rigs.draw_list(2)
    town.traffic.at(times, actors)
    town.rigs.pose(actors, looks, expected)
    cameras = cameras_among(town, times, np.random.default_rng(1))
    made = near_of(town, looks, everything=True).of(np.arange(2), times, np.arange(2), cameras, 1.0)
    for w in range(2):
        ours, theirs = made.part[w] >= 0, expected.part[w] >= 0
        for name in ("part", "pose", "colour", "object_id"):
            np.testing.assert_array_equal(
                getattr(made, name)[w][ours], getattr(expected, name)[w][theirs], err_msg=name
            )
        np.testing.assert_array_equal(made.object_class[w], expected.object_class[w])


def test_actors_of_several_kinds_are_posed_by_their_own_rigs(config, assets):
    """Kinds take turns among the actors, and some of them are far away."""
    motion = assets.traffic.motion
    names = ("bus", "passenger", "motorcycle")
    kind = np.array([kind_index(names[a % 3]) for a in range(assets.traffic.actors)], np.int32)
    motion = motion._replace(kind=kind)
    rigs, looks, times = Rigs(kind), looks_of(motion, 1), np.array([120.0])
    actors, expected = ActorState.create(1, len(kind)), rigs.draw_list(1)
    assets.traffic.at(times, actors)
    rigs.pose(actors, looks, expected)
    near = VisibleActors(motion, rigs, looks, np.array([10.0, 60.0, 30.0]))
    cameras = cameras_among(assets, times, np.random.default_rng(4))
    made = near.of(np.zeros(1, int), times, np.zeros(1, int), cameras, 1.0)
    for slot in np.flatnonzero(made.part[0] >= 0):
        (same,) = np.flatnonzero(
            (expected.object_id[0] == made.object_id[0, slot])
            & (expected.part[0] == made.part[0, slot])
            & (expected.pose[0] == made.pose[0, slot]).all(axis=(1, 2))
        )
        np.testing.assert_array_equal(made.colour[0, slot], expected.colour[0, same])
    listed = np.unique(made.object_id[0][made.part[0] >= 0])
    assert 3 < len(listed) < len(kind)
    assert len({KINDS[kind[i - (1 << 16)]].name for i in listed.tolist()}) == 3


@pytest.mark.parametrize("side", range(3), ids=["behind", "aside", "above"])
def test_an_actor_is_listed_up_to_its_reach_outside_of_a_view(assets, side):
    reach, time = 25.0, np.array([20.0])
    actors = ActorState.create(1, assets.traffic.actors)
    assets.traffic.at(time, actors)
    actor = np.flatnonzero(actors.present[0])[0]
    looks = looks_of(assets.traffic.motion, 1)
    visible = VisibleActors(assets.traffic.motion, assets.rigs, looks, np.array([reach]))
    field, listed = 1.0, []
    for away in (0.99 * reach, 1.01 * reach + 0.1):
        # The camera looks north, and the plane behind it, its left edge or its upper edge is so
        # far from the actor, which is 100 m ahead of it in the last two cases.
        edge = 100.0 * np.tan(field / 2) + away / np.cos(field / 2)
        place = np.array([(0.0, away, 0.0), (edge, -100.0, 0.0), (0.0, -100.0, -edge)][side])
        camera = CameraState(
            (actors.position[0, actor] + place)[None],
            np.array([[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]]),
            np.array([field]),
        )
        movers = visible.of(np.zeros(1, int), time, None, camera, 1.0)
        listed.append(ACTOR_OBJECT + actor in movers.object_id[movers.part >= 0])
    assert listed == [True, False]


def test_lists_grow_and_shrink_with_what_is_asked_for(assets):
    looks = looks_of(assets.traffic.motion, 9)
    rng = np.random.default_rng(2)
    times = rng.uniform(5.0, 100.0, 9)
    cameras = cameras_among(assets, times, rng)
    near = near_of(assets, looks)
    for count in (1, 9, 4):
        worlds = np.arange(count)
        some = CameraState(*(array[:count] for array in cameras))
        picture = drawn(assets, near.of(worlds, times[:count], worlds, some, 0.75), some, worlds)
        fresh = near_of(assets, looks).of(worlds, times[:count], worlds, some, 0.75)
        assert_same(picture, drawn(assets, fresh, some, worlds))


@kernel
def row_at(chart, motion, time):
    return made_row(chart, motion, sample_before(motion, time))


@settings(max_examples=60)
@given(st.floats(0.0, 11.99))
def test_every_actor_is_in_its_sphere_of_the_chart(assets_where, time):
    traffic = assets_where((2.5, 4.0)).traffic
    motion = traffic.motion
    order = np.arange(traffic.actors)[::-1].copy()
    chart = bounds_of(motion, order)
    sphere = chart.sphere[row_at(chart, motion, time)]
    actors = ActorState.create(1, traffic.actors)
    traffic.at(np.array([time]), actors)
    for column, actor in enumerate(order.tolist()):
        if actors.present[0, actor]:
            away = np.linalg.norm(actors.position[0, actor] - sphere[:3, column])
            assert away <= sphere[3, column] + 1e-3
    assert (sphere[3, traffic.actors :] == np.float32(NOWHERE)).all()


def test_absent_actors_are_not_charted(assets_where):
    traffic = assets_where((2.5, 6.5)).traffic
    chart = bounds_of(traffic.motion, np.arange(traffic.actors))
    away = chart.sphere[row_at(chart, traffic.motion, 4.5)]
    assert (away[3] == np.float32(NOWHERE)).all()
    there = chart.sphere[row_at(chart, traffic.motion, 8.5)]
    assert (there[3, : traffic.actors] < 40.0).all()
    assert (there[3, : traffic.actors] >= 0.0).all()


def test_a_motion_of_two_samples_is_enough(assets):
    motion = assets.traffic.motion
    short = motion.of(motion.table[:2])
    cameras = cameras_among(assets, np.zeros(1), np.random.default_rng(0))
    looks = looks_of(motion, 1)
    movers = VisibleActors(short, assets.rigs, looks, np.full(len(assets.rigs.casts), 1e6)).of(
        np.zeros(1, int), np.array([50.0]), np.zeros(1, int), cameras, 1.0
    )
    assert len(np.unique(movers.object_id[movers.part >= 0])) == assets.traffic.actors


def test_pictures_are_those_with_the_lights_of_all_signals(town):
    """Also where two views share a world; most lights are listed for none of the views."""
    signals, rng = town.signals, np.random.default_rng(11)
    reach = float(town.renderer.part_reach()[signals.first_part :].max())
    looks, times = looks_of(town.traffic.motion, 12), rng.uniform(5.0, 120.0, 12)
    cameras = cameras_before(signals, rng)
    row = np.concatenate([np.arange(12), np.arange(4)])
    motion, far = town.traffic.motion, np.full(len(town.rigs.casts), 60.0)
    near = VisibleActors(motion, town.rigs, looks, far, lights=NearLights(signals, reach))
    worlds = np.arange(12)
    for _ in range(2):  # the second time, there is room for all at once
        short = near.of(worlds, times, row, cameras, 0.75)
        few = drawn(town, short, cameras, row)
    without = VisibleActors(motion, town.rigs, looks, far).of(worlds, times, row, cameras, 0.75)
    dark = drawn(town, without, cameras, row)
    assert_same(few, drawn(town, signals.added(without, times), cameras, row))
    listed = (short.part >= signals.first_part).sum()
    assert 12 <= listed < 0.5 * 12 * len(signals.row)
    assert (few.rgb != dark.rgb).any(axis=(1, 2, 3)).sum() >= 8


def cameras_before(signals, rng) -> CameraState:
    """Sixteen cameras, each a few metres before the light of a signal and towards it."""
    pole = rng.integers(len(signals.pose), size=16)
    rotation = signals.pose[pole, :, :3].astype(np.float64)
    rotation /= np.linalg.norm(rotation, axis=1, keepdims=True)
    away, side = rng.uniform(5.0, 9.0, (16, 1)), rng.choice([-1.0, 1.0], (16, 1))
    return CameraState(
        signals.pose[pole, :, 3] + side * away * rotation[:, :, 0] + np.array([0.0, 0.0, 3.0]),
        np.stack([-side * rotation[:, :, 0], -side * rotation[:, :, 1], rotation[:, :, 2]], -1),
        np.full(16, 1.2),
    )


def test_no_camera_sees_a_light_that_is_none(town):
    """Lights are told apart eight at once; what fills up the last eight is nowhere."""
    lights = town.signals
    few = dataclasses.replace(
        lights, row=lights.row[:3], pose=lights.pose[:3], object_id=lights.object_id[:3]
    )
    motion, looks = town.traffic.motion, looks_of(town.traffic.motion, 64)
    times, rng = np.full(64, 20.0), np.random.default_rng(3)
    cameras = cameras_among(town, times, rng)
    cameras.field_of_view[:] = 3.1
    far = np.full(len(town.rigs.casts), 1.0)
    near = VisibleActors(motion, town.rigs, looks, far, lights=NearLights(few, 5.0))
    movers = near.of(np.arange(64), times, None, cameras, 1.0)
    seen = np.isin(movers.object_id, few.object_id) & (movers.part >= lights.first_part)
    assert (movers.part >= lights.first_part).sum() == seen.sum() > 0
