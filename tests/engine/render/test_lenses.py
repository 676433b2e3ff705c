"""Pictures through lenses: where things are drawn, what is measured, and that bytes repeat."""

import dataclasses
import math
from functools import lru_cache

import cv2
import numpy as np
import pytest

from eyas.engine.core.optics import pinhole
from eyas.engine.core.optics.lens import (
    BROWN,
    FISHEYE,
    NO_LENS,
    camera_matrix,
    coefficients,
    lens_of,
    rays,
)
from eyas.engine.render import jobs
from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.scene import ACTOR_OBJECT, SKY_OBJECT, ObjectClass

from ...kit.small_city import GROUND, TOWER, car_parts, floor, looking, scene_of, tower

SIZE = 240, 320
LENSES = {
    "barrel": (lens_of(BROWN, (-0.28, 0.09, -0.01, 0.0)), 1.2),
    "pincushion": (lens_of(BROWN, (0.18, 0.02, 0.0, 0.0), (0.003, -0.004)), 1.0),
    "off centre": (lens_of(BROWN, (-0.1, 0.0, 0.0, 0.0), right=0.05, below=-0.04), 1.0),
    "fisheye": (lens_of(FISHEYE, (0.02, -0.01, 0.003, -0.0005)), 1.5),
    "half a sphere": (lens_of(FISHEYE), 2.0 * math.atan(math.pi / 2.0)),
}
NOBODY = DrawList.create(1, 1)
OUTPUTS = {"depth": True, "object_id": True, "class_id": True, "normal": True, "subject": True}


def through(views: Views, *lenses) -> Views:
    views.lens = np.array([lenses[k % len(lenses)] for k in range(len(views.position))], np.float64)
    return views


def pictures(renderer, views, traffic, size=SIZE, samples=1) -> Picture:
    made = Picture.create(len(views.position), *size, **OUTPUTS, actors=8)
    for field in dataclasses.fields(Picture):
        array = getattr(made, field.name)
        if array is not None:
            array[:] = 77  # what is not written shows
    renderer.draw(views, traffic, made, samples)
    return made


def same(one: Picture, other: Picture, rows=slice(None)) -> None:
    for field in dataclasses.fields(Picture):
        array = getattr(one, field.name)
        if array is not None:
            np.testing.assert_array_equal(
                array, getattr(other, field.name)[rows], err_msg=field.name
            )


def rays_of_opencv(rotation, lens, fov) -> np.ndarray:
    """Directions of all pixels by OpenCV's inverse, of any length; NaN where it has none."""
    flat = undistorted(lens, fov)
    right, down, ahead = -rotation[:, 1], -rotation[:, 2], rotation[:, 0]
    return (ahead + flat[:, :1] * right + flat[:, 1:] * down).reshape(*SIZE, 3)


@lru_cache
def undistorted(lens, fov) -> np.ndarray:
    """Where the rays of all pixels meet the plane one ahead, to the right and down."""
    height, width = SIZE
    matrix, distortion = camera_matrix(lens, width, height, fov), np.array(coefficients(lens))
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    places = np.stack([columns, rows], -1).reshape(-1, 1, 2)
    if lens.model == FISHEYE:
        angle = np.hypot(*((places[:, 0] - matrix[:2, 2]) / matrix[0, 0]).T)
        flat = cv2.fisheye.undistortPoints(places, matrix, distortion)[:, 0]
        flat[angle > 1.5] = np.nan
        return flat
    # Its own inverse stops after five steps.
    flat = cv2.undistortPoints(places, matrix, distortion)[:, 0]
    for _ in range(60):
        points = np.column_stack([flat, np.ones(len(flat))])
        shown, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, distortion)
        flat += (places - shown)[:, 0] / matrix[0, 0]
    assert np.abs(places - shown).max() < 1e-3
    return flat


@pytest.fixture
def threads(monkeypatch):
    return lambda count: monkeypatch.setenv("NUMBA_NUM_THREADS", str(count))


@pytest.fixture(scope="module")
def block(renderer_of):
    """A house of 6 x 6 x 9 metres on a lawn, and the corners of its box."""
    scene = scene_of([floor(), tower(0.0, 0.0, 6.0, 9.0)], [GROUND, TOWER])
    return renderer_of(scene, car_parts()), np.array([[-3.0, -3.0, 0.0], [3.0, 3.0, 9.0]])


@pytest.mark.slow
@pytest.mark.parametrize("name", LENSES)
def test_a_house_is_drawn_where_the_rays_of_opencv_meet_it(block, name):
    renderer, box = block
    lens, fov = LENSES[name]
    yaws = np.linspace(0.45, 0.7, 5).tolist()
    views = through(looking([(-13.0, -9.0, 11.0)] * 5, yaws, 0.5, fov=fov), lens)
    off = []
    for shown, rotation in zip(
        pictures(renderer, views, NOBODY).object_id == TOWER, views.rotation, strict=True
    ):
        ray = rays_of_opencv(rotation, lens, fov)
        with np.errstate(divide="ignore"):
            near, far = np.sort((box - views.position[0])[:, None, None] / ray, axis=0)
        meant = near.max(axis=-1) < far.min(axis=-1)
        known = np.isfinite(ray[..., 0])
        assert meant.sum() > 1500
        shown_at, meant_at = (np.argwhere(mask & known).mean(axis=0) for mask in (shown, meant))
        off.append(shown_at - meant_at)
        # Only samples at outlines may differ: those that lie less than one from it.
        edge = cv2.morphologyEx(meant.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3))) > 0
        assert ((shown != meant) & known).sum() < 0.5 * edge.sum()
        inside = np.s_[1:-1, 1:-1]  # an outline may be beyond the border
        assert not ((shown != meant) & known & ~edge)[inside].any()
    # Each edge is at a sample, up to half a pixel aside; that is noise, and no shift of the whole.
    assert np.abs(off).max() < 0.3
    assert np.abs(np.mean(off, axis=0)).max() < 0.1


@pytest.mark.parametrize("name", LENSES)
def test_depths_are_those_along_the_rays(block, name):
    """What pixels show of the lawn lies on the plane z = 0."""
    renderer, _ = block
    lens, fov = LENSES[name]
    views = through(looking([(-13.0, -9.0, 11.0)], 0.45, 0.5, fov=fov), lens)
    picture = pictures(renderer, views, NOBODY)
    ray = rays(views.rotation[0], SIZE[::-1], (fov, None), lens)
    ground = picture.object_id[0] == GROUND
    point = views.position[0] + picture.depth[0][ground][:, None] * ray[ground]
    assert ground.mean() > 0.2
    away = np.linalg.norm(point - views.position[0], axis=1)
    near = away < 60.0
    # Beside the house, a sample may have no neighbour that says how its distance changes.
    assert np.quantile(np.abs(point[near, 2]), 0.99) < 1e-3


@pytest.mark.parametrize("name", LENSES)
@pytest.mark.parametrize("samples", [1, 2, 4])
def test_boxes_and_pixels_are_those_of_the_ids(city, name, samples):
    renderer, traffic = city
    lens, fov = LENSES[name]
    views = looking([(-20.0, -14.0, 12.0), (-44.0, 9.0, 6.0)], [0.5, -0.6], 0.35, fov=fov)
    views.subject[:] = ACTOR_OBJECT + 3
    picture = pictures(renderer, through(views, lens), traffic, samples=samples)
    seen = 0
    for view in range(2):
        for actor in range(8):
            mask = picture.object_id[view] == ACTOR_OBJECT + actor
            left, top, right, bottom = picture.actor_visible_box[view, actor]
            assert mask.sum() == picture.actor_pixels[view, actor, 0]
            assert mask[top:bottom, left:right].sum() == mask.sum()
            if mask.any():
                rows, columns = np.nonzero(mask)
                assert (rows.min(), columns.min()) == (top, left)
                assert (rows.max() + 1, columns.max() + 1) == (bottom, right)
                seen += 1
        whole, visible = picture.actor_box[view], picture.actor_visible_box[view]
        shown = picture.actor_pixels[view, :, 0] > 0
        assert (picture.actor_pixels[view, :, 0] <= picture.actor_pixels[view, :, 1]).all()
        assert (whole[shown, :2] <= visible[shown, :2]).all()
        assert (whole[shown, 2:] >= visible[shown, 2:]).all()
        np.testing.assert_array_equal(picture.subject_box[view], whole[3])
        np.testing.assert_array_equal(picture.subject_pixels[view], picture.actor_pixels[view, 3])
    assert seen >= 4


@pytest.mark.parametrize("samples", [1, 2, 4])
def test_without_distortion_the_picture_is_that_of_a_pinhole(city, samples):
    renderer, traffic = city
    places = [(-20.0, -14.0, 12.0)]
    plain = pictures(renderer, looking(places, 0.5, 0.35), traffic, (61, 83), samples)
    views = through(looking(places, 0.5, 0.35), NO_LENS)
    bent = pictures(renderer, views, traffic, (61, 83), samples)
    for name in ("object_id", "class_id", "normal", "actor_box", "actor_pixels"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(bent, name), err_msg=name)
    np.testing.assert_allclose(plain.depth, bent.depth, rtol=1e-5)
    # Numbers are rounded otherwise on the way through the table.
    assert (np.abs(plain.rgb.astype(int) - bent.rgb) > 0).mean() < 1e-3


@pytest.mark.parametrize("samples", [1, 2, 4])
def test_neighbours_threads_and_bands_change_no_byte(city, threads, monkeypatch, samples):
    renderer, traffic = city
    lenses = [lens for lens, _ in LENSES.values()]

    def views(*which):
        places = np.array([(-20.0, -14.0, 12.0), (-44.0, 9.0, 6.0), (5.0, -9.0, 7.0)])
        made = looking([tuple(places[k % 3]) for k in which], 0.5, 0.35, fov=1.3)
        made.lens = np.array([lenses[k % len(lenses)] for k in which], np.float64)
        made.subject[:] = ACTOR_OBJECT + 3
        made.instant = np.full(len(which), 3.0)
        return made

    threads(1)
    together = pictures(renderer, views(*range(9)), traffic, (60, 84), samples)
    threads(2)
    same(pictures(renderer, views(*range(9)), traffic, (60, 84), samples), together)
    for k in (0, 4, 8):
        same(pictures(renderer, views(k), traffic, (60, 84), samples), together, slice(k, k + 1))
    monkeypatch.setattr(jobs, "SMALLEST_BAND", 300)
    monkeypatch.setattr(jobs, "JOBS_PER_THREAD", 12)
    renderer._tasks.clear()  # which keep their bands
    for k in (1, 4):
        alone = pictures(renderer, views(k), traffic, (60, 84), samples)
        same(alone, together, slice(k, k + 1))
    renderer._tasks.clear()


def test_more_lenses_than_are_kept(city):
    """Tables make room for others, and grow if all are in use."""
    renderer, traffic = city
    many = [lens_of(BROWN, (-0.01 * k, 0.0, 0.0, 0.0)) for k in range(40)]
    places = [(-20.0, -14.0, 12.0)] * 40
    together = pictures(renderer, through(looking(places, 0.5, 0.35), *many), traffic, (24, 32))
    for k in (39, 0, 17):
        views = through(looking(places[:1], 0.5, 0.35), many[k])
        same(pictures(renderer, views, traffic, (24, 32)), together, slice(k, k + 1))


def test_where_no_light_comes_all_is_dark(city):
    renderer, traffic = city
    lens, fov = LENSES["half a sphere"]
    views = through(looking([(0.0, 0.0, 9.0)], fov=fov), lens)
    views.tent = False  # which would bring light from what lies beside it
    picture = pictures(renderer, views, traffic)
    dark = np.isnan(rays(np.eye(3), SIZE[::-1], (fov, None), lens)[..., 0])
    assert 0.1 < dark.mean() < 0.2
    assert (picture.rgb[0][dark] == 0).all()
    assert np.isinf(picture.depth[0][dark]).all()
    assert (picture.object_id[0][dark] == SKY_OBJECT).all()
    assert (picture.class_id[0][dark] == int(ObjectClass.SKY)).all()
    assert (picture.normal[0][dark] == 0).all()
    assert (picture.rgb[0][~dark].sum(axis=-1) > 0).mean() > 0.99


def test_bands_of_one_picture_are_drawn_through_the_lens(city):
    renderer, traffic = city
    lens, fov = LENSES["half a sphere"]
    whole = pictures(renderer, through(looking([(0.0, 0.0, 9.0)], fov=fov), lens), traffic)
    views = through(looking([(0.0, 0.0, 9.0)] * 3, fov=fov), lens)
    views.picture = np.zeros(3, np.int32)
    views.rows = np.array([(0, 70), (70, 155), (155, 240)], np.int32)
    made = Picture.create(1, *SIZE, **OUTPUTS, actors=8)
    renderer.draw(views, traffic, made)
    same(made, whole)


def test_the_normals_are_those_in_the_frame_of_the_camera(block):
    """Faces look aside, their normals do not: the lawn's are the same in all of them."""
    renderer, _ = block
    lens, fov = LENSES["half a sphere"]
    views = through(looking([(-13.0, -9.0, 11.0)], 0.45, 0.5, fov=fov), lens)
    picture = pictures(renderer, views, NOBODY)
    lawn = picture.normal[0][picture.object_id[0] == GROUND].astype(int)
    up = views.rotation[0].T @ (0.0, 0.0, 1.0)
    np.testing.assert_allclose(lawn.T, np.outer([127.5 * -up[1] + 128, 127.5 * -up[2] + 128,
                               127.5 * up[0] + 128], np.ones(len(lawn))), atol=1.5)  # fmt: skip


def test_the_middle_of_a_fisheye_has_the_scale_of_the_pinhole(block):
    renderer, _ = block
    lens, fov = lens_of(FISHEYE), 1.2
    focal = pinhole.focal_length(SIZE[1], fov)
    views = through(looking([(-40.0, 0.0, 4.5)], 0.0, 0.0, fov=fov), lens)
    shown = pictures(renderer, views, NOBODY).object_id[0] == TOWER
    width = np.ptp(np.nonzero(shown[118:122])[1]) + 1
    assert width == pytest.approx(2.0 * focal * math.atan(3.0 / 37.0), abs=1.0)
