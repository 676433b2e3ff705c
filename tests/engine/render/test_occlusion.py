"""Boxes that are hidden behind what has been drawn."""

import numpy as np
import pytest

from eyas.engine.render.kernels.bundles import Plane, Planes, Point, Projection, Row, View
from eyas.engine.render.kernels.visibility.occlusion import TILE, box_is_hidden, measure_tiles
from eyas.lanes import kernel

SIDE, FOCAL, TOP = 40, 30.0, 8


def view(rows: int = SIDE - TOP) -> View:
    """Return the lower rows of a view along x from the origin, left along y, up along z."""
    nothing = Plane(0.0, 0.0, 0.0, 0.0, 0.0)
    screen = Projection(
        column=Row(0.0, -FOCAL, 0.0, 0.0),
        row=Row(0.0, 0.0, -FOCAL, 0.0),
        distance=Row(1.0, 0.0, 0.0, 0.0),
    )
    ahead, left, up = Point(1.0, 0.0, 0.0), Point(0.0, 1.0, 0.0), Point(0.0, 0.0, 1.0)
    planes = Planes(nothing, nothing, nothing, nothing, nothing)
    return View(
        Point(0.0, 0.0, 0.0), ahead, left, up, FOCAL, FOCAL, FOCAL, SIDE, SIDE, TOP, rows, 1, 1,
        screen, planes,
    )  # fmt: skip


@kernel
def hidden(
    boxes: np.ndarray, shown: View, key: np.ndarray, tiles: np.ndarray, result: np.ndarray
) -> None:
    """Write which boxes are hidden behind a picture."""
    measure_tiles(key, shown.width, tiles)
    for column in range(boxes.shape[1]):
        result[column] = box_is_hidden(boxes, column, shown, tiles)


def hidden_boxes(boxes: np.ndarray, inverse: np.ndarray) -> np.ndarray:
    """Return which boxes are hidden behind a picture of 1/distance."""
    rows, columns = inverse.shape
    key = np.zeros((rows, columns + -columns % TILE), np.int64)
    key[:, :columns] = inverse.astype(np.float32).view(np.int32).astype(np.int64) << 32
    tiles = np.empty((-(-rows // TILE), key.shape[1] // TILE), np.float32)
    result = np.zeros(boxes.shape[1], np.bool_)
    hidden(boxes.astype(np.float32), view(rows), key, tiles, result)
    return result


def test_what_is_behind_a_wall_is_hidden_and_what_is_before_it_is_not() -> None:
    wall = np.full((SIDE - TOP, SIDE), 1 / 20.0)
    behind, before, through = (
        (30, -2, -6, 35, 2, -2),
        (10, -1, -3, 15, 1, -2),
        (15, -1, -3, 30, 1, -2),
    )
    around_the_eye = (-5, -1, -1, 30, 1, 1)
    boxes = np.array([behind, before, through, around_the_eye], float).T
    assert hidden_boxes(boxes, wall).tolist() == [True, False, False, False]


@pytest.mark.parametrize("rows", [SIDE - TOP, 21])
def test_a_hole_of_one_sample_shows_what_is_behind_the_wall(rows: int) -> None:
    box = np.array([[25.0, -9.0, -30.0, 60.0, 9.0, -3.0]]).T
    wall = np.full((rows, SIDE), 1 / 20.0)
    assert hidden_boxes(box, wall).all()
    wall[rows - 1, SIDE // 2] = 0.0
    assert not hidden_boxes(box, wall).any()


def test_no_point_of_a_hidden_box_is_nearer_than_the_picture() -> None:
    rng = np.random.default_rng(5)
    inverse = np.kron(1 / rng.uniform(2.0, 60.0, (4, 5)), np.ones((TILE, TILE)))
    low = rng.uniform([1.0, -30.0, -30.0], [60.0, 30.0, 20.0], (4000, 3))
    boxes = np.concatenate([low, low + rng.uniform(0.1, 8.0, (4000, 3))], axis=1).T
    found = hidden_boxes(boxes, inverse)
    points = (
        boxes[:3, :, None] + rng.uniform(size=(3, 4000, 64)) * (boxes[3:] - boxes[:3])[..., None]
    )
    x, y, z = points
    column = np.floor(SIDE / 2 - FOCAL * y / x).astype(int)
    row = np.floor(SIDE / 2 - FOCAL * z / x).astype(int) - TOP
    inside = (column >= 0) & (column < SIDE) & (row >= 0) & (row < SIDE - TOP)
    shown = inverse[np.clip(row, 0, SIDE - TOP - 1), np.clip(column, 0, SIDE - 1)]
    seen = (inside & (1 / x >= shown)).any(axis=1)
    assert not (found & seen).any()
    # Not only what is outside the picture: most of what a wall hides is found.
    assert (found & inside.any(axis=1)).sum() > 0.3 * (~seen & inside.any(axis=1)).sum() > 100
