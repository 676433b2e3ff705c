"""Shadows fall where the sun says, and survive damaged caches."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import rays
from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import box
from eyas.engine.render.bake.shadows import bake_shadows
from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.state.draw import DrawList, PartLibrary
from eyas.engine.state.mesh import Material

from ...kit.small_city import (
    DAY,
    GROUND,
    TOWER,
    car_parts,
    floor,
    looking,
    put_car,
    scene_of,
    tower,
    untiled,
)

SUN = np.array(DAY.sun_direction)


@pytest.fixture(scope="module")
def geometry(images):
    scene = scene_of([floor(), tower(0.0, 0.0, 10.0, 20.0)], [GROUND, TOWER])
    return build_geometry(scene, PartLibrary(()), images)


def in_tower_shadow(x: np.ndarray, y: np.ndarray, margin: float) -> np.ndarray:
    """Whether the way from the ground to the sun meets the tower grown by a margin [m]."""
    far = 20.0 / SUN[2]
    steps = np.linspace(0.0, far, 400)[:, None]
    px, py = x + SUN[0] * steps, y + SUN[1] * steps
    return ((np.abs(px) < 5 + margin) & (np.abs(py) < 5 + margin)).any(axis=0)


def test_the_shadow_of_a_tower_lies_where_the_sun_says(geometry, tmp_path):
    shadows = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    x, y = np.random.default_rng(0).uniform(-30, 30, (2, 4000))
    points = np.column_stack([x, y, np.full(4000, 0.05)])
    column, line, height = (points @ shadows.rows[:, :3].T + shadows.rows[:, 3]).T
    whole = untiled(shadows)
    lines, columns = whole.shape
    on_map = (column > 0) & (column < columns - 1) & (line > 0) & (line < lines - 1)
    lit = np.ones(4000, bool)
    at = line[on_map].astype(int), column[on_map].astype(int)
    lit[on_map] = whole[at] <= np.maximum(height[on_map], 0) + 65000 * 0.2 / 40
    assert not lit[in_tower_shadow(x, y, -0.5)].any()
    assert lit[~in_tower_shadow(x, y, 0.5)].all()
    assert 0.05 < np.mean(~lit) < 0.5


def test_pictures_are_dark_in_the_shadow_and_nowhere_else(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor(200.0, "plain"), tower(0, 0, 10, 20)], [GROUND, TOWER]))
    views = looking([(0.0, 0.0, 80.0)], pitch=np.pi / 2, fov=0.9)
    views.tent = False
    picture = drawn(renderer, views)
    ray = rays(views.rotation[0], 128, 96, 0.9)
    x, y = (80.0 / -ray[..., 2] * np.moveaxis(ray[..., :2], -1, 0)).reshape(2, -1)
    ground = (picture.object_id[0] == GROUND).ravel()
    light = picture.rgb[0].reshape(-1, 3).astype(int).sum(-1)
    dark = light[ground & in_tower_shadow(x, y, -1.0)]
    bright = light[ground & ~in_tower_shadow(x, y, 1.0)]
    assert len(dark) > 100
    assert dark.max() < 0.8 * bright.min()
    assert bright.max() - bright.min() < 30  # no acne


def test_cars_throw_shadows_away_from_the_sun(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor(200.0, "plain")], [GROUND]), car_parts())
    draw_list = DrawList.create(1, 6)
    put_car(draw_list, 0, 0, 0, 0.0, 0.0, 0.3)
    views = looking([(0.0, 0.0, 25.0)], pitch=np.pi / 2, fov=0.5)
    with_car, without = drawn(renderer, views, draw_list), drawn(renderer, views)
    darker = without.rgb[0].astype(int).sum(-1) - with_car.rgb[0].astype(int).sum(-1)
    darker[with_car.object_id[0] != GROUND] = 0
    ray = rays(views.rotation[0], 128, 96, 0.5)
    position = 25.0 / -ray[..., 2, None] * ray[..., :2]
    middle = (position * darker[..., None]).sum((0, 1)) / darker.sum()
    assert darker.max() > 100
    assert middle @ SUN[:2] < -0.2  # on the far side
    far = np.linalg.norm(position, axis=-1) > 5.0
    assert not darker[far].any()


def test_a_baked_map_is_kept_and_a_damaged_one_made_anew(geometry, tmp_path):
    first = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    (file,) = tmp_path.rglob("*.npy")
    written = file.stat().st_ino
    again = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    assert file.stat().st_ino == written
    np.testing.assert_array_equal(again.heights, first.heights)
    whole = file.read_bytes()
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 0x55
    for damaged in (b"", b"no arrays", whole[: len(whole) // 2], bytes(flipped)):
        file.unlink()  # it is mapped
        file.write_bytes(damaged)
        np.testing.assert_array_equal(
            bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path).heights, first.heights
        )
        assert file.read_bytes() == whole


def test_another_sun_has_another_map(geometry, tmp_path):
    bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path)
    bake_shadows(geometry, (0.6, 0.0, 0.8), 0.0, tmp_path)
    assert len(list(tmp_path.rglob("*.npy"))) == 2


def test_a_cache_that_cannot_be_written_does_not_matter(geometry, tmp_path):
    (tmp_path / "file").write_text("in the way")
    shadows = bake_shadows(geometry, DAY.sun_direction, 0.0, tmp_path / "file" / "below")
    assert shadows.heights.any()


def test_a_car_does_not_shade_itself(renderer_of, drawn):
    renderer = renderer_of(scene_of([floor()], [GROUND]), car_parts())
    draw_list = DrawList.create(1, 6)
    put_car(draw_list, 0, 0, 0, 0.0, 0.0, 0.0)
    views = looking([(1.6, 0.0, 12.0)], pitch=np.pi / 2, fov=0.3)
    whole = drawn(renderer, views, draw_list)
    draw_list.part[0, 1:] = -1  # the body alone: nothing above the bonnet
    np.testing.assert_array_equal(
        whole.rgb[0, 48, 64], drawn(renderer, views, draw_list).rgb[0, 48, 64]
    )


def test_a_car_throws_the_shadow_of_a_body_and_a_shorter_cabin(renderer_of, drawn):
    bonnet = box((4.0, 1.8, 0.8), (0, 0, 0.6), Material(), 1.0)
    cabin = box((1.6, 1.6, 0.6), (0.0, 0, 1.3), Material(), 1.0)
    parts = PartLibrary(((concatenate([bonnet, cabin]),),))
    cars = DrawList.create(1, 1)
    cars.part[0, 0], cars.object_id[0, 0] = 0, 1 << 16
    cars.pose[0, 0] = np.eye(4)[:3]
    low = np.array([0.0, -1.0, 1.0]) / np.sqrt(2)  # 45 degrees high, in the south
    light = dataclasses.replace(DAY, sun_direction=tuple(low))
    renderer = renderer_of(scene_of([floor(60.0, "plain")], [GROUND]), parts, light)
    # The body's shadow reaches 1 m beside it, the cabin's 1.5 m.
    places = [(x, 0.9 + y, 30.0) for y in (0.6, 1.12, 1.9) for x in (0.0, 1.7)]
    views = looking(places, pitch=np.pi / 2, fov=0.004)
    seen = drawn(renderer, views, cars, (9, 9)).rgb[:, 4, 4].astype(int).sum(axis=1)
    lit = seen.max()
    assert (seen > 0.8 * lit).tolist() == [False, False, False, True, True, True]


def test_a_person_throws_the_shadow_of_a_person(renderer_of, drawn):
    """Thin, as long as the person is high, and of nobody's legs apart."""
    torso = box((0.3, 0.46, 0.6), (0, 0, 1.1), Material(), 1.0)
    head = box((0.2, 0.18, 0.26), (0, 0, 1.58), Material(), 1.0)
    leg = box((0.16, 0.16, 0.82), (0, 0, 0.41), Material(), 1.0)
    walker = DrawList.create(1, 4)
    walker.part[0] = 0, 1, 2, 2
    walker.object_id[0] = 1 << 16
    walker.pose[0] = np.eye(4)[:3]
    walker.pose[0, 2:, :, 3] = [(0.2, 0.1, 0.0), (-0.2, -0.1, 0.0)]
    low = np.array([0.0, -1.0, 1.0]) / np.sqrt(2)  # 45 degrees high, in the south
    light = dataclasses.replace(DAY, sun_direction=tuple(low))
    parts = PartLibrary(((torso,), (head,), (leg,)))
    renderer = renderer_of(scene_of([floor(60.0, "plain")], [GROUND]), parts, light)
    middle = [(0.0, north, 30.0) for north in (0.5, 1.0, 1.4, 2.2)]
    aside = [(east, north, 30.0) for east in (-0.5, 0.5) for north in (0.7, 1.2)]
    views = looking(middle + aside, pitch=np.pi / 2, fov=0.003)
    seen = drawn(renderer, views, walker, (9, 9)).rgb[:, 4, 4].astype(int).sum(axis=1)
    shaded = seen < 0.8 * seen.max()
    assert shaded.tolist() == [True, True, True, False] + [False] * 4


def ground_beside(renderer_of, drawn, reach, *, shaded, with_bus=True):
    """Return the brightness of the ground at distances [m] from the long side of a bus.

    The bus is 3 m high, the sun stands in the south and the places in the north.
    """
    bus = PartLibrary(((box((9.0, 2.4, 3.0), (0, 0, 1.6), Material(), 1.0),),))
    list_ = DrawList.create(1, 1)
    if with_bus:
        list_.part[0, 0], list_.object_id[0, 0] = 0, 1 << 16
        list_.pose[0, 0] = np.eye(4)[:3]
    light = dataclasses.replace(DAY, sun_direction=(0.0, -np.sqrt(0.5), np.sqrt(0.5)))
    things = [floor(200.0, "plain"), tower(0, -40.0 if shaded else -140.0, 60, 60)]
    renderer = renderer_of(scene_of(things, [GROUND, TOWER]), bus, light)
    views = looking([(0.0, 1.2 + y, 40.0) for y in reach], pitch=np.pi / 2, fov=0.004)
    return drawn(renderer, views, list_, (9, 9)).rgb[:, 4, 4].astype(int).sum(axis=1)


def test_the_ground_beside_a_body_is_darker_in_shade_too(renderer_of, drawn):
    reach = (0.05, 0.3, 0.6, 1.6, 2.4)  # the last two in the shadow that the sun would throw
    bare = ground_beside(renderer_of, drawn, reach, shaded=True, with_bus=False)
    seen = ground_beside(renderer_of, drawn, reach, shaded=True)
    ratio = seen / bare
    assert ratio[0] < 0.75
    assert ratio[0] < ratio[1] - 0.05 < ratio[2] - 0.1
    assert ratio[2] < 0.97
    np.testing.assert_array_equal(seen[3:], bare[3:])  # no second shadow there


def test_the_shadow_of_a_body_ends_where_the_sun_says(renderer_of, drawn):
    reach = np.arange(2.0, 4.0, 0.05)
    bare = ground_beside(renderer_of, drawn, reach, shaded=False, with_bus=False)
    seen = ground_beside(renderer_of, drawn, reach, shaded=False)
    # Its top is 3.1 m high. The soft edge ends where the way to the sun is long enough in the box:
    # 0.15 m, and 0.12 m more for each metre before it.
    soft = 3.1 - (3.1 - 0.15 * np.sqrt(0.5)) / 1.12
    assert (seen[reach > 3.12] == bare[reach > 3.12]).all()
    assert (seen[reach < 3.08] < bare[reach < 3.08]).all()
    dark = seen[reach < 3.1 - soft - 0.05]
    assert np.ptp(dark) <= 3
    assert (dark < 0.8 * bare[: len(dark)]).all()
