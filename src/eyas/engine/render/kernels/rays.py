"""Rays from the camera through the samples of a band."""

from typing import NamedTuple

from eyas.engine.render.kernels.bundles import Band, Direction, Glass, Point, View
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.lanes import kernel
from eyas.lanes.vector import gather, lane_numbers, load, load_two


class Rays(NamedTuple):
    """A camera, of float32."""

    eye: Direction  # Optical centre [m]
    ahead: Direction  # Unit vector along the optical axis; the next two are to the left and up
    left: Direction
    up: Direction
    across: float  # One over the focal length along rows [1/samples]
    down: float  # The same along columns
    middle: float  # Column of the optical axis [samples]
    centre_line: float  # Its row in the picture [samples]
    top: float  # First row of the band [samples]
    pixel: float  # Angle that a pixel spans [rad]


@kernel(inline=True)
def _rounded(vector: Point) -> Direction:
    return Direction(f4(vector.x), f4(vector.y), f4(vector.z))


@kernel(inline=True)
def rays_of(view: View) -> Rays:
    """Return the rays of a band."""
    return Rays(
        _rounded(view.eye),
        _rounded(view.ahead),
        _rounded(view.left),
        _rounded(view.up),
        f4(1.0 / view.focal_x),
        f4(1.0 / view.focal_y),
        f4(0.5 * view.width),
        f4(0.5 * view.height),
        f4(view.top),
        f4(1.0 / view.focal),
    )


@kernel(inline=True)
def ray_of(rays: Rays, line: float, column: float) -> tuple[float, float, float]:
    """Return the ray through a place of the picture [samples], of length 1 along the optical axis.

    The row is that of the picture, not of the band: it may be no whole or half number, and would
    otherwise be rounded differently in each band.
    """
    left, up = (rays.middle - column) * rays.across, (rays.centre_line - line) * rays.down
    ahead, aside, above = rays.ahead, rays.left, rays.up
    return (
        ahead.x + up * above.x + left * aside.x,
        ahead.y + up * above.y + left * aside.y,
        ahead.z + up * above.z + left * aside.z,
    )


@kernel(inline=True)
def _turned(glass: Glass, view: View, axis: int) -> Direction:
    """Return an axis of the camera, whose face the view is, in the world."""
    a, b, c = glass.turn[0, axis], glass.turn[1, axis], glass.turn[2, axis]
    ahead, left, up = view.ahead, view.left, view.up
    return Direction(
        f4(a * ahead.x + b * left.x + c * up.x),
        f4(a * ahead.y + b * left.y + c * up.y),
        f4(a * ahead.z + b * left.z + c * up.z),
    )


@kernel(inline=True)
def camera_axes(band: Band) -> tuple[Direction, Direction, Direction]:
    """Return forward, left and up of the camera in the world, also if the view is a face of it."""
    view, glass = band.camera, band.glass
    if glass.on == 0:
        return _rounded(view.ahead), _rounded(view.left), _rounded(view.up)
    return _turned(glass, view, 0), _turned(glass, view, 1), _turned(glass, view, 2)


@kernel(inline=True)
def place_in_face(glass: Glass, row: int, first: int, step: int) -> tuple[float, float, float]:
    """Return line, column and width, see `LensTables`, of eight samples that are `step` apart."""
    at = row * glass.column.shape[1] + first
    if step == 1:
        return load(glass.line, at), load(glass.column, at), load(glass.size, at)
    where = lane_numbers() * i4(step) + i4(at)
    return gather(glass.line, where), gather(glass.column, where), gather(glass.size, where)


@kernel(inline=True)
def place_in_tile(glass: Glass, row: int, first: int, below: int) -> tuple[float, float, float]:
    """Return what `place_in_face` does, of four samples and the four `below` rows after them."""
    at, step = row * glass.column.shape[1] + first, below * glass.column.shape[1]
    return (
        load_two(glass.line, at, step),
        load_two(glass.column, at, step),
        load_two(glass.size, at, step),
    )
