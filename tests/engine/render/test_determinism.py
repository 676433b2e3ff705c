"""The same view gives the same bytes, whoever draws it and with whom."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.render import jobs
from eyas.engine.render import renderer as module
from eyas.engine.render.kernels.draw import draw_views
from eyas.engine.state.draw import Views
from eyas.engine.state.lighting import LightState
from eyas.engine.state.scene import Lamps

from ...kit.small_city import DAY, car_parts, city_scene, looking

SUBJECT = (1 << 16) + 2


def sixteen_views() -> Views:
    rng = np.random.default_rng(5)
    places = [(*rng.uniform(-80, 80, 2), float(rng.uniform(3, 30))) for _ in range(16)]
    pitch = list(rng.uniform(0.0, 1.4, 16))
    places[7:] = [(x, 0.3 * y / 8, z) for x, y, z in places[7:]]
    places[7], pitch[7] = (-34.0, -2.0, 12.0), 1.4  # above the subject
    views = looking(places, list(rng.uniform(-3, 3, 16)), pitch, fov=1.1, subject=SUBJECT)
    changes = rng.uniform((0.5, 0.5, 0.0), (1.5, 1.5, 0.005), (16, 3)).astype(np.float32)
    views.light = LightState(
        *np.ascontiguousarray(changes.T), *rng.uniform(-9.0, 9.0, (2, 16)).astype(np.float32)
    )
    views.instant = rng.uniform(0.0, 100.0, 16)
    views.world[:] = np.arange(16) % 2
    return views


def one_of(views: Views, k: int) -> Views:
    part = slice(k, k + 1)
    return Views(
        views.position[part], views.rotation[part], views.world[part], views.subject[part],
        views.field_of_view, None, LightState(*(array[part] for array in views.light)),
        views.instant[part],
    )  # fmt: skip


def arrays(picture):
    names = ("rgb", "depth", "object_id", "subject_box", "subject_pixels")
    return {name: getattr(picture, name) for name in names}


@pytest.fixture
def threads(monkeypatch):
    return lambda count: monkeypatch.setenv("NUMBA_NUM_THREADS", str(count))


# What each weather adds to the day; all of it at once is no weather, but finds all.
ALL_WEATHERS = dataclasses.replace(
    DAY,
    fog_power=2,
    snow=1.0,
    lamps=1.0,
    windows=0.4,
    clouds=0.5,
    flakes=1.0,
    rain=0.8,
    leaves=1.0,
    wet=0.8,
    litter=0.7,
    mist=0.01,
    glare=0.6,
    star_turn=1.0,
    moon_limb=(0.6, 0.8, 0.0),
    moon_lit=0.3,
    daytime_lamps=0.4,
    windy=1.0,
    smoke=3,
)


def in_all_weathers(renderer_of):
    scene = city_scene()
    places = np.array([(x, 8.5, 7.2) for x in range(-150, 151, 50)], np.float32)
    scene.lamps = Lamps(places, np.tile(np.array([0, 0, -1], np.float32), (len(places), 1)))
    return renderer_of(scene, car_parts(), ALL_WEATHERS)


@pytest.mark.parametrize("samples", [1, 2, 4])
@pytest.mark.parametrize("weather", ["day", "all"])
def test_threads_and_neighbours_change_no_byte(city, renderer_of, drawn, threads, samples, weather):
    renderer, traffic = city
    if weather == "all":
        renderer = in_all_weathers(renderer_of)
    views = sixteen_views()
    threads(1)
    reference = arrays(drawn(renderer, views, traffic, (60, 84), samples))
    assert reference["subject_pixels"][:, 1].max() > 20
    threads(2)
    for name, array in arrays(drawn(renderer, views, traffic, (60, 84), samples)).items():
        np.testing.assert_array_equal(array, reference[name], err_msg=name)
    for k in (0, 7, 15):
        alone = arrays(drawn(renderer, one_of(views, k), traffic, (60, 84), samples))
        for name, array in alone.items():
            np.testing.assert_array_equal(array[0], reference[name][k], err_msg=name)


@pytest.mark.parametrize("samples", [1, 2, 4])
@pytest.mark.parametrize("weather", ["day", "all"])
def test_bands_change_no_byte(city, renderer_of, drawn, threads, monkeypatch, samples, weather):
    renderer, traffic = city
    if weather == "all":
        renderer = in_all_weathers(renderer_of)
    views = looking([(-60.0, -2.0, 7.0)], 0.1, 0.15, fov=1.2, subject=SUBJECT)
    views.instant = np.array([3.0])
    threads(1)
    whole = arrays(drawn(renderer, views, traffic, (120, 160), samples))
    assert (whole["subject_pixels"] > 0).all()
    threads(2)
    monkeypatch.setattr(jobs, "SMALLEST_BAND", 800)
    monkeypatch.setattr(jobs, "JOBS_PER_THREAD", 12)
    renderer._tasks.clear()  # which keep their bands
    assert len(jobs.new_task(jobs.Size(1, 120, 160, 1, 1, 0, False, False, 2)).job.band) == 24
    for name, array in arrays(drawn(renderer, views, traffic, (120, 160), samples)).items():
        np.testing.assert_array_equal(array, whole[name], err_msg=name)


def test_another_thread_may_draw_in_the_middle_of_a_picture(city, drawn, monkeypatch):
    renderer, traffic = city
    views, others = one_of(sixteen_views(), 0), one_of(sixteen_views(), 7)
    alone = arrays(drawn(renderer, views, traffic))

    def interrupted(*given):
        monkeypatch.setattr(module, "draw_views", draw_views)
        drawn(renderer, others, traffic)
        draw_views(*given)

    monkeypatch.setattr(module, "draw_views", interrupted)
    for name, array in arrays(drawn(renderer, views, traffic)).items():
        np.testing.assert_array_equal(array, alone[name], err_msg=name)


def test_what_is_not_wanted_changes_nothing(city, drawn):
    renderer, traffic = city
    views = sixteen_views()
    full = drawn(renderer, views, traffic)
    only = type(full).create(16, 96, 128)
    renderer.draw(views, traffic, only)
    np.testing.assert_array_equal(only.rgb, full.rgb)


def test_worlds_are_kept_apart(city, drawn):
    renderer, traffic = city
    views = looking([(-40.0, 0.0, 30.0)] * 2, 0.0, 1.5, fov=1.0)
    views.world[:] = (0, 1)
    ids = drawn(renderer, views, traffic).object_id
    assert (ids[0] != ids[1]).any()
    views.world[:] = (1, 1)
    ids = drawn(renderer, views, traffic).object_id
    np.testing.assert_array_equal(ids[0], ids[1])
