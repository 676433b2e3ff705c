"""Points of surfaces, eight at once, from the triangles that they show to packed bytes."""

from eyas.lanes import kernel
from eyas.lanes.vector import bits_of, first_bit, lane, select, splat
from eyas.render.kernels.bundles import Band
from eyas.render.kernels.light.tone import tone_bytes
from eyas.render.kernels.pixels import pack
from eyas.render.kernels.rays import Rays, ray_of
from eyas.render.kernels.scalars import f4, i4, u4
from eyas.render.kernels.surface.attributes import Frame, frame_of, no_frame
from eyas.render.kernels.surface.shade import shade_point
from eyas.render.kernels.visibility.key import drawn_of, triangle_of

__all__ = ["instance_frame", "packed_points"]

Colour = tuple[float, float, float]


@kernel(inline=True)
def instance_frame(band: Band, row: int) -> Frame:
    """Return pose and colour of an instance, a row of `Band.drawn`; fixtures have no colour."""
    geometry, movers, world = band.geometry, band.movers, band.world
    instance, fixtures = band.drawn[row, 1], len(geometry.fixture_object)
    if instance >= fixtures:
        return frame_of(movers.pose[world], movers.colour[world], instance - fixtures)
    return frame_of(geometry.fixture_pose, movers.colour[world, :0], instance)


@kernel(inline=False)
def _one_instance(
    band: Band,
    row: int,
    triangle: int,
    eye: Colour,
    ray: Colour,
    away: float,
    pixel: float,
    shade: int,
) -> int:
    """Return the packed bytes of eight points of one instance, a row of `Band.drawn`.

    A function of its own: inlined into the loops that call it, the hundred numbers that are the
    same for all points would be spread over lanes before each loop, kept in memory and read again.
    """
    light, lit, frame, first = band.light, band.lit, no_frame(), i4(0)
    if row >= 0:
        frame, first = instance_frame(band, row), band.drawn[row, 0]
    colour = shade_point(
        band.geometry, light, lit, triangle + first, row >= 0, frame, eye, ray, away, pixel, shade
    )
    red, green, blue = tone_bytes(light, lit.air.exposure, colour)
    return pack(red, green, blue)


@kernel(inline=True)
def packed_points(
    band: Band,
    rays: Rays,
    tag: int,
    wanted: bool,
    distance: float,
    line: float,
    column: float,
    shade: int,
) -> int:
    """Return the packed bytes of eight samples; those not wanted are 0.

    All samples of one instance are computed together: its pose is the same number in all lanes.
    """
    ray, eye = ray_of(rays, line, column), (rays.eye.x, rays.eye.y, rays.eye.z)
    row, triangle = drawn_of(tag), triangle_of(tag)
    packed, left = splat(u4(0)), bits_of(wanted)
    while left != 0:
        which = lane(row, first_bit(left))
        same = wanted & (row == which)
        left &= ~bits_of(same)
        known, away = select(same, triangle, i4(0)), select(same, distance, f4(1.0))
        shown = _one_instance(band, which, known, eye, ray, away, rays.pixel, shade)
        packed = select(same, shown, packed)
    return packed
