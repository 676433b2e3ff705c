"""The pinhole camera; its optical axis passes through the middle of the picture."""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.lanes import exact


@lru_cache  # each picture asks, and cameras seldom change
def focal_length(width: int, fov: float) -> float:
    """Return the focal length [pixels]; a height and vertical field of view give the vertical one.

    Args:
        width: Width of the picture [pixels].
        fov: Horizontal field of view [rad].
    """
    return float(0.5 * width / exact.tan(0.5 * fov))


@lru_cache
def field_along(
    fov: float,  # Field of view along two sides [rad]
    ratio: float,  # Length of the other sides over the length of these
) -> float:
    """Return the field of view along the other sides of a picture [rad]."""
    return float(2.0 * exact.atan(exact.tan(0.5 * fov) * ratio))


def intrinsics(width: int, height: int, fov: float) -> NDArray[np.float64]:
    """Return the camera matrix in computer vision axes: x right, y down, z forward, shape (3, 3).

    Pixels are square, and pixel (0, 0) has its centre at (0.5, 0.5), as in `project`.

    Args:
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
        fov: Horizontal field of view [rad].
    """
    focal = focal_length(width, fov)
    return np.array([[focal, 0.0, 0.5 * width], [0.0, focal, 0.5 * height], [0.0, 0.0, 1.0]])


def project(
    points: ArrayLike,  # World frame [m], shape (..., 3)
    position: ArrayLike,  # Optical centre, world frame [m], shape (3,)
    rotation: ArrayLike,  # Camera to world; columns forward, left, up, shape (3, 3)
    width: int,  # Width of the picture [pixels]
    height: int,  # Height of the picture [pixels]
    fov: float,  # Horizontal field of view [rad]
    vertical_fov: float | None = None,  # Vertical field of view [rad]; None for square pixels
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return where points appear in a picture.

    Returns:
        Column and row [pixels] (pixel (0, 0) has its centre at (0.5, 0.5)) and the distance along
        the optical axis [m], each of shape (...). Column and row are meaningless where the
        distance is not positive, and NaN where it is 0.
    """
    offset = np.asarray(points, np.float64) - np.asarray(position, np.float64)
    forward, left, up = np.moveaxis(exact.product(offset, np.asarray(rotation, np.float64)), -1, 0)
    focal = focal_length(width, fov)
    focal_vertical = focal if vertical_fov is None else focal_length(height, vertical_fov)
    distance = np.where(forward == 0.0, np.nan, forward)
    column = 0.5 * width - focal * left / distance
    row = 0.5 * height - focal_vertical * up / distance
    return column, row, forward


def rays(
    rotation: ArrayLike,  # Camera to world; columns forward, left, up, shape (3, 3)
    width: int,  # Width of the picture [pixels]
    height: int,  # Height of the picture [pixels]
    fov: float,  # Horizontal field of view [rad]
    vertical_fov: float | None = None,  # Vertical field of view [rad]; None for square pixels
) -> NDArray[np.float64]:
    """Return the direction of each pixel's centre: it shows the point `position + depth * ray`.

    Returns:
        Directions, world frame, of length 1 along the optical axis, shape (height, width, 3).
    """
    focal = focal_length(width, fov)
    focal_vertical = focal if vertical_fov is None else focal_length(height, vertical_fov)
    left = (0.5 * width - (np.arange(width) + 0.5)) / focal
    up = (0.5 * height - (np.arange(height) + 0.5)) / focal_vertical
    local = np.empty((height, width, 3))
    local[..., 0] = 1.0
    local[..., 1] = left
    local[..., 2] = up[:, None]
    return np.asarray(exact.product(local, np.asarray(rotation, np.float64).T), np.float64)
