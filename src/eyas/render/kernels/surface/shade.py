"""The colour of one point of a surface."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Geometry, Light
from eyas.render.kernels.light.ambient import openness
from eyas.render.kernels.light.lamps import night_light, window_light
from eyas.render.kernels.light.sunlight import sunlight
from eyas.render.kernels.scalars import f4, u4
from eyas.render.kernels.sky.radiance import fog_share, reflection
from eyas.render.kernels.surface.snow import snowed
from eyas.render.kernels.surface.texture import level_of, texel
from eyas.render.kernels.surface.water import water_colour, water_slope
from eyas.state.mesh import Surface

__all__ = ["shade_point"]


PAINT = int(Surface.PAINT)
GLASS = int(Surface.GLASS)
FOLIAGE = int(Surface.FOLIAGE)
FACADE = int(Surface.FACADE)
WATER = int(Surface.WATER)


@inlined_kernel
def _to_local(
    frame: NDArray[np.float32], x: float, y: float, z: float
) -> tuple[float, float, float]:
    """Return a world point in the frame of an instance, see `Scratch.frame`."""
    m = frame
    x -= m[3]
    y -= m[7]
    z -= m[11]
    return (
        (m[0] * x + m[4] * y + m[8] * z) * m[15],
        (m[1] * x + m[5] * y + m[9] * z) * m[15],
        (m[2] * x + m[6] * y + m[10] * z) * m[15],
    )


@inlined_kernel
def _attributes(
    gradients: NDArray[np.float32], triangle: int, x: float, y: float, z: float, bent: bool
) -> tuple[float, float, float, float, float]:
    """Return u, v and the normal, see `Geometry.gradients`; a bent one is not yet of length 1."""
    g, t = gradients, triangle
    x -= g[t, 0]
    y -= g[t, 1]
    z -= g[t, 2]
    u = g[t, 3] * x + g[t, 4] * y + g[t, 5] * z + g[t, 6]
    v = g[t, 7] * x + g[t, 8] * y + g[t, 9] * z + g[t, 10]
    nx, ny, nz = g[t, 11], g[t, 12], g[t, 13]
    if bent:
        nx += g[t, 14] * x + g[t, 15] * y + g[t, 16] * z
        ny += g[t, 17] * x + g[t, 18] * y + g[t, 19] * z
        nz += g[t, 20] * x + g[t, 21] * y + g[t, 22] * z
    return u, v, nx, ny, nz


@inlined_kernel
def _unit(x: float, y: float, z: float) -> tuple[float, float, float]:
    scale = f4(1.0) / math.sqrt(x * x + y * y + z * z + f4(1e-12))
    return x * scale, y * scale, z * scale


@inlined_kernel
def _albedo(
    geometry: Geometry, material: int, level: int, u: float, v: float
) -> tuple[float, float, float, float]:
    """Return the linear colour and the alpha, 0 to 1, of a material."""
    packed = texel(geometry.texture, geometry.layer[material], level, u, v)
    scale = f4(1.0 / 255.0)
    red, green = f4(packed & 255) * scale, f4((packed >> 8) & 255) * scale
    blue = f4((packed >> 16) & 255) * scale
    return (
        red * red * geometry.tint[material, 0],
        green * green * geometry.tint[material, 1],
        blue * blue * geometry.tint[material, 2],
        f4(packed >> 24) * scale,
    )


@inlined_kernel
def _smoothness(surface: int, alpha: float) -> float:
    """Return the share of light that a surface mirrors at normal incidence."""
    if surface == PAINT:
        return f4(0.05)
    if surface == GLASS:
        return f4(0.08)
    if surface == WATER:
        return f4(0.04)
    if surface == FACADE:
        return f4(0.16) * (f4(1.0) - alpha)
    return f4(0.0)


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
    shade: NDArray[np.uint8],
) -> tuple[float, float, float]:
    """Return the linear radiance of a point, air included.

    Args:
        geometry: Everything that can be drawn.
        light: Light and air.
        triangle: Index of the triangle.
        moved: Whether it belongs to a fixture or a part, not to the static mesh.
        frame: Pose and colour of that, see `Scratch.frame`.
        eye: Optical centre [m].
        ray: From the eye, of length 1 along the optical axis.
        distance: Along the optical axis [m].
        pixel: Angle that a pixel spans [rad].
        shade: Effect of moving things on its light, see `Scratch.shade`.
    """
    one, zero = f4(1.0), f4(0.0)
    sun_share, sky_share = f4(shade[0]) * f4(1.0 / 255.0), f4(shade[1]) * f4(1.0 / 255.0)
    x = eye[0] + ray[0] * distance
    y = eye[1] + ray[1] * distance
    z = eye[2] + ray[2] * distance
    t = u4(triangle)
    density = geometry.gradients[t, 23]
    px, py, pz = x, y, z
    if moved:
        px, py, pz = _to_local(frame, x, y, z)
        density *= math.sqrt(frame[15])
    u, v, nx, ny, nz = _attributes(geometry.gradients, t, px, py, pz, density < zero)
    if moved:
        nx, ny, nz = (
            frame[0] * nx + frame[1] * ny + frame[2] * nz,
            frame[4] * nx + frame[5] * ny + frame[6] * nz,
            frame[8] * nx + frame[9] * ny + frame[10] * nz,
        )
    normal = (nx, ny, nz)
    if moved or density < zero:
        normal = _unit(nx, ny, nz)
    stretch = math.sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2])
    shrink = one / stretch
    way = (ray[0] * shrink, ray[1] * shrink, ray[2] * shrink)
    cosine = -(normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2])

    material = u4(geometry.material[t])
    surface = geometry.surface[material]
    span = f4(256.0) * density * distance * pixel
    level = level_of(span * span / max(abs(cosine), f4(0.1)))
    red, green, blue, alpha = _albedo(geometry, material, level, u, v)
    if surface == PAINT:
        red *= frame[12]
        green *= frame[13]
        blue *= frame[14]
    elif surface == WATER:
        slope_x, slope_y = water_slope(geometry.texture, geometry.layer[material], level, u, v)
        # Seen at a grazing angle, the far sides of waves are hidden: none mirrors the ground.
        calm = min(max(f4(1.5) * cosine, f4(0.1)), one)
        slope_x *= calm
        slope_y *= calm
        normal = _unit(normal[0] - slope_x, normal[1] - slope_y, normal[2])
        cosine = -(normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2])
        red, green, blue = water_colour(geometry.tint, material, slope_x + slope_y)

    if light.air[4] > zero:
        footprint = distance * pixel / max(abs(cosine), f4(0.1))
        red, green, blue = snowed(
            (red, green, blue), light, geometry.snow_bed[material],
            geometry.crown_middle[material], (x, y, z), (px, py, pz), normal[2], footprint,
        )  # fmt: skip
    direct, reaching = sunlight(light, x, y, z, normal, sun_share, surface == FOLIAGE)
    tilt = f4(0.5) * normal[2]
    if surface == FOLIAGE:
        tilt = f4(0.2) + f4(0.5) * tilt  # leaves below get light through those above
    sky_share *= openness(light, x, y, z, normal[0], normal[1])
    up, down = (f4(0.5) + tilt) * sky_share, (f4(0.5) - tilt) * sky_share
    sun, above, below = light.sun_colour, light.ambient_up, light.ambient_down
    light_r = direct * sun[0] + up * above[0] + down * below[0]
    light_g = direct * sun[1] + up * above[1] + down * below[1]
    light_b = direct * sun[2] + up * above[2] + down * below[2]
    if light.air[5] > zero:
        lamp_r, lamp_g, lamp_b = night_light(light, x, y, z, normal, shade)
        glow = light.air[5] * geometry.emission[material]
        light_r += lamp_r + glow
        light_g += lamp_g + glow
        light_b += lamp_b + glow
    shown = zero
    if surface == FACADE and light.air[6] > zero:
        shown = one - alpha
    window_r, window_g, window_b = zero, zero, zero
    if shown > zero:
        window_r, window_g, window_b = window_light(light, geometry.object_id, t, level, u, v)
        # Blinds and curtains are paler than dark rooms, so more light comes out through them.
        window_r *= shown * (f4(0.35) + shown * red)
        window_g *= shown * (f4(0.35) + shown * green)
        window_b *= shown * (f4(0.35) + shown * blue)
    red = red * light_r + window_r
    green = green * light_g + window_g
    blue = blue * light_b + window_b
    mirror = _smoothness(surface, alpha)
    if mirror > zero:
        facing = min(max(cosine, zero), one)
        mr, mg, mb, share = reflection(light, way, normal, facing, mirror, reaching)
        if surface == FACADE:
            share *= one - alpha
        elif surface == PAINT:
            share *= f4(0.6)  # clear coat is no mirror, even at a grazing angle
        red += share * (mr - red)
        green += share * (mg - green)
        blue += share * (mb - blue)
    if light.air[0] > zero:
        hidden = fog_share(light, distance * stretch)
        red += hidden * (light.fog[0] - red)
        green += hidden * (light.fog[1] - green)
        blue += hidden * (light.fog[2] - blue)
    return red, green, blue
