"""Hillsides and heaths: what grows on ground that nobody tends."""

import numpy as np
import pytest

from eyas.mesh.flat import quads
from eyas.state.mesh import Material, Surface

from .small_city import DAY, looking, scene_of


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
