"""Snow: where it lies, and where it does not."""

import dataclasses

import numpy as np
import pytest

from eyas.render.renderer import Renderer
from eyas.render.snow import ON_ROADS, snow_held
from eyas.state.draw import PartLibrary
from eyas.state.mesh import Material, Surface
from eyas.state.scene import ObjectClass
from eyas.world.materials import material
from eyas.world.shapes import box, quads

from .small_city import DAY, looking, scene_of

SNOW = dataclasses.replace(DAY, snow=1.0, fog_density=0.0)


def plate(texture, surface=Surface.MATT):
    corners = [[(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)]]
    return quads(corners, np.zeros((1, 4, 2)), Material(texture, surface=surface))


def scene_with(mesh, kind):
    scene = scene_of([mesh], [0])
    scene.object_class = np.full(max(len(scene.object_class), 1), int(kind), np.int32)
    return scene


@pytest.fixture
def seen(drawn, images, tmp_path):
    def see(texture, kind, lighting):
        scene = scene_with(plate(texture), kind)
        renderer = Renderer(scene, PartLibrary(()), lighting, images, shadow_cache=tmp_path)
        views = looking([(0.3, 0.2, 20.0)], pitch=1.5707, fov=1.0)
        return drawn(renderer, views).rgb[0].astype(float)

    return see


def test_grass_turns_white_and_the_road_stays_dark(seen):
    grass = seen("lawn", ObjectClass.GROUND, SNOW)
    assert grass.min() > 150
    assert np.ptp(grass, axis=2).mean() < 25
    bare = seen("asphalt", ObjectClass.ROAD, dataclasses.replace(SNOW, snow=0.0))
    road = seen("asphalt", ObjectClass.ROAD, SNOW)
    assert bare.mean() < road.mean() < 0.5 * (bare.mean() + grass.mean())
    assert np.median(road) < np.median(bare) + 25


def test_walls_hold_none(drawn, renderer_of):
    corners = [[(10, 8, -4), (10, -8, -4), (10, -8, 8), (10, 8, 8)]]
    wall = quads(corners, np.zeros((1, 4, 2)), material("plain", (0.6, 0.2, 0.2)))
    views = looking([(0, 0, 2)], fov=0.6)
    snowy, bare = [
        drawn(renderer_of(scene_of([wall], [0]), lighting=light), views).rgb
        for light in (SNOW, dataclasses.replace(SNOW, snow=0.0))
    ]
    np.testing.assert_array_equal(snowy, bare)


def test_what_moves_and_water_hold_none_and_roads_little():
    road, roof, car = material("asphalt"), material("bitumen"), Material(surface=Surface.PAINT)
    water = Material(surface=Surface.WATER)
    parts = PartLibrary(((box((1, 1, 1), (0, 0, 0), car, 1.0),),))
    scene = scene_with(plate("asphalt"), ObjectClass.ROAD)
    held = snow_held(scene, parts, (road, roof, car, water))
    np.testing.assert_allclose(held, [ON_ROADS, 1.0, 0.0, 0.0], rtol=1e-6)
