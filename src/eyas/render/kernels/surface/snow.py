"""Snow: on surfaces that face up, in patches where thin, pushed off roads by wheels."""

import math
from enum import IntEnum

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.chance import noise
from eyas.render.kernels.scalars import f4, u4

__all__ = ["Bed", "snowed"]


class Bed(IntEnum):
    """Behaviour of snow on a material."""

    BARE = 0
    """No snow stays."""
    OPEN = 1
    """Snow lies as it fell."""
    DRIVEN = 2
    """Roads and their paint: wheels wear the snow off."""
    LEAVES = 3
    """Crowns of trees: clumps on branches."""
    VEHICLE = 4
    """Painted body of vehicles: a thin layer on level surfaces."""


BARE, DRIVEN = int(Bed.BARE), int(Bed.DRIVEN)
LEAVES, VEHICLE = int(Bed.LEAVES), int(Bed.VEHICLE)


@inlined_kernel
def _clip(value: float) -> float:
    """Return a value brought into 0 to 1."""
    return min(max(value, f4(0.0)), f4(1.0))


@inlined_kernel
def _seen_noise(x: float, y: float, cells: float, footprint: float) -> float:
    """Return noise with some cells in a metre, faded to its mean where a pixel covers them [m]."""
    sharp = f4(1.6) - f4(2.0) * cells * footprint
    if sharp <= f4(0.0):
        return f4(0.5)
    return f4(0.5) + min(sharp, f4(1.0)) * (noise(cells * x, cells * y) - f4(0.5))


@inlined_kernel
def _worn(light: Light, x: float, y: float, footprint: float) -> float:
    """Return how far wheels have worn the snow at a point, 0 to 1, see `tracks.TrackMap`."""
    per = light.track_frame[2]
    column, row = (x - light.track_frame[0]) * per, (y - light.track_frame[1]) * per
    column, row = column - f4(0.5), row - f4(0.5)
    rows, columns = light.tracks.shape[0], light.tracks.shape[1]
    zero = f4(0.0)
    if not (column > zero and row > zero and column < f4(columns - 2) and row < f4(rows - 2)):
        return zero
    i, j = u4(row), u4(column)
    across, down = column - f4(j), row - f4(i)
    far = _clip(f4(1.7) * footprint - f4(0.25))
    lower, right = u4(i + u4(1)), u4(j + u4(1))
    a, b = _texel(light, i, j, far), _texel(light, i, right, far)
    c, d = _texel(light, lower, j, far), _texel(light, lower, right, far)
    upper = a + across * (b - a)
    return f4(upper + down * (c + across * (d - c) - upper)) * f4(1.0 / 255.0)


@inlined_kernel
def _texel(light: Light, row: int, column: int, far: float) -> float:
    near = f4(light.tracks[row, column, 0])
    return near + far * (f4(light.tracks[row, column, 1]) - near)


@inlined_kernel
def _on_leaves(
    colour: tuple[float, float, float],
    point: tuple[float, float, float],
    above: tuple[float, float, float],
    rise: float,
    footprint: float,
) -> tuple[float, float]:
    """Return the share of a crown that snow hides, and how bright that is.

    It lies in clumps on branches, less at the sides and hardly below, and on the upper leaves,
    which are the bright ones of the texture: the dark gaps between them stay.

    Args:
        colour: Colour of the leaves.
        point: The point [m].
        above: The point from the middle of the crown, in the frame of the tree.
        rise: Upward component of its normal.
        footprint: Size of a pixel on the surface [m].
    """
    x, y, z = point
    away = math.sqrt(above[0] * above[0] + above[1] * above[1] + above[2] * above[2] + f4(1e-6))
    # A cluster of leaves is flat and has one normal; the crown's roundness changes smoothly.
    open_ = f4(0.7) * above[2] / away + f4(0.3) * rise
    # The second axis runs down the crown's sides too, faster: boughs are wider than high.
    bough = _seen_noise(x + f4(0.3) * y, y + f4(1.7) * z - f4(0.3) * x, f4(0.75), footprint)
    leaf = _clip(f4(5.5) * colour[1])
    cover = f4(0.8) * open_ + f4(1.0) * (bough - f4(0.5)) + f4(1.1) * (leaf - f4(0.5))
    return f4(0.92) * _clip(f4(1.7) * (cover - f4(0.1))), f4(0.78) + f4(0.2) * leaf


@inlined_kernel
def _on_road(
    colour: tuple[float, float, float], worn: float, grain: float, fine: float
) -> tuple[float, float, float]:
    """Return the colour of a road with snow: white beside the lanes, wet and dark in the tracks.

    Args:
        colour: Without snow.
        worn: Wear of the snow by wheels, 0 to 1.
        grain: Noise of a third of a metre, 0 to 1.
        fine: Noise of a tenth of a metre, 0 to 1.
    """
    ragged = worn * (f4(0.56) + f4(0.56) * grain + f4(0.36) * fine)
    share = f4(0.9) * max(_clip(f4(1.22) - f4(1.5) * ragged), f4(0.06))
    # Wheels compress and soil the snow that they do not push away.
    light = f4(0.96) - f4(0.52) * _clip(f4(1.3) * ragged) + f4(0.06) * (grain - f4(0.5))
    wet = f4(1.0) - f4(0.34) * _clip(f4(1.6) * ragged)
    return _mixed((wet * colour[0], wet * colour[1], wet * colour[2]), share, light)


@inlined_kernel
def _mixed(
    colour: tuple[float, float, float], share: float, light: float
) -> tuple[float, float, float]:
    return (
        colour[0] + share * (f4(0.84) * light - colour[0]),
        colour[1] + share * (f4(0.86) * light - colour[1]),
        colour[2] + share * (f4(0.89) * light - colour[2]),
    )


@inlined_kernel
def snowed(
    colour: tuple[float, float, float],
    light: Light,
    bed: int,
    middle: float,
    point: tuple[float, float, float],
    own: tuple[float, float, float],
    rise: float,
    footprint: float,
) -> tuple[float, float, float]:
    """Return the colour of a surface with the snow that lies on it.

    Args:
        colour: Without snow.
        light: Says how much has fallen, where the sun is, and where wheels have gone.
        bed: A `Bed`.
        middle: z of the middle of the crown in the frame of its tree, if it is one.
        point: The point [m].
        own: The point in the frame of the fixture or part it belongs to.
        rise: Upward component of its normal.
        footprint: Size of a pixel on the surface [m].
    """
    x, y = point[0], point[1]
    one, depth = f4(1.0), light.air[4]
    if bed == BARE or rise < f4(-0.6):
        return colour
    if bed == LEAVES:
        above = own[0], own[1], own[2] - middle
        share, white = _on_leaves(colour, point, above, rise, footprint)
        return _mixed(colour, depth * share, white)
    if bed == VEHICLE:
        grain = _seen_noise(own[0], own[1], f4(9.0), footprint)
        share = depth * _clip(f4(9.0) * (rise - f4(0.9))) * (f4(0.1) + f4(0.1) * grain)
        return _mixed(colour, share, f4(0.9))
    # Wind piles it up against kerbs and the feet of walls.
    foot = _clip(f4(1.6) - f4(5.0) * point[2])
    if rise < f4(0.1) and foot <= f4(0.0):
        return colour
    if bed == DRIVEN and rise > f4(0.9):
        worn = f4(0.45)  # the map of tracks does not cover bridges
        if point[2] < f4(1.0):
            worn = _worn(light, x, y, footprint)
        # Each turned differently, to hide the square cells of the noise.
        grain = _seen_noise(x + f4(0.5) * y, y - f4(0.5) * x, f4(1.9), footprint)
        fine = _seen_noise(x - f4(0.7) * y, y + f4(0.7) * x, f4(7.5), footprint)
        return _on_road(colour, worn + f4(1.2) * (one - depth), grain, fine)
    # Low, wide drifts, in rows across the wind.
    drift = noise(f4(0.075) * x + f4(0.03) * y, f4(0.13) * y - f4(0.06) * x)
    lies = one
    if rise < f4(0.97) or depth < one:
        # Steep faces are bare; where little has fallen, it lies in the hollows.
        patch = _seen_noise(x, y, f4(0.9), footprint)
        lies = _clip((rise - f4(0.45) + f4(0.5) * (patch - f4(0.5))) * f4(4.0))
        lies = max(lies, foot * _clip(f4(0.5) + patch))
        lies *= _clip(
            (patch + depth - f4(0.76)) * f4(4.0) + max(depth - f4(0.9), f4(0.0)) * f4(40.0)
        )
    return _mixed(colour, lies * (f4(0.12) + f4(0.85) * depth), f4(0.88) + f4(0.1) * drift)
