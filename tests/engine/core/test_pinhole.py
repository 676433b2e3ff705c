import math

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import focal_length, intrinsics, project, rays

WIDTH, HEIGHT, FOV = 64, 48, 1.1


def turned(yaw: float, pitch: float) -> np.ndarray:
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return np.array([[cy * cp, -sy, cy * sp], [sy * cp, cy, sy * sp], [-sp, 0, cp]])


def test_the_edge_of_the_picture_is_half_the_field_of_view_off_the_axis():
    left_edge = [math.cos(FOV / 2), math.sin(FOV / 2), 0.0]
    column, row, depth = project(left_edge, np.zeros(3), np.eye(3), WIDTH, HEIGHT, FOV)
    assert column == pytest.approx(0.0, abs=1e-9)
    assert row == pytest.approx(HEIGHT / 2)
    assert depth == pytest.approx(math.cos(FOV / 2))


def test_left_and_up_are_small_columns_and_rows():
    column, row, _ = project([10.0, 1.0, 1.0], np.zeros(3), np.eye(3), WIDTH, HEIGHT, FOV)
    assert column < WIDTH / 2
    assert row < HEIGHT / 2


@pytest.mark.parametrize("vertical", [None, 0.6])
def test_rays_and_projection_are_inverse(vertical):
    position, rotation = np.array([3.0, -2.0, 9.0]), turned(0.7, 0.4)
    points = position + 7.5 * rays(rotation, WIDTH, HEIGHT, FOV, vertical)
    column, row, depth = project(points, position, rotation, WIDTH, HEIGHT, FOV, vertical)
    np.testing.assert_allclose(column, np.broadcast_to(np.arange(WIDTH) + 0.5, column.shape))
    np.testing.assert_allclose(row, np.broadcast_to(np.arange(HEIGHT)[:, None] + 0.5, row.shape))
    np.testing.assert_allclose(depth, 7.5)


def test_a_vertical_field_of_view_reaches_from_top_to_bottom():
    top = [math.cos(0.3), 0.0, math.sin(0.3)]
    _, row, _ = project(top, np.zeros(3), np.eye(3), WIDTH, HEIGHT, FOV, 0.6)
    assert row == pytest.approx(0.0, abs=1e-9)


def test_the_camera_matrix_projects_as_project_does():
    forward, left, up = point = np.array([8.0, 1.5, -2.5])
    column, row, _ = project(point, np.zeros(3), np.eye(3), WIDTH, HEIGHT, FOV)
    x, y, z = intrinsics(WIDTH, HEIGHT, FOV) @ [-left, -up, forward]
    assert (x / z, y / z) == pytest.approx((float(column), float(row)))


def test_the_original_camera_covers_a_car_with_80_pixels():
    # 320 pixels over 0.785 rad from 22 m: a car of 4.6 m is about 80 pixels long.
    assert 4.6 * focal_length(320, 0.785) / 22 == pytest.approx(80, abs=2)
