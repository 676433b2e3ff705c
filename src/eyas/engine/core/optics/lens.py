"""Lenses that bend the picture: Brown-Conrady's and Kannala-Brandt's models, as OpenCV has them.

A lens takes a direction, right, down and ahead of the camera, to a place on a plane at distance 1
behind the lens; the camera matrix (`pinhole.intrinsics`, with the principal point moved)
takes that place to the picture. `k1` to `k4`, `p1` and `p2` are the numbers that OpenCV calibrates:

- Brown-Conrady (D. C. Brown, Decentering distortion of lenses, 1966; `cv2.projectPoints` with k1,
  k2, p1, p2, k3), for lenses that are nearly pinholes;
- Kannala-Brandt (A generic camera model, PAMI 28, 2006; `cv2.fisheye.projectPoints` with k1 to k4),
  for fisheyes of up to 180 degrees.

OpenCV puts the centre of pixel (0, 0) at (0, 0), Eyas at (0.5, 0.5).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.core.optics import pinhole
from eyas.lanes import compiled, exact, kernel
from eyas.lanes.elementary import atan2, hypot, sin_cos

Floats = NDArray[np.float64]

BROWN, FISHEYE = range(2)  # Values of `Lens.model`
_WIDEST = (11.43, 1.5707)
"""Farthest that the models look: tangent of 85 degrees, and an angle just below a quarter turn."""

_LEAST_SLOPE = 0.05
"""A picture ends where its radius grows by less than this share of a pinhole's: beyond, the
polynomials turn back."""

_STEPS, _HALVINGS = 2048, 40
"""Angles that are tried for the limit, then times that an interval is halved."""


class Lens(NamedTuple):
    """A lens; with all coefficients 0 and model `BROWN`, a pinhole."""

    model: int  # `BROWN` or `FISHEYE`
    k1: float
    """Radial coefficients: of the tangent's powers 3, 5 and 7, or the angle's 3, 5, 7 and 9."""
    k2: float
    k3: float
    k4: float
    p1: float  # Tangential coefficients, of `BROWN` only
    p2: float
    right: float  # Principal point right of the middle of the picture, as a share of the width
    below: float  # Offset of the principal point below the middle, as a share of the height
    limit: float
    """Tangent (`BROWN`) or angle (`FISHEYE`) from the optical axis at which the picture ends."""


def lens_of(
    model: int,
    k: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    p: tuple[float, float] = (0.0, 0.0),
    right: float = 0.0,
    below: float = 0.0,
) -> Lens:
    """Return a lens; the numbers are those of `Lens`."""
    if model == BROWN:
        k = (*k[:3], 0.0)
    end = _WIDEST[model]
    for step in range(1, _STEPS + 1):
        if _slope_of(k, end * step / _STEPS) < _LEAST_SLOPE:
            low, high = end * (step - 1) / _STEPS, end * step / _STEPS
            for _ in range(_HALVINGS):
                middle = 0.5 * (low + high)
                rising = _slope_of(k, middle) >= _LEAST_SLOPE
                low, high = (middle, high) if rising else (low, middle)
            end = low
            break
    numbers = (*k, *(p if model == BROWN else (0.0, 0.0)), right, below, end)
    return Lens(model, *map(float, numbers))  # kernels ship for this type alone


def _slope_of(k: tuple[float, float, float, float], radius: float) -> float:
    square = radius * radius
    inner = 5.0 * k[1] + square * (7.0 * k[2] + square * 9.0 * k[3])
    return 1.0 + square * (3.0 * k[0] + square * inner)


NO_LENS = lens_of(BROWN)  # A pinhole


@kernel(inline=True)
def _bent(lens: Lens, radius: float) -> float:
    """Return how far from the principal point a tangent or an angle is shown."""
    square = radius * radius
    inner = lens.k2 + square * (lens.k3 + square * lens.k4)
    return radius * (1.0 + square * (lens.k1 + square * inner))


@kernel(inline=True)
def _slope(lens: Lens, radius: float) -> float:
    """Return the derivative of `_bent`."""
    square = radius * radius
    inner = 5.0 * lens.k2 + square * (7.0 * lens.k3 + square * (9.0 * lens.k4))
    return 1.0 + square * (3.0 * lens.k1 + square * inner)


@kernel
def _unbent(lens: Lens, wanted: float) -> float:
    """Return the tangent or angle that is shown at a distance, or -1: no light comes there.

    Newton's steps, halved intervals where they would leave them.
    """
    low, high = 0.0, lens.limit
    if wanted > _bent(lens, high):
        return -1.0
    radius = min(wanted, high)
    for _ in range(60):
        miss = _bent(lens, radius) - wanted
        low, high = (radius, high) if miss < 0.0 else (low, radius)
        following = radius - miss / _slope(lens, radius)
        if following < low or following > high:
            following = 0.5 * (low + high)
        if abs(following - radius) <= 1e-14:
            return following
        radius = following
    return radius


@kernel(inline=True)
def _brown(lens: Lens, x: float, y: float) -> tuple[float, float]:
    """Return the place on the plane behind the lens, for tangents to the right and down."""
    square = x * x + y * y
    radial = 1.0 + square * (lens.k1 + square * (lens.k2 + square * lens.k3))
    return (
        x * radial + 2.0 * lens.p1 * x * y + lens.p2 * (square + 2.0 * x * x),
        y * radial + lens.p1 * (square + 2.0 * y * y) + 2.0 * lens.p2 * x * y,
    )


@kernel(inline=True)
def _brown_slopes(lens: Lens, x: float, y: float) -> tuple[float, float, float]:
    """Return the derivatives of `_brown`: of x by x, of either by the other, of y by y."""
    square = x * x + y * y
    radial = 1.0 + square * (lens.k1 + square * (lens.k2 + square * lens.k3))
    growth = 2.0 * (lens.k1 + square * (2.0 * lens.k2 + square * (3.0 * lens.k3)))
    return (
        radial + growth * x * x + 2.0 * lens.p1 * y + 6.0 * lens.p2 * x,
        growth * x * y + 2.0 * lens.p1 * x + 2.0 * lens.p2 * y,
        radial + growth * y * y + 6.0 * lens.p1 * y + 2.0 * lens.p2 * x,
    )


@kernel
def distorted(lens: Lens, right: float, down: float, ahead: float) -> tuple[float, float]:
    """Return where a direction (right, down, ahead) is shown on the plane behind the lens.

    What is beyond the lens' limit lies on straight lines outwards, as it would for a pinhole, so
    that nothing folds back into the picture. A `BROWN` lens needs what is ahead.
    """
    if lens.model == FISHEYE:
        aside = hypot(right, down)
        if aside == 0.0:
            return 0.0, 0.0
        angle = atan2(aside, ahead)
        inside = min(angle, lens.limit)
        share = (_bent(lens, inside) + (angle - inside)) / aside
        return right * share, down * share
    x, y = right / ahead, down / ahead
    away = hypot(x, y)
    if away <= lens.limit:
        return _brown(lens, x, y)
    share = lens.limit / away
    bent_x, bent_y = _brown(lens, x * share, y * share)
    return bent_x + x * (1.0 - share), bent_y + y * (1.0 - share)


@kernel
def undistorted(lens: Lens, x: float, y: float) -> tuple[float, float, float, float]:
    """Return the direction that a place on the plane behind the lens shows, of length 1.

    Returns:
        Right, down and ahead, and the solid angle that an area of 1 there shows [sr]; 0 where the
        lens lets no light in.
    """
    away = hypot(x, y)
    radius = _unbent(lens, away)
    if radius < 0.0:
        return 0.0, 0.0, 1.0, 0.0
    if lens.model == FISHEYE:
        sine, cosine = sin_cos(radius)
        if away == 0.0:
            return 0.0, 0.0, 1.0, 1.0
        share = sine / away
        return x * share, y * share, cosine, share / _slope(lens, radius)
    share = radius / away if away > 0.0 else 1.0
    u, v = x * share, y * share
    if lens.p1 != 0.0 or lens.p2 != 0.0:
        for _ in range(20):
            bent_x, bent_y = _brown(lens, u, v)
            a, b, d = _brown_slopes(lens, u, v)
            area = a * d - b * b
            if area <= 0.0:
                return 0.0, 0.0, 1.0, 0.0
            miss_x, miss_y = x - bent_x, y - bent_y
            u += (d * miss_x - b * miss_y) / area
            v += (a * miss_y - b * miss_x) / area
            if abs(miss_x) + abs(miss_y) <= 1e-14:
                break
        if hypot(u, v) > lens.limit:
            return 0.0, 0.0, 1.0, 0.0
    a, b, d = _brown_slopes(lens, u, v)
    area, ahead = a * d - b * b, 1.0 / math.sqrt(1.0 + u * u + v * v)
    if area <= 0.0:
        return 0.0, 0.0, 1.0, 0.0
    return u * ahead, v * ahead, ahead, ahead * ahead * ahead / area


@compiled
def _distort_all(lens: Lens, direction: Floats, place: Floats) -> None:
    for k in range(len(place)):
        place[k, 0], place[k, 1] = distorted(
            lens, direction[k, 0], direction[k, 1], direction[k, 2]
        )


@compiled
def _undistort_all(lens: Lens, place: Floats, direction: Floats) -> None:
    for k in range(len(place)):
        right, down, ahead, area = undistorted(lens, place[k, 0], place[k, 1])
        direction[k, 0], direction[k, 1], direction[k, 2] = right, down, ahead
        direction[k, 3] = area


def principal_point(lens: Lens, width: float, height: float) -> tuple[float, float]:
    """Return column and row of the optical axis [pixels]."""
    return (0.5 + lens.right) * width, (0.5 + lens.below) * height


def camera_matrix(lens: Lens, width: int, height: int, fov: float) -> Floats:
    """Return the camera matrix, see `eyas.engine.core.optics.pinhole.intrinsics`."""
    matrix = pinhole.intrinsics(width, height, fov)
    matrix[0, 2], matrix[1, 2] = principal_point(lens, width, height)
    return matrix


def coefficients(lens: Lens) -> list[float]:
    """Return OpenCV's distortion coefficients: k1, k2, p1, p2, k3, or a fisheye's k1 to k4."""
    if lens.model == FISHEYE:
        return [lens.k1, lens.k2, lens.k3, lens.k4]
    return [lens.k1, lens.k2, lens.p1, lens.p2, lens.k3]


def places(
    lens: Lens,  # The lens
    directions: Floats,  # Right, down and ahead, see `distorted`, shape (..., 3)
) -> Floats:
    """Return where directions are shown on the plane behind the lens, right and down, (..., 2)."""
    place = np.empty((*directions.shape[:-1], 2))
    _distort_all(lens, np.array(directions.reshape(-1, 3), np.float64), place.reshape(-1, 2))
    return place


def project(
    points: ArrayLike,
    position: ArrayLike,
    rotation: ArrayLike,
    size: tuple[int, int],
    fields: tuple[float, float | None],
    lens: Lens,
) -> tuple[Floats, Floats, Floats]:
    """Return where points appear in a picture, see `eyas.engine.core.optics.pinhole.project`.

    Args:
        points: World frame [m], shape (..., 3).
        position: Optical centre, world frame [m], shape (3,).
        rotation: Camera to world; columns forward, left, up, shape (3, 3).
        size: Width and height of the picture [pixels].
        fields: Horizontal and vertical field of view of a pinhole with the same focal lengths
            [rad]; None for square pixels.
        lens: The lens.

    Returns:
        Column, row [pixels] and the distance along the optical axis [m], each of shape (...).
        Column and row are meaningless where the distance is not positive.
    """
    offset = np.asarray(points, np.float64) - np.asarray(position, np.float64)
    forward, left, up = np.moveaxis(exact.product(offset, np.asarray(rotation, np.float64)), -1, 0)
    ahead = forward if lens.model == FISHEYE else np.where(forward == 0.0, np.nan, forward)
    place = places(lens, np.stack([-left, -up, ahead], axis=-1))
    across, down = _focal(size, fields)
    column, row = principal_point(lens, *size)
    return column + across * place[..., 0], row + down * place[..., 1], forward


def rays(
    rotation: ArrayLike,  # Camera to world; columns forward, left, up, shape (3, 3)
    size: tuple[int, int],  # Width and height of the picture [pixels]
    fields: tuple[float, float | None],  # See `project`
    lens: Lens,  # The lens
) -> Floats:
    """Return the direction of each pixel's centre: it shows the point `position + depth * ray`.

    Returns:
        Directions, world frame, of length 1 along the optical axis, shape (height, width, 3); NaN
        where the lens lets no light in.
    """
    width, height = size
    across, down = _focal(size, fields)
    column, row = principal_point(lens, width, height)
    place = np.empty((height, width, 2))
    place[..., 0] = (np.arange(width) + 0.5 - column) / across
    place[..., 1] = ((np.arange(height) + 0.5 - row) / down)[:, None]
    direction = np.empty((height, width, 4))
    _undistort_all(lens, place.reshape(-1, 2), direction.reshape(-1, 4))
    dark = direction[..., 3] == 0.0
    ahead = np.where(dark, np.nan, direction[..., 2])
    local = np.stack([np.ones_like(ahead), -direction[..., 0], -direction[..., 1]], axis=-1)
    local[..., 1:] /= ahead[..., None]
    local[dark] = np.nan
    return np.asarray(exact.product(local, np.asarray(rotation, np.float64).T), np.float64)


def _focal(size: tuple[int, int], fields: tuple[float, float | None]) -> tuple[float, float]:
    """Return the focal length along rows and columns [pixels]."""
    across = pinhole.focal_length(size[0], fields[0])
    return across, across if fields[1] is None else pinhole.focal_length(size[1], fields[1])


def widest(
    lens: Lens,  # The lens
    size: tuple[float, float],  # Width and height of the picture [pixels]
    focal: tuple[float, float],  # Focal length along rows and along columns [pixels]
) -> float:
    """Return the largest tangent from the optical axis, aside or upright, that a picture shows."""
    (width, height), (column, row) = size, principal_point(lens, *size)
    edge = np.linspace(0.0, 1.0, 9)
    sides = np.concatenate(
        [np.stack([edge * width, np.full(9, end * height)], axis=1) for end in (0.0, 1.0)]
        + [np.stack([np.full(9, end * width), edge * height], axis=1) for end in (0.0, 1.0)]
    )
    place = (sides - (column, row)) / focal
    direction = np.empty((len(place), 4))
    _undistort_all(lens, place, direction)
    if (direction[:, 3] == 0.0).any():
        return float(exact.tan(lens.limit)) if lens.model == FISHEYE else lens.limit
    tangent = np.abs(direction[:, :2]).max(axis=1) / direction[:, 2]
    # The sides bend a little between the points that are looked at.
    return float(min(1.05 * tangent.max() + 0.01, 4000.0))
