"""Rain: dark, mirroring roads with puddles, and streaks that lamps light."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.mesh.flat import quads
from eyas.engine.render.bake.puddles import hollows
from eyas.engine.render.kernels.surface.snow import Bed
from eyas.engine.render.pack.materials import snow_beds
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.scene import Lamps, ObjectClass
from eyas.engine.world.build.materials import material

from ...kit.small_city import DAY, city_scene, looking, scene_of

DRY = dataclasses.replace(
    DAY, fog_density=0.0, sun_colour=(0.0, 0.0, 0.0), zenith_colour=(0.3, 0.3, 0.3)
)
DARK = ("ambient_up", "ambient_down", "zenith_colour", "horizon_colour")
WET = dataclasses.replace(DRY, wet=1.0)
FALLING = dataclasses.replace(DRY, rain=0.8)


def ground(texture):
    corners = [[(-60, -60, 0.0), (60, -60, 0.0), (60, 60, 0.0), (-60, 60, 0.0)]]
    return quads(corners, np.zeros((1, 4, 2)), Material(texture))


def plate(texture, kind=ObjectClass.ROAD):
    scene = scene_of([ground(texture)], [0])
    scene.object_class = np.full(max(len(scene.object_class), 1), int(kind), np.int32)
    return scene


@pytest.fixture
def seen(drawn, renderer_of):
    def see(scene, lighting, pitch=1.5707, height=20.0, size=(96, 128), instant=None):
        views = looking([(0.3, 0.2, height)], pitch=pitch, fov=1.0)
        views.instant = None if instant is None else np.array([instant])
        return drawn(renderer_of(scene, lighting=lighting), views, size=size).rgb[0].astype(int)

    return see


def test_a_wet_road_is_darker_from_above_and_mirrors_the_sky_at_a_grazing_angle(seen):
    road = plate("asphalt")
    dry, wet = seen(road, DRY).mean(), seen(road, WET).mean()
    assert wet < 0.85 * dry
    # Rows just below the horizon.
    dry, wet = (seen(road, light, pitch=0.0, height=1.5)[50:54].mean() for light in (DRY, WET))
    assert wet > 1.3 * dry


def test_puddles_cover_part_of_a_road_and_lawns_have_nearly_none(seen):
    # Seen at 20 degrees, where puddles mirror more than the film between them.
    low = {"pitch": 0.35, "height": 12.0, "size": (192, 256)}
    for texture, kind, least, most in (
        ("asphalt", ObjectClass.ROAD, 0.03, 0.4),
        ("lawn", ObjectClass.GROUND, 0.0, 0.1),
    ):
        scene = plate(texture, kind)
        change = (seen(scene, WET, **low) - seen(scene, DRY, **low))[60:, :, 2]
        typical = np.median(change)
        assert least <= (change > typical + 12).mean() <= most, texture


def test_rain_darkens_what_is_porous_but_mirrors_little_there(seen):
    lawn = plate("lawn", ObjectClass.GROUND)
    assert seen(lawn, WET).mean() < 0.95 * seen(lawn, DRY).mean()
    flat = {"pitch": 0.0, "height": 1.5}
    road = plate("asphalt")
    on_lawn, on_road = (
        (seen(scene, WET, **flat) - seen(scene, DRY, **flat))[50:54].mean()
        for scene in (lawn, road)
    )
    assert on_lawn < 0.5 * on_road


def test_lawn_and_soil_are_porous_and_paving_is_not():
    looks = (material("lawn"), material("soil"), material("paving"))
    found = snow_beds(plate("asphalt"), PartLibrary(()), looks)
    assert list(found) == [Bed.POROUS, Bed.POROUS, Bed.OPEN]


def test_a_lamp_is_mirrored_between_it_and_the_eye(seen):
    night = dataclasses.replace(
        DRY, lamps=1.0, ambient_up=(0.0,) * 3, ambient_down=(0.0,) * 3, horizon_colour=(0.0,) * 3
    )
    night = dataclasses.replace(night, zenith_colour=(0.0,) * 3)
    road = plate("asphalt")
    road.lamps = Lamps(
        np.array([[24.0, 0.0, 8.0]], np.float32), np.array([[0, 0, -1.0]], "f4"), 16.0
    )
    view = {"pitch": 0.4, "height": 8.0, "size": (120, 161)}
    dry = seen(road, night, **view)
    wet = seen(road, dataclasses.replace(night, wet=1.0), **view)
    more = (wet - dry).mean(axis=2)
    row, column = np.unravel_index(np.argmax(more), more.shape)
    assert more[row, column] > 10
    # Eye and lamp are equally high: the mirror image lies half way, 12 m ahead of both.
    metres = 8.0 / np.tan(0.4 + np.arctan((row - 59.5) / (80.5 / np.tan(0.5))))
    assert metres == pytest.approx(12.0, abs=2.5)
    assert abs(column - 80) <= 6


def test_hollows_repeat_without_a_seam():
    table = hollows()
    words = table.reshape(64, 64, 2).astype(np.int64)
    here, right = words[..., 0] & 255, words[..., 0] >> 8
    below = words[..., 1] & 255
    np.testing.assert_array_equal(right, np.roll(here, -1, axis=1))
    np.testing.assert_array_equal(below, np.roll(here, -1, axis=0))
    assert 0.4 < (here / 255.0).mean() < 0.6


def test_drops_fall_fast_and_are_the_same_at_the_same_time(seen):
    city, size = city_scene(), (240, 320)
    still = seen(city, FALLING, pitch=0.2, size=size)
    now, again, later = (
        seen(city, FALLING, pitch=0.2, size=size, instant=t) for t in (3.0, 3.0, 3.5)
    )
    np.testing.assert_array_equal(now, again)
    touched = (now != still).any(axis=2).mean()
    assert 0.005 < touched < 0.5
    assert (now != later).any()
    np.testing.assert_array_equal(seen(city, DRY, pitch=0.2, size=size, instant=3.0), still)


def test_streaks_are_long_and_upright(seen):
    """At the horizon, differences go on along columns, not along rows."""
    city = city_scene()
    view = {"pitch": 0.0, "height": 6.0, "size": (240, 320)}
    drops = seen(city, FALLING, **view, instant=3.0) - seen(city, FALLING, **view)
    drops = np.abs(drops).sum(axis=2).astype(float)
    along = (drops[:-6] * drops[6:]).sum()
    across = (drops[:, :-6] * drops[:, 6:]).sum()
    assert along > 2.0 * across


def test_lamps_light_the_drops_below_them(seen):
    dark = dataclasses.replace(FALLING, **dict.fromkeys(DARK, (0.0, 0.0, 0.0)))
    road = plate("asphalt")
    spots = np.array([[x, y, 6.0] for x in range(2, 12, 3) for y in range(-6, 7, 3)], np.float32)
    road.lamps = Lamps(spots, np.tile(np.array([0, 0, -1.0], "f4"), (len(spots), 1)), 1.0)
    view = {"pitch": 0.1, "height": 3.0, "size": (240, 320)}
    lit = dataclasses.replace(dark, lamps=1.0)
    bright = (seen(road, lit, **view, instant=3.0) - seen(road, lit, **view))[:100]
    unlit = (seen(road, dark, **view, instant=3.0) - seen(road, dark, **view))[:100]
    assert bright.max() > 10
    assert unlit.max() == 0
    assert bright[..., 0].sum() > bright[..., 2].sum()  # as warm as the lamps


def test_daytime_lamps_glow_and_light_nothing(drawn, renderer_of):
    glowing = dataclasses.replace(DRY, daytime_lamps=1.0)
    lamp = quads(
        [[(10, 1, 1), (10, -1, 1), (10, -1, 3), (10, 1, 3)]],
        np.zeros((1, 4, 2)),
        Material("plain", (0.5, 0.4, 0.3), surface=Surface.LAMP, emission=3.0),
    )
    scene = scene_of([lamp, ground("asphalt")], [0, 1])
    views = looking([(0, 0, 2.0)], fov=0.9)
    views.tent = False
    off, on = (drawn(renderer_of(scene, lighting=light), views) for light in (DRY, glowing))
    there = off.depth[0] < 10.5
    lit = there & (off.rgb[0] != on.rgb[0]).any(axis=2)
    assert lit.sum() > 50
    assert (on.rgb[0][~there] == off.rgb[0][~there]).all()
