"""What the head and tail lamps of vehicles throw on the road."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.render.kernels.bundles import Geometry
from eyas.render.kernels.casters import set_caster
from eyas.render.kernels.cull import sphere_is_visible
from eyas.render.kernels.scalars import f4

__all__ = ["cast_beams"]

_REACH = 34.0
"""How far ahead of a vehicle its lamps light the road [m]."""

_BEHIND = 5.0
"""How far behind it its tail lamps do [m]."""


@inlined_kernel
def _head(ahead: float, aside: float, rise: float) -> float:
    """Return the light at a point ahead of a vehicle's front [m], 0 to 1.

    A dipped beam as its pattern on the road is: a fan that starts under the bumper, is brightest a
    car's length ahead, fades with distance and is cut off above the lamps.
    """
    if ahead <= 0.0 or ahead >= _REACH or rise > 1.2:
        return 0.0
    wide = 0.9 + 0.30 * ahead
    fan = 1.0 - (aside / wide) ** 2
    if fan <= 0.0:
        return 0.0
    near = min(ahead * 0.4, 1.0)
    far = 1.0 - ahead / _REACH
    low = min(1.0, (1.2 - rise) * 2.0)
    return float(fan * fan * near * near * far * far * low)


@inlined_kernel
def _tail(behind: float, aside: float, rise: float) -> float:
    """Return the red light at a point behind a vehicle's back [m], 0 to 1."""
    if behind <= 0.0 or behind >= _BEHIND or rise > 1.2:
        return 0.0
    fan = 1.0 - (aside / (1.0 + 0.35 * behind)) ** 2
    far = 1.0 - behind / _BEHIND
    return float(max(fan, 0.0) * far * far)


@inner_kernel
def _screen_box(
    caster: NDArray[np.float64], rows: NDArray[np.float64], lens: NDArray[np.float64]
) -> tuple[float, float, float, float]:
    """Return left, top, right, bottom of all that a vehicle's lamps may light, in samples."""
    left, top, right, bottom = 1e9, 1e9, -1e9, -1e9
    for corner in range(8):
        ahead = caster[4] + _REACH if corner & 1 else -caster[4] - _BEHIND
        wide = 0.9 + 0.30 * _REACH if corner & 1 else 3.0
        aside = wide if corner & 2 else -wide
        x = caster[0] + ahead * caster[2] - aside * caster[3]
        y = caster[1] + ahead * caster[3] + aside * caster[2]
        z = caster[6] + (1.3 if corner & 4 else -0.4)
        w = rows[2, 0] * x + rows[2, 1] * y + rows[2, 2] * z + rows[2, 3]
        if w < 0.1:
            return 0.0, 0.0, lens[1], lens[2]
        column = rows[0, 0] * x + rows[0, 1] * y + rows[0, 2] * z + rows[0, 3]
        row = rows[1, 0] * x + rows[1, 1] * y + rows[1, 2] * z + rows[1, 3]
        column, row = 0.5 * lens[1] + column / w, 0.5 * lens[2] + row / w
        left, right = min(left, column), max(right, column)
        top, bottom = min(top, row), max(bottom, row)
    return left, top, right, bottom


@inner_kernel
def _cast_one(
    caster: NDArray[np.float64],
    eye: NDArray[np.float64],
    axes: NDArray[np.float64],
    lens: NDArray[np.float64],
    top: int,
    box: tuple[float, float, float, float],
    depth: NDArray[np.float32],
    shade: NDArray[np.uint8],
) -> None:
    """Brighten the samples in `box` that one vehicle's lamps light.

    Its own body lies neither ahead of its front nor behind its back.
    """
    rows, width = depth.shape
    for line in range(max(int(box[1]) - top, 0), min(int(box[3]) + 1 - top, rows)):
        up = (0.5 * lens[2] - (line + top + 0.5)) / lens[4]
        for column in range(max(int(box[0]), 0), min(int(box[2]) + 1, width)):
            if depth[line, column] <= f4(0.0):
                continue
            left = (0.5 * lens[1] - (column + 0.5)) / lens[0]
            w = 1.0 / depth[line, column]
            dx = eye[0] + w * (axes[0, 0] + left * axes[1, 0] + up * axes[2, 0]) - caster[0]
            dy = eye[1] + w * (axes[0, 1] + left * axes[1, 1] + up * axes[2, 1]) - caster[1]
            rise = eye[2] + w * (axes[0, 2] + left * axes[1, 2] + up * axes[2, 2]) - caster[6]
            along, aside = dx * caster[2] + dy * caster[3], dy * caster[2] - dx * caster[3]
            head = 255.0 * _head(along - caster[4], aside, rise)
            tail = 255.0 * _tail(-along - caster[4], aside, rise)
            shade[line, column, 2] = min(int(shade[line, column, 2]) + int(head), 255)
            shade[line, column, 3] = min(int(shade[line, column, 3]) + int(tail), 255)


@inner_kernel
def cast_beams(
    geometry: Geometry,
    parts: NDArray[np.int32],
    poses: NDArray[np.float32],
    object_ids: NDArray[np.int32],
    eye: NDArray[np.float64],
    axes: NDArray[np.float64],
    lens: NDArray[np.float64],
    top: int,
    rows: NDArray[np.float64],
    planes: NDArray[np.float64],
    caster: NDArray[np.float64],
    depth: NDArray[np.float32],
    shade: NDArray[np.uint8],
) -> None:
    """Write the light of all vehicles' lamps on each sample into channels 2 and 3 of `shade`.

    Slots in a row with the same object id are one vehicle. See `Job` and `Scratch`.
    """
    shade[:, :, 2:] = 0
    first = 0
    half = 0.5 * (_REACH - _BEHIND)
    while first < len(parts):
        last = first + 1
        if parts[first] < 0:
            first = last
            continue
        while last < len(parts) and parts[last] >= 0 and object_ids[last] == object_ids[first]:
            last += 1
        set_caster(geometry, parts, poses, first, last, caster)
        x, y = caster[0] + half * caster[2], caster[1] + half * caster[3]
        if sphere_is_visible(planes, x, y, caster[6], caster[4] + half + 0.5 * _REACH):
            box = _screen_box(caster, rows, lens)
            if box[3] >= top and box[1] <= top + depth.shape[0]:
                _cast_one(caster, eye, axes, lens, top, box, depth, shade)
        first = last
