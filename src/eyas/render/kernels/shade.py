"""The colour of one point of a surface."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Geometry, Light
from eyas.render.kernels.scalars import f4, u4
from eyas.render.kernels.sky import fog_share, sky
from eyas.render.kernels.texture import level_of, texel
from eyas.state.mesh import Surface

__all__ = ["shade_point"]


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
    height = max(height, zero)  # the map's zero is nothing at all
    if not (column > zero and line > zero and column < f4(columns - 2) and line < f4(lines - 2)):
        return one
    i, j = u4(line), u4(column)
    across, down = column - f4(j), line - f4(i)
    right, lower = j + u4(1), i + u4(1)
    a = one if f4(light.shadow_map[i, j]) <= height else zero
    b = one if f4(light.shadow_map[i, right]) <= height else zero
    c = one if f4(light.shadow_map[lower, j]) <= height else zero
    d = one if f4(light.shadow_map[lower, right]) <= height else zero
    upper = a + across * (b - a)
    return f4(upper + down * (c + across * (d - c) - upper))


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


@inlined_kernel
def shade_point(
    geometry: Geometry,
    light: Light,
    triangle: int,
    moved: bool,
    frame: NDArray[np.float32],
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
        moved: Whether it belongs to a fixture or a part, not to the static mesh.
        frame: Pose and colour of that, see `Scratch.frame`.
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
    g, t = geometry.gradients, u4(triangle)
    density = g[t, 23]
    px, py, pz = x, y, z
    m = frame
    if moved:
        dx, dy, dz = x - m[3], y - m[7], z - m[11]
        inverse = m[15]
        px = (m[0] * dx + m[4] * dy + m[8] * dz) * inverse
        py = (m[1] * dx + m[5] * dy + m[9] * dz) * inverse
        pz = (m[2] * dx + m[6] * dy + m[10] * dz) * inverse
        density *= np.sqrt(inverse)
    px -= g[t, 0]
    py -= g[t, 1]
    pz -= g[t, 2]
    u = g[t, 3] * px + g[t, 4] * py + g[t, 5] * pz + g[t, 6]
    v = g[t, 7] * px + g[t, 8] * py + g[t, 9] * pz + g[t, 10]
    nx = g[t, 11] + g[t, 14] * px + g[t, 15] * py + g[t, 16] * pz
    ny = g[t, 12] + g[t, 17] * px + g[t, 18] * py + g[t, 19] * pz
    nz = g[t, 13] + g[t, 20] * px + g[t, 21] * py + g[t, 22] * pz
    if moved:
        nx, ny, nz = (
            m[0] * nx + m[1] * ny + m[2] * nz,
            m[4] * nx + m[5] * ny + m[6] * nz,
            m[8] * nx + m[9] * ny + m[10] * nz,
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

    material = u4(geometry.material[t])
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
        red *= m[12]
        green *= m[13]
        blue *= m[14]
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
