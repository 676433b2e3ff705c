"""What a triangle has at a point: texture coordinates, normal, material."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import BENT_COLUMNS, LOOK_COLUMNS, SHADING_COLUMNS, Band
from eyas.engine.render.kernels.colours import Vector
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.engine.render.kernels.wind import sways
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, bit_pattern, like, magnitude, root, select, to_i4, transposed


class Frame(NamedTuple):
    """Pose, of float32, `world = (xx xy xz; yx ...) own + (x, y, z)`, and looks of an instance."""

    xx: float
    xy: float
    xz: float
    x: float
    yx: float
    yy: float
    yz: float
    y: float
    zx: float
    zy: float
    zz: float
    z: float
    red: float
    """Linear."""
    green: float
    blue: float
    shrink: float
    """One over its scale squared."""
    lamps: int
    """Its lamps that shine, see `eyas.engine.state.draw.DrawList.lamps`."""


class Attributes(NamedTuple):
    """A point of a triangle."""

    u: float  # Texture coordinates [tiles]
    v: float
    u_slope: Vector  # Gradient of u in the frame of the instance [tiles/m]
    normal: Vector  # Unit normal, in the world
    own: Vector  # The point in the frame of the instance [m]
    density: float  # Texture tiles in a metre
    layer: int  # Texture
    surface: int  # A `Surface`
    bed: int  # A `Bed`
    tint: Vector  # Linear colour factor
    emission: float  # Own light
    crown_middle: float  # See `Geometry`
    building: int  # Object id of static triangles


@kernel(inline=True)
def _linear(value: float) -> float:
    """Return the linear value of an sRGB value (a cubic fit, within 0.003)."""
    return f4(value * (value * (value * f4(0.305306011) + f4(0.682171111)) + f4(0.012522878)))


@kernel(inline=True)
def _frame_of(
    poses: NDArray[np.float32], colours: NDArray[np.float32], lamps: NDArray[np.uint8], index: int
) -> Frame:
    """Return row `index` of poses, shape (., 3, 4), and if there are any of colours, (., 3), and of
    lamps, (.,).
    """
    p, one = poses[index], f4(1.0)
    red, green, blue = one, one, one
    if len(colours) > 0:
        red, green, blue = (
            _linear(colours[index, 0]), _linear(colours[index, 1]), _linear(colours[index, 2])
        )  # fmt: skip
    shining = i4(0)
    if len(lamps) > 0:
        shining = i4(lamps[index])
    square = p[0, 0] * p[0, 0] + p[1, 0] * p[1, 0] + p[2, 0] * p[2, 0]
    return Frame(
        p[0, 0], p[0, 1], p[0, 2], p[0, 3], p[1, 0], p[1, 1], p[1, 2], p[1, 3],
        p[2, 0], p[2, 1], p[2, 2], p[2, 3], red, green, blue, one / square, shining,
    )  # fmt: skip


@kernel(inline=True)
def instance_frame(band: Band, row: int) -> Frame:
    """Return an instance, a row of `Band.drawn`; fixtures have no colour and no such lamps.

    Wherever some of it is needed, it is asked for anew. Kept from one place to the next, it would
    be written to memory, and for the static mesh too, which has none.
    """
    geometry, movers, world = band.geometry, band.movers, band.world
    instance, fixtures = band.drawn[row, 1], len(geometry.fixture_object)
    if instance >= fixtures:
        colours, lamps = movers.colour[world], movers.lamps[world]
        return _frame_of(movers.pose[world], colours, lamps, instance - fixtures)
    colours, lamps = movers.colour[world, :0], movers.lamps[world, :0]
    if sways(band.light, instance):
        return _frame_of(band.leaning, colours, lamps, row)
    return _frame_of(geometry.fixture_pose, colours, lamps, instance)


@kernel(inline=True)
def _to_own(frame: Frame, point: Vector) -> Vector:
    """Return a world point in the frame of an instance."""
    f = frame
    x, y, z = point[0] - f.x, point[1] - f.y, point[2] - f.z
    return (
        (x * f.xx + y * f.yx + z * f.zx) * f.shrink,
        (x * f.xy + y * f.yy + z * f.zy) * f.shrink,
        (x * f.xz + y * f.yz + z * f.zz) * f.shrink,
    )


@kernel(inline=True)
def _turned(frame: Frame, v: Vector) -> Vector:
    """Return a vector of an instance's frame in the world, longer by its scale."""
    f = frame
    return (
        f.xx * v[0] + f.xy * v[1] + f.xz * v[2],
        f.yx * v[0] + f.yy * v[1] + f.yz * v[2],
        f.zx * v[0] + f.zy * v[1] + f.zz * v[2],
    )


@kernel(inline=True)
def attributes_of(
    band: Band,
    row: int,  # Its instance, a row of `Band.drawn`, or -1; the same for all lanes
    triangle: int,  # Its row in `Geometry.shading`
    point: Vector,  # The point [m]
) -> Attributes:
    """Return what a triangle has at a world point [m]."""
    geometry, moved = band.geometry, row >= 0
    shading = geometry.shading
    v_y, v_z, v0, nx, ny, nz, density, word = transposed(
        shading, triangle, 8, SHADING_COLUMNS, triangle
    )
    material = to_i4(bit_pattern(word) & i4(0xFFFF))
    layer, kind, red, green, blue, emission, crown, _ = transposed(
        geometry.look, material, 0, LOOK_COLUMNS, triangle
    )
    x0, y0, z0, u_x, u_y, u_z, u0, v_x = transposed(shading, triangle, 0, SHADING_COLUMNS, triangle)
    own = point
    if moved:
        own = _to_own(instance_frame(band, row), point)
    x, y, z = own[0] - x0, own[1] - y0, own[2] - z0
    u, v = u0 + u_x * x + u_y * y + u_z * z, v0 + v_x * x + v_y * y + v_z * z
    bent = density < f4(0.0)
    if any_of(bent):
        at = select(bent, bit_pattern(nx), i4(0))
        nx_x, nx_y, nx_z, ny_x, ny_y, ny_z, nz_x, nz_y = transposed(
            geometry.bent, at, 0, BENT_COLUMNS, triangle
        )
        _, _, _, _, nz_z, mx, my, mz = transposed(geometry.bent, at, 4, BENT_COLUMNS, triangle)
        nx = select(bent, mx + (nx_x * x + nx_y * y + nx_z * z), nx)
        ny = select(bent, my + (ny_x * x + ny_y * y + ny_z * z), ny)
        nz = select(bent, mz + (nz_x * x + nz_y * y + nz_z * z), nz)
    normal, density = (nx, ny, nz), magnitude(density)
    if moved:
        frame = instance_frame(band, row)
        normal = _turned(frame, normal)
        density *= root(frame.shrink)
    if moved or any_of(bent):
        nx, ny, nz = normal
        scale = f4(1.0) / root(nx * nx + ny * ny + nz * nz + f4(1e-12))
        scale = select(bent | like(bent, moved), scale, f4(1.0))
        normal = (nx * scale, ny * scale, nz * scale)
    kinds, building = bit_pattern(kind), to_i4(bit_pattern(word) >> i4(16))
    return Attributes(
        u, v, (u_x, u_y, u_z), normal, own, density, bit_pattern(layer), to_i4(kinds & i4(255)),
        to_i4(kinds >> i4(8)), (red, green, blue), emission, crown, building,
    )  # fmt: skip
