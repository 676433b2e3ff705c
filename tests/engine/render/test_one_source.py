"""The shading kernels give the same bytes for eight pixels at once and for one at a time."""

import numpy as np
import pytest

from eyas.engine.render import renderer as module
from eyas.engine.render.kernels.draw import band_of, no_glass, view_light
from eyas.engine.render.kernels.scalars import u4
from eyas.engine.render.kernels.visibility.transform import view_of
from eyas.engine.state.draw import Picture
from eyas.engine.world.weather import (
    AUTUMN,
    CLEAR_DAY,
    CLEAR_NIGHT,
    DUST,
    FOG,
    NIGHT,
    RAIN,
    WINTER_DAY,
)
from eyas.lanes import address_of, compiled

from ...kit.small_city import car_parts, city_scene, city_traffic, looking, with_line
from .one_pixel import shade_pixel

SIZE = (100, 203)
MOON = NIGHT.light(2.5, 0.75)
WEATHERS = {
    **{"day": CLEAR_DAY, "foggy": FOG, "night": CLEAR_NIGHT, "snow": WINTER_DAY, "moon": MOON},
    **{"rain": RAIN.day, "wet night": RAIN.night, "dust": DUST.day, "autumn": AUTUMN.day},
}


@compiled
def one_by_one(geometry, light, scratch, movers, _output, task, _tables, places, found):
    job = task.job
    view = address_of(view_of(task, 0))
    lit = address_of(view_light(light.weather, job.light, 0))
    glass = address_of(no_glass(scratch, 0))
    band = address_of(
        band_of(geometry, light, lit, movers, 0, view, glass, task.until, scratch, 0, 0, 1)
    )
    for k in range(len(places)):
        row, column = places[k, 0], places[k, 1]
        shade = band.shade[row, column]
        word = u4(shade[0]) | (u4(shade[1]) << u4(8)) | (u4(shade[2]) << u4(16))
        word |= u4(shade[3]) << u4(24)
        found[k] = shade_pixel(band, band.key[row, column], word, row, column)


@pytest.mark.slow  # compiles the shading of surfaces a second time
@pytest.mark.parametrize("weather", WEATHERS)
def test_eight_pixels_at_once_are_the_same_as_one_at_a_time(renderer_of, monkeypatch, weather):
    monkeypatch.setattr(module, "thread_count", lambda: 1)  # so that one memory holds the picture
    drawing, calls = module.draw_views, []

    def kept(workers, *parts):
        calls.append(parts)
        drawing(workers, *parts)

    monkeypatch.setattr(module, "draw_views", kept)
    renderer = renderer_of(with_line(city_scene()), car_parts(), WEATHERS[weather])
    picture = Picture.create(1, *SIZE)
    # So narrow a view that mip levels are blended, over the line on the road.
    views = looking([(-95.0, 2.0, 9.0)], pitch=0.12, fov=0.75)
    views.tent = False
    renderer.draw(views, city_traffic(1), picture)
    rng = np.random.default_rng(1)
    places = np.stack([rng.integers(0, side, 10_000) for side in SIZE], axis=1).astype(np.int64)
    found = np.zeros(len(places), np.uint32)
    one_by_one(*calls[0], places, found)
    colours = np.stack([found & 255, (found >> 8) & 255, (found >> 16) & 255], axis=1)
    shown = picture.rgb[0][places[:, 0], places[:, 1]]
    dimmer = (shown < colours).any(axis=1)
    brighter = (shown > colours).any(axis=1)
    assert not dimmer.any()
    # Halos of lamps, and their images in wet roads, are added when all is shaded.
    light = WEATHERS[weather]
    added = light.lamps > 0.0 or (light.wet > 0.0 and light.daytime_lamps > 0.0)
    assert brighter.mean() <= (0.1 if added else 0.0)
    assert len(np.unique(found)) > 500
