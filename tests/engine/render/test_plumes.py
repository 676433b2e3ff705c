"""Smoke over roofs, and spray behind vehicles."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.state.draw import DrawList

from ...kit.small_city import DAY, city_scene, floor, looking, scene_of

CLEAR = dataclasses.replace(DAY, fog_density=0.0)
SMOKY = dataclasses.replace(CLEAR, smoke=3)
SPRAY = dataclasses.replace(CLEAR, spray=1.0)


def at(views, instant):
    return dataclasses.replace(views, instant=np.full(len(views.position), instant))


@pytest.fixture(scope="module")
def smoke(renderer_of):
    return {light: renderer_of(city_scene(), lighting=light) for light in (CLEAR, SMOKY)}


@pytest.fixture(scope="module")
def wet(renderer_of):
    return renderer_of(scene_of([floor()], [0]), lighting=SPRAY)


def fast(speed: float, x: float = 20.0) -> DrawList:
    """Return a vehicle that drives away from the camera, without its body."""
    movers = DrawList.create(1, 1)
    movers.spray = np.array([[[x, 0.0, 0.0, speed, 0.0, 0.9, 3.0, 0.0]]], np.float32)
    return movers


def test_smoke_rises_drifts_and_is_the_same_at_the_same_instant(drawn, smoke):
    source = smoke[SMOKY].packed[1].smoke[0]
    eye = (float(source[0]) - 40.0, float(source[1]), float(source[2]) + 4.0)
    views = looking([eye], fov=0.9)
    clear = drawn(smoke[CLEAR], at(views, 9.0)).rgb[0].astype(int)
    first, again, later = (drawn(smoke[SMOKY], at(views, t)) for t in (9.0, 9.0, 10.3))
    np.testing.assert_array_equal(first.rgb, again.rgb)
    changed = np.abs(first.rgb[0] - clear).max(axis=2) > 6
    assert 0.002 < changed.mean() < 0.5
    assert (first.rgb != later.rgb).any()
    # It is no object: depth and ids are those of what is behind.
    np.testing.assert_array_equal(first.depth, drawn(smoke[CLEAR], at(views, 9.0)).depth)


def test_smoke_has_an_end_in_what_stands_before_it(drawn, smoke):
    """From inside a tower that hides all, nothing of it is seen."""
    views = at(looking([(0.0, 0.0, -5.0)], pitch=1.5, fov=0.5), 5.0)
    np.testing.assert_array_equal(drawn(smoke[SMOKY], views).rgb, drawn(smoke[CLEAR], views).rgb)


def test_spray_grows_with_speed_from_none_in_slow_traffic(drawn, wet):
    views = at(looking([(0.0, 0.0, 5.0)], pitch=0.2, fov=0.9), 4.0)
    none = drawn(wet, views).rgb[0].astype(int)
    light = [
        np.abs(drawn(wet, views, fast(speed)).rgb[0].astype(int) - none).sum()
        for speed in (7.5, 12.0, 20.0)
    ]
    assert light[0] == 0
    assert 0 < light[1] < 0.7 * light[2]


def test_spray_is_behind_the_vehicle(drawn, wet):
    views = at(looking([(20.0, 0.0, 30.0)], pitch=1.5707, fov=0.9), 4.0)
    none = drawn(wet, views).rgb[0].astype(int)
    change = np.abs(drawn(wet, views, fast(20.0)).rgb[0].astype(int) - none).sum(axis=(1, 2))
    # The camera looks down, its upper edge east: the vehicle drives upwards.
    assert change[60:].sum() > 10 * change[:40].sum()


@pytest.mark.parametrize("samples", [1, 2, 4])
def test_plumes_do_not_depend_on_other_views_or_bands(drawn, wet, samples):
    places = [(0.0, y, 5.0) for y in (-4.0, 0.0, 4.0)]
    views = at(looking(places, pitch=0.2, fov=0.9), 4.0)
    together = drawn(wet, views, fast(20.0), samples=samples).rgb
    for k, place in enumerate(places):
        one = at(looking([place], pitch=0.2, fov=0.9), 4.0)
        alone = drawn(wet, one, fast(20.0), samples=samples).rgb[0]
        np.testing.assert_array_equal(alone, together[k])


def test_dry_roads_and_calm_cameras_show_none(drawn, renderer_of):
    dry = renderer_of(scene_of([floor()], [0]), lighting=CLEAR)
    views = at(looking([(0.0, 0.0, 5.0)], pitch=0.2, fov=0.9), 4.0)
    np.testing.assert_array_equal(drawn(dry, views, fast(20.0)).rgb, drawn(dry, views).rgb)
