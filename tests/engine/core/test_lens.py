"""Lenses, against OpenCV."""

import math

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
    project,
    rays,
    widest,
)

SIZE = 320, 240

LENSES = {
    "barrel": (lens_of(BROWN, (-0.28, 0.09, -0.01, 0.0)), 1.2),
    "pincushion": (lens_of(BROWN, (0.18, 0.02, 0.0, 0.0)), 1.0),
    "decentred": (lens_of(BROWN, (-0.2, 0.05, 0.0, 0.0), (0.004, -0.006), 0.02, -0.03), 1.1),
    "fisheye": (lens_of(FISHEYE, (0.02, -0.01, 0.003, -0.0005), right=0.01), 1.5),
    "half a sphere": (lens_of(FISHEYE), 2.0 * math.atan(math.pi / 2.0)),
}


def turned(rng):
    """Return a rotation: forward, left, up as columns."""
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return axes if np.linalg.det(axes) > 0 else -axes


def in_opencv(points, position, rotation, lens, fov):
    """Return columns and rows; OpenCV's axes are right, down, ahead."""
    axes = np.stack([-rotation[:, 1], -rotation[:, 2], rotation[:, 0]])
    own = (points - position) @ axes.T
    matrix, zero = camera_matrix(lens, *SIZE, fov), np.zeros(3)
    matrix[:2, 2] -= 0.5
    distortion = np.array(coefficients(lens))
    if lens.model == FISHEYE:
        places, _ = cv2.fisheye.projectPoints(own[None], zero, zero, matrix, distortion)
    else:
        places, _ = cv2.projectPoints(own, zero, zero, matrix, distortion)
    return places.reshape(-1, 2) + 0.5


@pytest.mark.parametrize("name", LENSES)
def test_opencv_projects_points_to_the_same_places(name):
    lens, fov = LENSES[name]
    rng = np.random.default_rng(1)
    position, rotation = rng.normal(size=3), turned(rng)
    ray = rays(rotation, SIZE, (fov, None), lens).reshape(-1, 3)
    ray = ray[np.isfinite(ray[:, 0])]
    points = position + ray[::37] * rng.uniform(2.0, 50.0, (len(ray[::37]), 1))
    column, row, forward = project(points, position, rotation, SIZE, (fov, None), lens)
    assert (forward > 0).all()
    expected = in_opencv(points, position, rotation, lens, fov)
    np.testing.assert_allclose(np.stack([column, row], 1), expected, atol=2e-4)


@pytest.mark.parametrize("name", LENSES)
def test_rays_show_what_is_projected_to_their_pixels(name):
    lens, fov = LENSES[name]
    rotation = turned(np.random.default_rng(2))
    ray = rays(rotation, SIZE, (fov, None), lens)
    seen = np.isfinite(ray[..., 0])
    assert seen.mean() > 0.75
    column, row, _ = project(7.0 * ray[seen], np.zeros(3), rotation, SIZE, (fov, None), lens)
    line, place = np.nonzero(seen)
    np.testing.assert_allclose(column, place + 0.5, atol=1e-6)
    np.testing.assert_allclose(row, line + 0.5, atol=1e-6)


def test_no_lens_is_a_pinhole():
    rng = np.random.default_rng(3)
    rotation, points = turned(rng), rng.normal(size=(50, 3))
    assert camera_matrix(NO_LENS, 84, 84, 0.9).tolist() == pinhole.intrinsics(84, 84, 0.9).tolist()
    ours = project(points, (0.1, 0.2, 0.3), rotation, (84, 84), (0.9, 0.7), NO_LENS)
    theirs = pinhole.project(points, (0.1, 0.2, 0.3), rotation, 84, 84, 0.9, 0.7)
    np.testing.assert_allclose(ours, theirs, atol=1e-9)
    np.testing.assert_allclose(
        rays(rotation, (84, 84), (0.9, 0.7), NO_LENS), pinhole.rays(rotation, 84, 84, 0.9, 0.7),
        atol=1e-12,
    )  # fmt: skip


def test_nothing_folds_back_into_the_picture():
    """Beyond its limit, this polynomial turns back: OpenCV shows what is far aside in the middle.

    It is shown farther and farther out.
    """
    lens = lens_of(BROWN, (-0.3, 0.0, 0.0, 0.0))
    aside = np.linspace(0.0, 6.0, 200)
    points = np.stack([np.ones(200), -aside, np.zeros(200)], 1)
    column, _, _ = project(points, np.zeros(3), np.eye(3), SIZE, (1.0, None), lens)
    assert (np.diff(column) > 0).all()
    folded = in_opencv(points, np.zeros(3), np.eye(3), lens, 1.0)[:, 0]
    assert (np.diff(folded) < 0).any()


def test_half_a_sphere_fits_into_a_picture():
    lens, fov = LENSES["half a sphere"]
    ray = rays(np.eye(3), SIZE, (fov, None), lens)
    edge = math.atan2(-ray[120, -1, 1], ray[120, -1, 0])
    assert edge == pytest.approx(math.pi / 2.0 * (159.5 / 160.0), abs=1e-4)
    assert np.isnan(ray[0, 0]).all()  # a corner, more than a quarter turn away


@pytest.mark.parametrize("name", LENSES)
def test_no_pixel_looks_farther_aside_than_the_widest(name):
    lens, fov = LENSES[name]
    focal = pinhole.focal_length(SIZE[0], fov)
    ray = rays(np.eye(3), SIZE, (fov, None), lens)
    most = np.nanmax(np.abs(ray[..., 1:]))
    assert most <= widest(lens, SIZE, (focal, focal)) <= 1.2 * most + 0.1 or lens.model == FISHEYE
