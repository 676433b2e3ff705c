"""Rays from the camera through the samples of a band."""

from typing import NamedTuple

from eyas.lanes import kernel
from eyas.render.kernels.bundles import Direction, Point, View
from eyas.render.kernels.scalars import f4

__all__ = ["Rays", "ray_of", "rays_of"]


class Rays(NamedTuple):
    """A camera, of float32."""

    eye: Direction
    """Optical centre [m]."""
    ahead: Direction
    """Unit vector along the optical axis; the next two are to the left and up."""
    left: Direction
    up: Direction
    across: float
    """One over the focal length along rows [1/samples]."""
    down: float
    """The same along columns."""
    middle: float
    """Column of the optical axis [samples]."""
    centre_line: float
    """Its row in the picture [samples]."""
    top: float
    """First row of the band [samples]."""
    pixel: float
    """Angle that a pixel spans [rad]."""


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
