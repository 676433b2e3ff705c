"""Water mirrors the sky when looked along, and is dark when looked into; it has waves."""

import numpy as np
import pytest
import shapely

from eyas.engine.mesh.flat import flat_polygon
from eyas.engine.render.kernels.scalars import i4
from eyas.engine.render.kernels.surface.shade import water_slope
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.renderer import build_renderer
from eyas.engine.render.textures.mipmap import packed_layers
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.world.build.materials import TEXTURES
from eyas.lanes import kernel
from eyas.lanes.vector import lane, splat
from eyas.maps.textures.shipped import build_textures

from ...kit.small_city import DAY, GROUND, looking, scene_of


@pytest.fixture(scope="module")
def lake(tmp_path_factory):
    water = Material("water", (0.2, 0.48, 0.62), Surface.WATER)
    mesh = flat_polygon(shapely.box(-400, -400, 400, 400), 0.0, water, TEXTURES["water"])
    scene = scene_of([mesh], [GROUND])
    folder = tmp_path_factory.mktemp("shadows")
    geometry = build_geometry(scene, PartLibrary(()), build_textures())
    return build_renderer(scene, geometry, DAY, cache=folder)


def picture_of(lake, drawn, pitch):
    # Away from the sun, so that its glitter is not in the picture.
    return drawn(lake, looking([(0.0, 0.0, 8.0)], yaw=-0.8, pitch=pitch, fov=0.3)).rgb[0] / 255.0


def test_water_is_brighter_along_than_straight_down(lake, drawn):
    along, down = picture_of(lake, drawn, 0.16), picture_of(lake, drawn, 1.5)
    assert along.mean() > 1.15 * down.mean()
    horizon = np.array(DAY.horizon_colour) / max(DAY.horizon_colour)
    tint = [np.abs(p.mean((0, 1)) / p.mean((0, 1)).max() - horizon).sum() for p in (along, down)]
    assert tint[0] < 0.6 * tint[1]


def test_water_has_waves_that_calm_down_with_distance(lake, drawn):
    near, middle = picture_of(lake, drawn, 1.5), picture_of(lake, drawn, 0.3)
    assert near.std(axis=(0, 1)).max() > 0.01
    assert middle.std(axis=(0, 1)).max() > 0.01
    far = drawn(lake, looking([(0.0, 0.0, 8.0)], yaw=-0.8, pitch=0.05, fov=0.05)).rgb[0] / 255.0
    assert np.diff(far, axis=1).std() < np.diff(middle, axis=1).std()


def test_slopes_of_the_waves_are_even(lake):
    linear = (build_textures()["water"][..., :2] / 255.0 + 0.055) / 1.055
    assert (linear**2.4).mean(axis=(0, 1)) == pytest.approx([0.5, 0.5], abs=0.01)


@kernel
def slopes(textures, u, v):
    east, north = water_slope(textures, i4(0), splat(i4(0)), False, splat(u), splat(v))
    return lane(east, 0), lane(north, 0)


def test_small_waves_are_the_large_ones_turned_by_a_right_angle():
    """On water whose texture slopes alike everywhere, by `a` along its u and `b` along its v."""
    image = np.full((256, 256, 4), (200, 120, 0, 255), np.uint8)
    (texture,) = packed_layers({"water": image}, ["water"])
    a, b = (((int(texture[0]) >> shift & 255) / 255.0) ** 2 - 0.5 for shift in (0, 8))
    assert a > 0.05 > -0.05 > b
    # Their own u runs north and their own v west; they are half as steep.
    found = slopes(texture[None], np.float32(0.3), np.float32(0.6))
    assert found == pytest.approx((a - 0.5 * b, b + 0.5 * a), abs=1e-3)
