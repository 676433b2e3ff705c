"""Baked shadows: how dense, how sharp and how whole they are."""

import dataclasses
import math

import numpy as np
import pytest

from eyas.engine.mesh.solids import cylinder
from eyas.engine.render.bake.shadows import CARDS, bake_shadows
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.pack.light import tone_table
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.scene import Fixtures

from ...kit.small_city import DAY, GROUND, TOWER, floor, looking, scene_of, tower, untiled

SUN = np.array(DAY.sun_direction)
SOUTH = (0.0, -math.sqrt(0.5), math.sqrt(0.5))
"""45 degrees high."""


def shaded(shadows, points: np.ndarray) -> np.ndarray:
    """Return which points [m] lie in shadow, by the texel they are in."""
    column, line, height = (points @ shadows.rows[:, :3].T + shadows.rows[:, 3]).T
    unit = np.linalg.norm(shadows.rows[2, :3])
    height = np.maximum(height, 0.0)  # the map's zero is nothing at all
    return untiled(shadows)[line.astype(int), column.astype(int)] > height + 0.5 * unit


def sheet(side: float, count: int) -> Mesh:
    """Leaf cards of four triangles side by side, 6 m high."""
    middle = (np.arange(count) - (count - 1) / 2) * side
    x, y = (a.ravel() for a in np.meshgrid(middle, middle))
    place = np.column_stack([x, y, np.full(count**2, 6.0)])
    corner = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)])
    offset = np.column_stack([corner - 0.5, np.zeros(5)]) * side
    triangles = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    return Mesh(
        positions=(place[:, None] + offset).reshape(-1, 3).astype(np.float32),
        normals=np.tile(np.float32([0, 0, 1]), (5 * count**2, 1)),
        uvs=np.tile(corner, (count**2, 1)).astype(np.float32),
        triangles=(5 * np.arange(count**2)[:, None, None] + triangles).reshape(-1, 3).astype("i4"),
        materials=np.zeros(4 * count**2, np.int32),
        palette=(Material("leaves", surface=Surface.FOLIAGE),),
    )


@pytest.mark.parametrize("covered", [0.5, 1.0])
def test_leaves_keep_as_much_light_as_their_texture_covers(images, covered, tmp_path):
    leaves = images["leaves"].copy()
    rows, columns = np.indices((256, 256)) // 32
    leaves[..., 3] = np.where((rows + columns) % 2 < 2 * covered - 0.5, 255, 0)
    scene = scene_of([floor(60.0), sheet(2.0, 16)], [GROUND, TOWER])
    geometry = build_geometry(scene, PartLibrary(()), images | {"leaves": leaves})
    shadows = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    x, y = np.random.default_rng(0).uniform(-16, 16, (2, 20000)) - 6.0 / SUN[2] * SUN[:2, None]
    kept = shaded(shadows, np.column_stack([x, y, np.zeros(20000)])).mean()
    assert kept == pytest.approx(covered / CARDS, rel=0.1)


def test_the_map_depends_on_the_holes_of_leaves_and_not_on_their_colour(images, tmp_path):
    scene = scene_of([floor(20.0), sheet(2.0, 2)], [GROUND, TOWER])
    for changed in (None, 0, 3):
        leaves = images["leaves"].copy()
        if changed is not None:
            leaves[:, :128, changed] //= 2
        geometry = build_geometry(scene, PartLibrary(()), images | {"leaves": leaves})
        bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
        assert len(list(tmp_path.rglob("*.npy"))) == (2 if changed == 3 else 1)


def test_the_shadow_of_a_pole_thinner_than_a_texel_is_whole(images, tmp_path):
    pole = cylinder((0.05, 0.05), (0.0, 8.0), 6, Material("plain"))
    pose = np.eye(4, dtype=np.float32)[None, :3]
    fixtures = Fixtures(((pole,),), np.zeros(1, np.int32), pose, np.zeros(1, np.int32))
    geometry = build_geometry(scene_of([floor(40.0)], [GROUND], fixtures), PartLibrary(()), images)
    for turn in np.linspace(0.0, 1.5, 7):
        sun = np.array([0.6 * math.cos(turn), 0.6 * math.sin(turn), 0.8])
        shadows = bake_shadows(geometry, tuple(sun), 0.0, tmp_path)
        along = np.linspace(1.0, 7.0, 200)[:, None]
        points = np.array([0.0, 0.0, 1.0]) * along - sun / sun[2] * along
        beside = 0.3 * np.array([-math.sin(turn), math.cos(turn), 0.0])
        assert shaded(shadows, points).all()
        assert not shaded(shadows, points + beside).any()


def light_across(renderer_of, drawn, height: float, light=DAY) -> tuple[np.ndarray, np.ndarray]:
    """Return places north of a tower's foot [m], and the light there from 0 (shade) to 1 (sun)."""
    light = dataclasses.replace(light, sun_direction=SOUTH, fog_density=0.0)
    scene = scene_of([floor(200.0, "plain"), tower(0, 0, 30, height)], [GROUND, TOWER])
    views = looking([(0.0, 15.0 + height, 30.0)], pitch=np.pi / 2, fov=0.2)
    seen = drawn(renderer_of(scene, lighting=light), views, size=(9, 600)).rgb[0, 4, :, 1]
    radiance = np.interp(seen, tone_table(), np.arange(16384))
    north = height + (299.5 - np.arange(600)) * (2 * 30.0 * math.tan(0.1) / 600)
    dark, bright = radiance[-50:].max(), radiance[:50].min()
    return north, (radiance - dark) / (bright - dark)


def test_the_edge_of_a_shadow_lies_where_the_sun_says(renderer_of, drawn):
    # In steps of a quarter of a texel on the ground, so that what it is off by rounding cancels.
    off = []
    for height in 12.0 + np.arange(4) * 0.25 * 0.2 * math.sqrt(2):
        north, light = light_across(renderer_of, drawn, height)
        off.append(north[np.abs(light - 0.5).argmin()] - height)
    assert np.abs(off).max() < 0.2 * math.sqrt(2) + 0.1
    # A point is looked up 0.22 m over the ground, where the shadow ends so much earlier.
    assert np.mean(off) == pytest.approx(-0.22, abs=0.06)
