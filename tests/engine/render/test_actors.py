"""Boxes and pixels of all actors of a view, compared with what the pictures themselves show."""

import numpy as np
import pytest

from eyas.engine.render import jobs
from eyas.engine.state.draw import DrawList, Picture
from eyas.engine.state.scene import ACTOR_OBJECT, Scene

from ...kit.small_city import car_parts, looking

SIZE = (60, 84)
COUNT = 8


@pytest.fixture(scope="module")
def nothing_else(renderer_of):
    """A renderer of a world of cars only, in which nothing hides them."""
    return renderer_of(Scene.empty(), car_parts())


def street_views(count=40):
    """Views along the road, over the cars ahead, and from within cars."""
    rng = np.random.default_rng(3)
    places = list(
        zip(
            rng.uniform(-95, 10, count).tolist(),
            rng.uniform(-5, 5, count).tolist(),
            rng.uniform(0.4, 2.0, count).tolist(),
            strict=True,
        )
    )
    yaw, pitch = rng.uniform(-0.1, 0.1, count), rng.uniform(0.0, 0.05, count)
    for k in range(min(8, count)):
        places[k] = -70.0 + 18.0 * k, 3.5 if k % 2 else -3.5, 1.4
        yaw[k], pitch[k] = rng.uniform(-3.1, 3.1), rng.uniform(-0.1, 0.9)
    views = looking(places, list(yaw), list(pitch), fov=0.6)
    views.world[:] = np.arange(count) % 2
    views.subject[:] = ACTOR_OBJECT + np.arange(count) % COUNT
    return views


SUBJECT = ("subject_box", "subject_pixels", "subject_visible_box")


def measured(renderer, views, traffic, size=SIZE, samples=1, **wanted) -> Picture:
    wanted = {"object_id": True, "subject": True, "actors": COUNT, **wanted}
    picture = Picture.create(len(views.position), *size, **wanted)
    renderer.draw(views, traffic, picture, samples)
    return picture


def only(traffic: DrawList, actor: int) -> DrawList:
    """The traffic without all but one actor."""
    part = np.where(traffic.object_id == ACTOR_OBJECT + actor, traffic.part, -1)
    return DrawList(part, traffic.pose, traffic.colour, traffic.object_id, traffic.object_class)


def box_of(shown: np.ndarray) -> list[int]:
    rows, columns = np.nonzero(shown)
    if not len(rows):
        return [0, 0, 0, 0]
    return [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]


def test_they_are_those_of_each_actor_drawn_alone_and_of_the_object_ids(city, nothing_else):
    renderer, traffic = city
    views = street_views()
    picture = measured(renderer, views, traffic)
    for actor in range(COUNT):
        alone = Picture.create(len(views.position), *SIZE, rgb=False, object_id=True)
        nothing_else.draw(views, only(traffic, actor), alone)
        for v in range(len(views.position)):
            covered = alone.object_id[v] == ACTOR_OBJECT + actor
            seen = picture.object_id[v] == ACTOR_OBJECT + actor
            assert picture.actor_pixels[v, actor].tolist() == [seen.sum(), covered.sum()]
            assert picture.actor_box[v, actor].tolist() == box_of(covered)
            assert picture.actor_visible_box[v, actor].tolist() == box_of(seen)
    seen, covered = picture.actor_pixels.reshape(-1, 2).T
    assert ((seen > 0) & (seen < covered)).sum() > 10
    assert ((seen == 0) & (covered > 0)).sum() > 5
    assert (covered == 0).sum() > 20


def test_the_subject_is_one_of_them(city):
    renderer, traffic = city
    views = street_views()
    views.subject[:3] = -1, 5, ACTOR_OBJECT + COUNT
    together, apart = (
        measured(renderer, views, traffic),
        measured(renderer, views, traffic, actors=0),
    )
    assert apart.actor_box is None
    for name in SUBJECT:
        np.testing.assert_array_equal(getattr(together, name), getattr(apart, name))
    assert not together.subject_pixels[:3].any()
    assert (together.subject_pixels[3:, 1] > 0).sum() > 3


def test_measuring_changes_no_byte_of_the_pictures(city):
    renderer, traffic = city
    views = street_views()
    for samples in (1, 4):
        with_them = measured(renderer, views, traffic, samples=samples, depth=True)
        without = measured(
            renderer, views, traffic, samples=samples, depth=True, actors=0, subject=False
        )
        for name in ("rgb", "depth", "object_id"):
            np.testing.assert_array_equal(getattr(with_them, name), getattr(without, name))


def test_bands_change_no_measurement(city, monkeypatch):
    renderer, traffic = city
    views = looking([(-60.0, -2.0, 7.0)], 0.1, 0.15, fov=1.2, subject=ACTOR_OBJECT + 2)
    monkeypatch.setenv("NUMBA_NUM_THREADS", "1")
    whole = measured(renderer, views, traffic, (120, 160))
    assert (whole.actor_pixels[0, :, 0] > 0).sum() > 3
    monkeypatch.setenv("NUMBA_NUM_THREADS", "2")
    monkeypatch.setattr(jobs, "SMALLEST_BAND", 500)
    monkeypatch.setattr(jobs, "JOBS_PER_THREAD", 12)
    renderer._tasks.clear()  # which keep their bands
    banded = measured(renderer, views, traffic, (120, 160))
    for name in ("actor_box", "actor_pixels", "actor_visible_box", *SUBJECT):
        np.testing.assert_array_equal(getattr(banded, name), getattr(whole, name))


def test_a_part_of_the_arrays_may_be_wanted(city):
    renderer, traffic = city
    views = street_views(4)
    both = measured(renderer, views, traffic)
    for name in ("actor_box", "actor_pixels", "actor_visible_box", *SUBJECT):
        part = Picture.create(4, *SIZE)
        setattr(part, name, np.zeros_like(getattr(both, name)))
        renderer.draw(views, traffic, part)
        np.testing.assert_array_equal(getattr(part, name), getattr(both, name))
