"""Autumn: leaves on the ground under trees, and in the air near them."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.mesh.flat import quads
from eyas.engine.state.mesh import Material
from eyas.engine.state.scene import ObjectClass

from ...kit.small_city import DAY, looking, scene_of, trees_at

BARE = dataclasses.replace(DAY, fog_density=0.0)
LITTER = dataclasses.replace(BARE, litter=1.0)
FALLING = dataclasses.replace(BARE, leaves=1.0)


@pytest.fixture(scope="module")
def grove():
    corners = [[(-100, -100, 0.0), (100, -100, 0.0), (100, 100, 0.0), (-100, 100, 0.0)]]
    lawn = quads(corners, np.zeros((1, 4, 2)), Material("asphalt"))
    trees = trees_at([(40.0, y) for y in range(-40, 41, 8)])
    trees.object_id[:] = 1
    scene = scene_of([lawn], [0], trees)
    scene.object_class = np.array([int(ObjectClass.PAVEMENT), int(ObjectClass.TREE)], np.int32)
    scene.size = (200.0, 200.0)
    return scene


@pytest.fixture
def seen(drawn, renderer_of, grove):
    def see(lighting, position, instant=None, **how):
        views = looking([position], **how)
        views.instant = None if instant is None else np.array([instant])
        return drawn(renderer_of(grove, lighting=lighting), views, size=(120, 160))

    return see


def test_leaves_lie_under_trees_and_not_far_from_them(seen):
    for x, least, most in ((36.0, 0.04, 0.95), (-60.0, 0.0, 0.0)):
        view = {"position": (x, 0.0, 8.0), "pitch": 1.5707, "fov": 0.8}
        bare, littered = (seen(light, **view) for light in (BARE, LITTER))
        ground = bare.object_id[0] == 0
        change = np.abs(littered.rgb[0].astype(int) - bare.rgb[0]).max(axis=2)
        assert least <= (change[ground] > 20).mean() <= most, x
        assert (change[~ground] == 0).all()


def test_fallen_leaves_are_yellow_to_brown(seen):
    view = {"position": (34.0, 0.0, 8.0), "pitch": 1.5707, "fov": 0.8}
    bare, littered = (seen(light, **view).rgb[0].astype(int) for light in (BARE, LITTER))
    leaves = littered[np.abs(littered - bare).max(axis=2) > 40]
    assert (leaves[:, 0] > leaves[:, 1]).mean() > 0.95
    assert (leaves[:, 1] > leaves[:, 2]).mean() > 0.95


def test_leaves_fall_near_trees(seen):
    def touched(x):
        view = {"position": (x, -45.0, 4.0), "yaw": np.pi / 2, "pitch": 0.1, "fov": 0.9}
        still = seen(FALLING, **view).rgb[0].astype(int)
        changes = [np.abs(seen(FALLING, instant=t, **view).rgb[0] - still) for t in (1.0, 2.0, 3.0)]
        return np.mean([(change.max(axis=2) > 8).mean() for change in changes])

    assert touched(34.0) > 2 * touched(-60.0)
    assert touched(34.0) < 0.4
