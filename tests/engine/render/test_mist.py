"""Mist on the land and glare of a low sun."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.mesh.flat import quads
from eyas.engine.render.bake.ambient import bake_ambient
from eyas.engine.render.bake.land import land_map
from eyas.engine.render.kernels.light.tone import TONE_STEPS, TONE_TOP
from eyas.engine.render.pack.light import tone_table
from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Material
from eyas.engine.state.scene import ObjectClass

from ...kit.small_city import (
    DAY,
    car_parts,
    city_scene,
    looking,
    put_car,
    scene_of,
    tower,
    trees_at,
)

CLEAR = dataclasses.replace(DAY, fog_density=0.0, fog_colour=(0.6, 0.6, 0.6))
MISTY = dataclasses.replace(CLEAR, mist=1.0 / 40.0, mist_depth=6.0)
LOW = dataclasses.replace(
    CLEAR, sun_direction=(0.995, 0.0, 0.1), sun_colour=(0.6, 0.35, 0.1), fog_density=1 / 3000
)


def plain(kind=ObjectClass.GROUND, texture="lawn"):
    corners = [[(-400, -400, 0.0), (400, -400, 0.0), (400, 400, 0.0), (-400, 400, 0.0)]]
    scene = scene_of([quads(corners, np.zeros((1, 4, 2)), Material(texture))], [0])
    scene.object_class = np.full(max(len(scene.object_class), 1), int(kind), np.int32)
    scene.size = (800.0, 800.0)
    return scene


@pytest.fixture
def seen(drawn, renderer_of):
    def see(lighting, position=(0.0, 0.0, 20.0), scene=None, **how):
        renderer = renderer_of(scene or plain(), lighting=lighting)
        return drawn(renderer, looking([position], **how)).rgb[0].astype(int)

    return see


def test_mist_hides_more_the_flatter_one_looks_through_it(seen):
    change = []
    for pitch in (1.5707, 0.5, 0.25):
        how = {"pitch": pitch, "fov": 0.1}
        change.append(np.abs(seen(MISTY, **how) - seen(CLEAR, **how)).mean())
    assert 0 < change[0] < change[1] < change[2]


def test_fog_lies_in_banks_and_is_as_thick_on_average_as_it_is_set(drawn, renderer_of):
    """Over black ground, seen from 14 m: the middle of the way is as high as the mean.

    Seen from above, fog has 0.4 of its light at the horizon.
    """
    corners = [[(-900, -900, 0), (900, -900, 0), (900, 900, 0), (-900, 900, 0)]]
    black = Material("plain", (0.0, 0.0, 0.0))
    scene = scene_of([quads(corners, np.zeros((1, 4, 2)), black)], [0])
    foggy = dataclasses.replace(CLEAR, fog_density=1 / 40, foggy=True)
    places = [(x, y, 14.0) for x in range(-600, 600, 60) for y in range(-600, 600, 60)]
    views = looking(places, pitch=1.5707, fov=0.05)
    seen = drawn(renderer_of(scene, lighting=foggy), views, size=(4, 4)).rgb[..., 1]
    light = np.searchsorted(tone_table(), seen) * (TONE_TOP / TONE_STEPS)
    hidden = light.mean(axis=(1, 2)) / (0.4 * foggy.fog_colour[1])
    assert hidden.mean() == pytest.approx(1.0 - np.exp(-14 / 40), rel=0.06)
    assert hidden.std() > 0.08 * hidden.mean()


def test_mist_lies_below_what_stands_out_of_it(seen):
    """A wall fades at its foot and is clear 30 m up."""
    wall = quads(
        [[(60, 40, 0), (60, -40, 0), (60, -40, 60), (60, 40, 60)]],
        np.zeros((1, 4, 2)),
        Material("plain", (0.3, 0.2, 0.2)),
    )
    scene = scene_of([wall], [0])
    scene.size = (800.0, 800.0)
    how = {"position": (0.0, 0.0, 30.0), "scene": scene, "fov": 0.9}
    change = np.abs(seen(MISTY, **how) - seen(CLEAR, **how)).mean(axis=(1, 2))
    assert change[80:90].mean() > 5 * max(change[10:30].mean(), 0.2)


def test_mist_is_thin_between_buildings_and_thick_over_water():
    def open_at(scene, x, y):
        found, frame = _land(scene)
        column, row = ((np.array([x, y]) - frame[:2]) * frame[2]).astype(int)
        return (found[row, column] >> 8) / 255.0

    lake, field, city = plain(ObjectClass.WATER, "water"), plain(), city_scene()
    assert open_at(lake, 0, 0) > open_at(field, 0, 0) > 0.6
    towers, _ = _land(city)
    assert (towers >> 8).min() == 0  # on a building


def test_land_under_trees_is_known():
    scene = plain()
    scene.fixtures = dataclasses.replace(trees_at([(50.0, 0.0)]), object_id=np.zeros(1, np.int32))
    scene.object_class = np.array([int(ObjectClass.TREE)], np.int32)
    found, frame = _land(scene)
    under = (found & 255) / 255.0
    column, row = ((np.array([50.0, 0.0]) - frame[:2]) * frame[2]).astype(int)
    assert under[row, column] > 0.5
    assert under[row, column - 60] == 0.0


def _land(scene):
    ambient = bake_ambient(scene)
    return land_map(scene, ambient), ambient.frame


def test_glare_is_brightest_towards_the_sun_and_absent_away_from_it(seen):
    bright = dataclasses.replace(LOW, glare=1.0)
    change = []
    for yaw in (0.0, 0.5, np.pi):
        how = {"yaw": yaw, "pitch": 0.0, "fov": 0.5}
        change.append((seen(bright, **how) - seen(LOW, **how)).mean())
    assert change[0] > 2 * change[1] > 0
    assert change[2] == 0


def test_no_veil_lies_over_the_picture_in_the_shade(seen):
    """Behind a wall the lens is in the shade; the haze beyond is lit all the same."""
    scene = scene_of([tower(40.0, 0.0, 60.0, 60.0)], [0])
    clear = dataclasses.replace(LOW, fog_density=0.0)
    glaring = dataclasses.replace(clear, glare=1.0)
    facing = {"scene": scene, "fov": 0.4}
    shaded, sunny = (0.0, 0.0, 3.0), (0.0, 120.0, 3.0)
    veil = seen(glaring, shaded, **facing).astype(int) - seen(clear, shaded, **facing)
    assert np.abs(veil).max() <= 1  # of rounding
    assert np.abs(veil).mean() < 1e-3
    assert (seen(glaring, sunny, yaw=0.2, **facing) > seen(clear, sunny, yaw=0.2, **facing)).any()


def test_a_low_sun_throws_shadows_as_long_as_the_light_says(drawn, renderer_of):
    cars = DrawList.create(1, 8)
    put_car(cars, 0, 0, 0, 0.0, 0.0, np.pi / 2)
    views = looking([(-8.0, 0.0, 40.0)], pitch=1.5707, fov=0.9)
    ends = []
    for longest in (4.0, 10.0):
        light = dataclasses.replace(LOW, longest_shadow=longest, sun_colour=(4.0, 3.0, 2.0))
        renderer = renderer_of(plain(ObjectClass.ROAD, "asphalt"), car_parts(), light)
        bare = drawn(renderer, views).rgb[0].astype(int)
        dark = bare - drawn(renderer, views, cars).rgb[0].astype(int)
        # Rows go west: the sun is in the east.
        ends.append(np.flatnonzero(dark.max(axis=(1, 2)) > 8).max())
    metre = 64 / (40 * np.tan(0.45))
    assert ends[1] - ends[0] > 5 * metre
