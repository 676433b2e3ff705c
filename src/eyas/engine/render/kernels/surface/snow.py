"""Snow: on surfaces that face up, in patches where thin, pushed off roads by wheels."""

from enum import IntEnum

from eyas.engine.render.kernels.bundles import Light
from eyas.engine.render.kernels.colours import Colour, clip, where
from eyas.engine.render.kernels.hash_noise import noise, seen_noise
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, gather, greater, like, root, select, to_f4, to_i4


class Bed(IntEnum):
    """Behaviour of snow on a material."""

    BARE = 0  # No snow stays
    OPEN = 1  # Snow lies as it fell
    DRIVEN = 2  # Roads and their paint: wheels wear the snow off
    LEAVES = 3  # Crowns of trees: clumps on branches
    VEHICLE = 4  # Painted body of vehicles: a thin layer on level surfaces
    POROUS = 5  # Lawn and soil: like `OPEN`, but rain soaks in


BARE, DRIVEN = i4(int(Bed.BARE)), i4(int(Bed.DRIVEN))
LEAVES, VEHICLE, POROUS = i4(int(Bed.LEAVES)), i4(int(Bed.VEHICLE)), i4(int(Bed.POROUS))


@kernel(inline=True)
def _worn(light: Light, x: float, y: float, footprint: float) -> float:
    """Return how far wheels have worn the snow at a point, 0 to 1, see `tracks.TrackMap`."""
    frame, tracks = light.track_frame, light.tracks
    column = (x - frame.west) * frame.per_metre - f4(0.5)
    row = (y - frame.south) * frame.per_metre - f4(0.5)
    rows, columns = tracks.shape[0], tracks.shape[1]
    zero = f4(0.0)
    inside = (column > zero) & (row > zero)
    inside &= (column < f4(columns - 2)) & (row < f4(rows - 2))
    if not any_of(inside):
        return like(x, zero)
    column, row = select(inside, column, zero), select(inside, row, zero)
    i, j = to_i4(row), to_i4(column)
    across, down = column - to_f4(j), row - to_f4(i)
    far = clip(f4(1.7) * footprint - f4(0.25))
    step = i4(2 * columns)
    at = (i * i4(columns) + j) * i4(2)
    a, b = _texel(light, at, far), _texel(light, at + i4(2), far)
    c, d = _texel(light, at + step, far), _texel(light, at + step + i4(2), far)
    upper = a + across * (b - a)
    worn = upper + down * (c + across * (d - c) - upper)
    return select(inside, worn * f4(1.0 / 255.0), zero)


@kernel(inline=True)
def _texel(light: Light, at: int, far: float) -> float:
    near = to_f4(gather(light.tracks, at))
    return near + far * (to_f4(gather(light.tracks, at + i4(1))) - near)


@kernel(inline=True)
def _on_leaves(
    green: float,  # Green of the leaves
    point: Colour,  # The point [m]
    above: Colour,  # The point from the middle of the crown, in the frame of the tree
    rise: float,  # Upward component of its normal
    footprint: float,  # Size of a pixel on the surface [m]
) -> tuple[float, float]:
    """Return the share of a crown that snow hides, and how bright that is.

    It lies in clumps on branches, less at the sides and hardly below, and on the upper leaves,
    which are the bright ones of the texture: the dark gaps between them stay.
    """
    x, y, z = point
    away = root(above[0] * above[0] + above[1] * above[1] + above[2] * above[2] + f4(1e-6))
    # A cluster of leaves is flat and has one normal; the crown's roundness changes smoothly.
    open_ = f4(0.7) * above[2] / away + f4(0.3) * rise
    # The second axis runs down the crown's sides too, faster: boughs are wider than high.
    bough = seen_noise(x + f4(0.3) * y, y + f4(1.7) * z - f4(0.3) * x, f4(0.75), footprint)
    leaf = clip(f4(5.5) * green)
    cover = f4(0.8) * open_ + (bough - f4(0.5)) + f4(1.1) * (leaf - f4(0.5))
    return f4(0.92) * clip(f4(1.7) * (cover - f4(0.1))), f4(0.78) + f4(0.2) * leaf


@kernel(inline=True)
def _on_road(
    colour: Colour,  # Without snow
    worn: float,  # Wear of the snow by wheels, 0 to 1
    grain: float,  # Noise of a third of a metre, 0 to 1
    fine: float,  # Noise of a tenth of a metre, 0 to 1
) -> Colour:
    """Return the colour of a road with snow: white beside the lanes, wet and dark in the tracks."""
    ragged = worn * (f4(0.74) + f4(0.24) * grain + f4(0.32) * fine)
    share = f4(0.9) * greater(clip(f4(1.22) - f4(1.5) * ragged), f4(0.11))
    # Wheels compress and soil the snow that they do not push away.
    light = f4(0.96) - f4(0.52) * clip(f4(1.3) * ragged) + f4(0.06) * (grain - f4(0.5))
    # Beside them lies what the plough has thrown up: lumps, grey with grit.
    lumps = f4(0.6) * grain + f4(0.4) * fine
    light -= f4(0.34) * clip(f4(1.0) - f4(2.5) * worn) * clip(f4(1.3) - f4(1.9) * lumps)
    wet = f4(1.0) - f4(0.34) * clip(f4(1.6) * ragged)
    return _mixed((wet * colour[0], wet * colour[1], wet * colour[2]), share, light)


@kernel(inline=True)
def _mixed(colour: Colour, share: float, light: float) -> Colour:
    return (
        colour[0] + share * (f4(0.84) * light - colour[0]),
        colour[1] + share * (f4(0.86) * light - colour[1]),
        colour[2] + share * (f4(0.89) * light - colour[2]),
    )


@kernel(inline=True)
def _lying(
    colour: Colour,
    depth: float,
    bed: int,
    point: Colour,
    rise: float,
    foot: float,
    footprint: float,
) -> Colour:
    """Return the colour of a surface on which snow lies as it fell, in low, wide drifts."""
    x, y, half, one = point[0], point[1], f4(0.5), f4(1.0)
    # In rows across the wind.
    drift = noise(f4(0.075) * x + f4(0.03) * y, f4(0.13) * y - f4(0.06) * x)
    patch = seen_noise(x + f4(0.3) * y, y - f4(0.3) * x, f4(0.8), footprint)
    fine = seen_noise(x - f4(0.5) * y, y + f4(0.5) * x, f4(4.3), footprint)
    lies = like(rise, one)
    partly = (rise < f4(0.97)) | like(rise < f4(0.97), depth < one)
    if any_of(partly):
        # Steep faces are bare, in ledges as wide as the drifts; where little has fallen, it lies in
        # the hollows.
        ragged = f4(0.36) * (drift - half) + f4(0.14) * (patch - half) + f4(0.06) * (fine - half)
        hollow = clip((rise - f4(0.46) + ragged) * f4(4.0))
        hollow = greater(hollow, foot * clip(half + patch + f4(0.6) * (fine - half)))
        much = greater(depth - f4(0.9), f4(0.0)) * f4(40.0)
        fallen = (patch + f4(0.5) * (fine - half) + (depth - f4(0.76))) * f4(4.0) + much
        lies = select(partly, hollow * clip(fallen), lies)
    # Stubble, tufts and stones stick out; from what is paved or warm, it has melted here and there.
    ground, stalk = bed == POROUS, like(rise, half)
    if any_of(ground):
        stalk = seen_noise(x + f4(0.8) * y, y - f4(0.8) * x, f4(11.0), f4(2.0) * footprint)
    out = f4(5.0) * (f4(0.3) * fine + f4(0.3) * patch + f4(0.4) * stalk - f4(0.62))
    gone = f4(5.0) * (f4(0.24) - f4(0.75) * patch - f4(0.25) * fine)
    lies *= one - select(ground, f4(0.6) * clip(out), f4(0.7) * clip(gone))
    share = lies * (f4(0.12) + f4(0.85) * depth)
    bright = f4(0.865) + f4(0.1) * drift + f4(0.13) * (patch - half) + f4(0.06) * (fine - half)
    return _mixed(colour, share, bright)


@kernel(inline=True)
def snowed(
    colour: Colour,  # Without snow
    light: Light,  # Says where wheels have gone
    depth: float,  # How much has fallen, 0 to 1
    bed: int,  # A `Bed`
    middle: float,  # z of the middle of the crown in the frame of its tree, if it is one
    point: Colour,  # The point [m]
    own: Colour,  # The point in the frame of the fixture or part it belongs to
    rise: float,  # Upward component of its normal
    footprint: float,  # Size of a pixel on the surface [m]
) -> Colour:
    """Return the colour of a surface with the snow that lies on it."""
    result = colour
    white = (bed != BARE) & (rise >= f4(-0.6))
    leaves, vehicle = white & (bed == LEAVES), white & (bed == VEHICLE)
    if any_of(leaves):
        above = own[0], own[1], own[2] - middle
        share, bright = _on_leaves(colour[1], point, above, rise, footprint)
        result = where(leaves, _mixed(colour, depth * share, bright), result)
    if any_of(vehicle):
        # On roof and bonnet, in patches that wind and heat have left.
        grain = seen_noise(own[0] + point[2], own[1], f4(2.3), footprint)
        share = depth * clip(f4(5.0) * (rise - f4(0.76))) * clip(f4(0.15) + f4(1.1) * grain)
        result = where(vehicle, _mixed(colour, share, f4(0.9)), result)
    # Wind piles it up against kerbs and the feet of walls.
    foot = clip(f4(1.6) - f4(5.0) * point[2])
    ground = white & (bed != LEAVES) & (bed != VEHICLE) & ((rise >= f4(0.1)) | (foot > f4(0.0)))
    road = ground & (bed == DRIVEN) & (rise > f4(0.9))
    if any_of(road):
        x, y = point[0], point[1]
        # The map of tracks does not cover bridges.
        worn = select(point[2] < f4(1.0), _worn(light, x, y, footprint), f4(0.22))
        # Each turned differently, to hide the square cells of the noise.
        grain = seen_noise(x + f4(0.5) * y, y - f4(0.5) * x, f4(1.9), footprint)
        fine = seen_noise(x - f4(0.7) * y, y + f4(0.7) * x, f4(7.5), footprint)
        worn += f4(1.2) * (f4(1.0) - depth)
        result = where(road, _on_road(colour, worn, grain, fine), result)
    lying = ground & ~road
    if any_of(lying):
        result = where(lying, _lying(colour, depth, bed, point, rise, foot, footprint), result)
    return result
