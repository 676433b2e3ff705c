"""The colour of one point of a surface."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, kernel
from eyas.render.kernels.bundles import Geometry, Light
from eyas.render.kernels.sky import fog_share, sky
from eyas.render.kernels.texture import level_of, texel
from eyas.state.mesh import Surface

__all__ = ["shade_point"]

f4 = np.float32

PAINT = int(Surface.PAINT)
GLASS = int(Surface.GLASS)
FOLIAGE = int(Surface.FOLIAGE)
FACADE = int(Surface.FACADE)
WATER = int(Surface.WATER)
LAMP = int(Surface.LAMP)


@inlined_kernel
def _sunlit(light: Light, x: float, y: float, z: float) -> float:
    """Return how much of the sun reaches a point, 0 to 1, blended over four texels."""
    rows = light.shadow_rows
    column = rows[0, 0] * x + rows[0, 1] * y + rows[0, 2] * z + rows[0, 3]
    line = rows[1, 0] * x + rows[1, 1] * y + rows[1, 2] * z + rows[1, 3]
    height = rows[2, 0] * x + rows[2, 1] * y + rows[2, 2] * z + rows[2, 3]
    lines, columns = light.shadow_map.shape
    one, zero = f4(1.0), f4(0.0)
    if not (column > zero and line > zero and column < f4(columns - 2) and line < f4(lines - 2)):
        return one
    i, j = np.uint32(line), np.uint32(column)
    across, down = column - f4(j), line - f4(i)
    right, lower = j + np.uint32(1), i + np.uint32(1)
    a = one if f4(light.shadow_map[i, j]) <= height else zero
    b = one if f4(light.shadow_map[i, right]) <= height else zero
    c = one if f4(light.shadow_map[lower, j]) <= height else zero
    d = one if f4(light.shadow_map[lower, right]) <= height else zero
    upper = a + across * (b - a)
    return upper + down * (c + across * (d - c) - upper)


@inlined_kernel
def _linear(byte: float) -> float:
    """Return the linear value of an sRGB value (cubic fit, within 0.003)."""
    return byte * (byte * (byte * f4(0.305306011) + f4(0.682171111)) + f4(0.012522878))


@inlined_kernel
def _reflection(
    light: Light,
    ray: tuple[float, float, float],
    normal: tuple[float, float, float],
    facing: float,
    least: float,
    sunlit: float,
) -> tuple[float, float, float, float]:
    """Return what a smooth surface mirrors, and the share of it (Schlick's formula).

    Args:
        light: Sky and sun.
        ray: From the eye, of length 1.
        normal: Of the surface, of length 1.
        facing: Minus their dot product, 0 to 1.
        least: Share that is mirrored when looking straight at it.
        sunlit: How much of the sun reaches the surface.
    """
    x = ray[0] + f4(2.0) * facing * normal[0]
    y = ray[1] + f4(2.0) * facing * normal[1]
    z = ray[2] + f4(2.0) * facing * normal[2]
    graze = f4(1.0) - facing
    square = graze * graze
    share = least + (f4(1.0) - least) * square * square * graze
    red, green, blue = sky(light, x, y, z)
    shine = max(x * light.sun[0] + y * light.sun[1] + z * light.sun[2], f4(0.0))
    for _ in range(6):
        shine *= shine
    shine *= f4(6.0) * sunlit
    return (
        red + shine * light.sun_colour[0],
        green + shine * light.sun_colour[1],
        blue + shine * light.sun_colour[2],
        share,
    )


@kernel
def shade_point(
    geometry: Geometry,
    light: Light,
    triangle: int,
    pose: NDArray[np.float32],
    instance: int,
    colour: NDArray[np.float32],
    eye: tuple[float, float, float],
    ray: tuple[float, float, float],
    distance: float,
    pixel: float,
    sun_share: float,
    sky_share: float,
) -> tuple[float, float, float]:
    """Return the linear radiance of a point, air included.

    Args:
        geometry: Everything that can be drawn.
        light: Light and air.
        triangle: Which triangle.
        pose: Poses of the kind of instance it belongs to, shape (., 3, 4).
        instance: Row of `pose`, -1 for the static mesh.
        colour: Body colours, sRGB, shape (., 3).
        eye: Optical centre [m].
        ray: From the eye, of length 1 along the optical axis.
        distance: Along the optical axis [m].
        pixel: Angle that a pixel spans [rad].
        sun_share: Sunlight that moving things let through, 0 to 1.
        sky_share: The same for light of the sky.
    """
    one, zero = f4(1.0), f4(0.0)
    x = eye[0] + ray[0] * distance
    y = eye[1] + ray[1] * distance
    z = eye[2] + ray[2] * distance
    g = geometry.gradients[triangle]
    density = g[23]
    px, py, pz = x, y, z
    if instance >= 0:
        m = pose[instance]
        dx, dy, dz = x - m[0, 3], y - m[1, 3], z - m[2, 3]
        inverse = one / (m[0, 0] * m[0, 0] + m[1, 0] * m[1, 0] + m[2, 0] * m[2, 0])
        px = (m[0, 0] * dx + m[1, 0] * dy + m[2, 0] * dz) * inverse
        py = (m[0, 1] * dx + m[1, 1] * dy + m[2, 1] * dz) * inverse
        pz = (m[0, 2] * dx + m[1, 2] * dy + m[2, 2] * dz) * inverse
        density *= np.sqrt(inverse)
    px -= g[0]
    py -= g[1]
    pz -= g[2]
    u = g[3] * px + g[4] * py + g[5] * pz + g[6]
    v = g[7] * px + g[8] * py + g[9] * pz + g[10]
    nx = g[11] + g[14] * px + g[15] * py + g[16] * pz
    ny = g[12] + g[17] * px + g[18] * py + g[19] * pz
    nz = g[13] + g[20] * px + g[21] * py + g[22] * pz
    if instance >= 0:
        m = pose[instance]
        nx, ny, nz = (
            m[0, 0] * nx + m[0, 1] * ny + m[0, 2] * nz,
            m[1, 0] * nx + m[1, 1] * ny + m[1, 2] * nz,
            m[2, 0] * nx + m[2, 1] * ny + m[2, 2] * nz,
        )
    length = one / np.sqrt(nx * nx + ny * ny + nz * nz + f4(1e-12))
    nx *= length
    ny *= length
    nz *= length
    stretch = np.sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2])
    unit = one / stretch
    rx, ry, rz = ray[0] * unit, ray[1] * unit, ray[2] * unit
    cosine = -(nx * rx + ny * ry + nz * rz)
    facing = min(max(cosine, zero), one)

    material = geometry.material[triangle]
    surface = geometry.surface[material]
    span = f4(256.0) * density * distance * pixel
    level = level_of(span * span / max(abs(cosine), f4(0.1)))
    packed = texel(geometry.texture, geometry.layer[material], level, u, v)
    byte = f4(1.0 / 255.0)
    red, green, blue = (
        f4(packed & 255) * byte,
        f4((packed >> 8) & 255) * byte,
        f4((packed >> 16) & 255) * byte,
    )
    alpha = f4(packed >> 24) * byte
    red *= red * geometry.tint[material, 0]
    green *= green * geometry.tint[material, 1]
    blue *= blue * geometry.tint[material, 2]
    mirror = zero
    if surface == PAINT:
        red *= _linear(colour[instance, 0])
        green *= _linear(colour[instance, 1])
        blue *= _linear(colour[instance, 2])
        mirror = f4(0.05)
    elif surface == GLASS:
        mirror = f4(0.12)
    elif surface == WATER:
        mirror = f4(0.04)
        nx += f4(0.025) * np.sin(f4(1.9) * x + f4(0.8) * y) + f4(0.02) * np.sin(f4(4.3) * y - x)
        ny += f4(0.025) * np.sin(f4(2.3) * y - f4(0.6) * x) + f4(0.02) * np.sin(f4(3.7) * x + y)
    elif surface == FACADE and alpha < f4(0.99):
        mirror = f4(0.16) * (one - alpha)

    lean = nx * light.sun[0] + ny * light.sun[1] + nz * light.sun[2]
    offset = light.air[3]
    if surface == FOLIAGE:
        lean = f4(0.2) + (f4(0.8) * lean if lean > zero else f4(-0.3) * lean)
        offset += f4(0.7)
    sunlit = zero
    if lean > zero:
        sunlit = sun_share * _sunlit(light, x + offset * nx, y + offset * ny, z + offset * nz)
    direct = max(lean, zero) * sunlit
    up = (f4(0.5) + f4(0.5) * nz) * sky_share
    down = (f4(0.5) - f4(0.5) * nz) * sky_share
    glow = geometry.emission[material]
    if surface == FACADE:
        glow *= one - alpha  # lit windows in a dark wall
    red *= (
        direct * light.sun_colour[0]
        + up * light.ambient_up[0]
        + down * light.ambient_down[0]
        + glow
    )
    green *= (
        direct * light.sun_colour[1]
        + up * light.ambient_up[1]
        + down * light.ambient_down[1]
        + glow
    )
    blue *= (
        direct * light.sun_colour[2]
        + up * light.ambient_up[2]
        + down * light.ambient_down[2]
        + glow
    )
    if mirror > zero:
        mr, mg, mb, share = _reflection(light, (rx, ry, rz), (nx, ny, nz), facing, mirror, sunlit)
        if surface == FACADE:
            share *= one - alpha
        red += share * (mr - red)
        green += share * (mg - green)
        blue += share * (mb - blue)
    if light.air[0] > zero:
        hidden = fog_share(light, distance * stretch)
        red += hidden * (light.fog[0] - red)
        green += hidden * (light.fog[1] - green)
        blue += hidden * (light.fog[2] - blue)
    return red, green, blue
