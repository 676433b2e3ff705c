"""Conversion between points in the world and samples of a view."""

from typing import NamedTuple

from eyas.engine.render.kernels.bundles import Band, Direction, View
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel
from eyas.lanes.vector import to_f4


class ScreenBox(NamedTuple):
    """A box on the screen [samples], of float64; empty if its left is beyond its right."""

    left: float
    top: float
    right: float
    bottom: float


class LocalCamera(NamedTuple):
    """A camera in the frame of a thing, see `local_camera`; of float32."""

    eye: Direction  # Optical centre [m]
    ahead: Direction
    left: Direction  # To the left by one sample at distance 1; the next one upwards
    up: Direction


@kernel(inline=True)
def own_rows(band: Band, first: int, last: int) -> tuple[int, int]:
    """Return which of its own rows of pixels a worker has from `first` on, and before `last`: the
    numbers for `pixel_row`.

    What is drawn over a picture is drawn by who has shaded what lies below, so there is no need to
    wait for others. Threads that went through all rows and left out those of others would wait for
    each other in each.
    """
    return _rows_before(band, first), _rows_before(band, last)


@kernel(inline=True)
def _rows_before(band: Band, row: int) -> int:
    pair, part = row >> 1, 0
    if pair % band.members == band.member:
        part = row & 1
    return (pair - band.member + band.members - 1) // band.members * 2 + part


@kernel(inline=True)
def pixel_row(band: Band, k: int) -> int:
    """Return the row of pixels that is a worker's own with number `k`: it has every so many pairs
    of them.
    """
    return (band.member + band.members * (k >> 1)) * 2 + (k & 1)


@kernel(inline=True)
def own_row(band: Band, first: int) -> int:
    """Return the first row, from one that is not negative on, that is a worker's own."""
    return first + (band.member - first) % band.members


@kernel(inline=True)
def empty_box() -> ScreenBox:
    """Return an empty box."""
    return ScreenBox(1e9, 1e9, -1e9, -1e9)


@kernel(inline=True)
def around(box: ScreenBox, view: View, x: float, y: float, z: float) -> ScreenBox:
    """Return a screen box extended by a point; unbounded if the point is not in front."""
    ahead, across, down = view.screen.distance, view.screen.column, view.screen.row
    w = ahead.x * x + ahead.y * y + ahead.z * z + ahead.w
    if w < 0.1:
        return ScreenBox(-1e9, -1e9, 1e9, 1e9)
    column = 0.5 * view.width + (across.x * x + across.y * y + across.z * z + across.w) / w
    row = 0.5 * view.height + (down.x * x + down.y * y + down.z * z + down.w) / w
    return ScreenBox(
        min(box.left, column), min(box.top, row), max(box.right, column), max(box.bottom, row)
    )


@kernel(inline=True)
def local_camera(view: View, origin: Direction, along_x: float, along_y: float) -> LocalCamera:
    """Return the camera of a view in an upright frame.

    Distances within it are short, so float32 is enough for them.

    Args:
        view: The samples.
        origin: Origin of the frame, world frame [m], of float64.
        along_x: The frame's x axis, a horizontal unit vector.
        along_y: The same.
    """
    eye, ahead, left, up = view.eye, view.ahead, view.left, view.up
    x, y = eye.x - origin.x, eye.y - origin.y
    across, down = 1.0 / view.focal_x, 1.0 / view.focal_y
    return LocalCamera(
        Direction(
            f4(x * along_x + y * along_y), f4(y * along_x - x * along_y), f4(eye.z - origin.z)
        ),
        Direction(
            f4(ahead.x * along_x + ahead.y * along_y),
            f4(ahead.y * along_x - ahead.x * along_y),
            f4(ahead.z),
        ),
        Direction(
            f4((left.x * along_x + left.y * along_y) * across),
            f4((left.y * along_x - left.x * along_y) * across),
            f4(left.z * across),
        ),
        Direction(
            f4((up.x * along_x + up.y * along_y) * down),
            f4((up.y * along_x - up.x * along_y) * down),
            f4(up.z * down),
        ),
    )


@kernel(inline=True)
def ray_of_row(
    camera: LocalCamera,  # The camera in any frame
    view: View,  # The samples
    line: int,  # Row of the band
) -> Direction:
    """Return the ray, of length 1 along the optical axis, to the middle of a row of samples."""
    rise = f4(0.5 * view.height - (line + view.top + 0.5))
    ahead, up = camera.ahead, camera.up
    return Direction(ahead.x + rise * up.x, ahead.y + rise * up.y, ahead.z + rise * up.z)


@kernel(inline=True)
def point_of(
    camera: LocalCamera,  # The camera in any frame
    view: View,  # The samples
    ray: Direction,  # From `ray_of_row`
    column: int,  # Columns of the samples
    inverse: float,  # 1/distance of what they show [1/m]; not 0
) -> tuple[float, float, float]:
    """Return the points that samples show, in the frame of the camera [m]."""
    w = f4(1.0) / inverse
    shift = f4(0.5 * view.width - 0.5) - to_f4(column)
    eye, left = camera.eye, camera.left
    return (
        eye.x + w * (ray.x + shift * left.x),
        eye.y + w * (ray.y + shift * left.y),
        eye.z + w * (ray.z + shift * left.z),
    )
