"""Hillsides and heaths: what grows on ground that nobody tends."""

import numpy as np
import pytest

from eyas.engine.mesh.flat import quads
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.renderer import build_renderer
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.mesh import Material, Surface
from eyas.maps.textures.shipped import build_textures

from ...kit.small_city import DAY, looking, scene_of


def slope(surface, rise, texture="lawn"):
    corners = [[(x, y, rise * x) for x, y in ((-40, -40), (40, -40), (40, 40), (-40, 40))]]
    return quads(corners, np.zeros((1, 4, 2)), Material(texture, surface=surface))


@pytest.fixture
def seen(drawn, renderer_of):
    def see(mesh, height=60.0):
        scene = scene_of([mesh], [0])
        views = looking([(0.0, 0.0, height)], pitch=1.5707, fov=0.6)
        return drawn(renderer_of(scene, lighting=DAY), views, size=(48, 48)).rgb[0].astype(float)

    return see


def test_rock_shows_where_a_hill_is_steep_and_grass_where_it_is_not(seen):
    def greenness(rise):
        colour = seen(slope(Surface.HILLSIDE, rise)).mean(axis=(0, 1))
        return colour[1] / colour[0]

    assert greenness(0.2) > 1.05
    assert greenness(1.6) < greenness(0.2) - 0.1


@pytest.mark.parametrize(
    ("surface", "texture"), [(Surface.HILLSIDE, "lawn"), (Surface.HEATH, "soil")]
)
def test_wild_ground_is_uneven_over_metres(seen, surface, texture):
    wild, plain = seen(slope(surface, 0.0, texture)), seen(slope(Surface.MATT, 0.0, texture))

    def over_metres(picture):
        return picture.reshape(6, 8, 6, 8, 3).mean(axis=(1, 3)).std(axis=(0, 1)).max()

    assert over_metres(wild) > 2 * over_metres(plain)


def beside(surface, far, texture="lawn"):
    """Level ground whose u is a distance, 0 at its western edge and `far` at the other."""
    corners = [[(x, y, 0.0) for x, y in ((-20, -20), (20, -20), (20, 20), (-20, 20))]]
    uvs = [[(0.0, 0.0), (far, 0.0), (far, 0.0), (0.0, 0.0)]]
    return quads(corners, uvs, Material(texture, surface=surface))


def test_a_shore_is_wet_mud_at_the_water_and_land_far_from_it(seen):
    ground = seen(beside(Surface.HEATH_SHORE, 40.0, "soil"), height=65.0)
    bright = ground.mean(axis=2).mean(axis=1)  # the camera's up is east
    water, land = bright[-1], bright[: len(bright) // 2].mean()
    assert water < 0.75 * land


def test_a_path_is_trodden_inside_and_grass_at_its_edge(seen):
    path = seen(beside(Surface.HILLSIDE_PATH, 0.8), height=65.0)
    inside, edge = path[4:40].mean(axis=(0, 1)), path[-1].mean(axis=0)
    assert inside[0] / inside[1] > 1.2 * edge[0] / edge[1]


def test_a_desert_has_ridges_across_its_wind(images, drawn, tmp_path):
    """Seen from 25 m; the wind blows at -35 degrees."""
    scene = scene_of([slope(Surface.DESERT, 0.6, "sand")], [0])
    geometry = build_geometry(scene, PartLibrary(()), {**images, "sand": build_textures()["sand"]})
    renderer = build_renderer(scene, geometry, DAY, cache=tmp_path)
    views = looking([(0.0, 0.0, 25.0)], pitch=1.5707, fov=0.9)
    sandy = drawn(renderer, views, size=(128, 128)).rgb[0].mean(axis=2)
    sandy -= sandy.mean()
    # The camera's up is east, its right is south.
    power = np.square(np.abs(np.fft.fft2(sandy)))
    across, down = np.meshgrid(*2 * [np.fft.fftfreq(128)])
    way = np.deg2rad(-35.0)
    with_wind = np.abs(-down * np.cos(way) - across * np.sin(way))
    along_crests = np.abs(down * np.sin(way) - across * np.cos(way))
    fine = np.hypot(across, down) > 0.04
    assert power[fine & (with_wind > 2 * along_crests)].sum() > 2 * (
        power[fine & (along_crests > 2 * with_wind)].sum()
    )
