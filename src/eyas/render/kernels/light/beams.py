"""Light of vehicles' head and tail lamps on the road."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.render.kernels.bundles import View
from eyas.render.kernels.samples import around, nowhere, point_of
from eyas.render.kernels.scalars import f4
from eyas.render.kernels.visibility.cull import sphere_is_visible

__all__ = ["cast_beam"]

_REACH = 34.0
"""Distance ahead of a vehicle up to which its lamps light the road [m]."""

_BEHIND = 5.0
"""The same for its tail lamps, behind it [m]."""


@inlined_kernel
def _head(ahead: float, aside: float, rise: float) -> float:
    """Return the light at a point ahead of a vehicle's front [m], 0 to 1.

    The pattern of a dipped beam on the road: a fan that starts under the bumper, is brightest
    a car's length ahead, fades with distance and is cut off above the lamps.
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
def _screen_box(caster: NDArray[np.float64], view: View) -> tuple[float, float, float, float]:
    """Return the box around all that a vehicle's lamps may light, see `around`."""
    box = nowhere()
    for corner in range(8):
        ahead = caster[4] + _REACH if corner & 1 else -caster[4] - _BEHIND
        wide = 0.9 + 0.30 * _REACH if corner & 1 else 3.0
        aside = wide if corner & 2 else -wide
        x = caster[0] + ahead * caster[2] - aside * caster[3]
        y = caster[1] + ahead * caster[3] + aside * caster[2]
        box = around(box, view, x, y, caster[6] + (1.3 if corner & 4 else -0.4))
    return box


@inner_kernel
def cast_beam(caster: NDArray[np.float64], view: View, shade: NDArray[np.uint8]) -> None:
    """Brighten the samples that one vehicle's lamps light, channels 2 and 3 of `Scratch.shade`.

    Its own body lies neither ahead of its front nor behind its back.
    """
    half = 0.5 * (_REACH - _BEHIND)
    x, y = caster[0] + half * caster[2], caster[1] + half * caster[3]
    if not sphere_is_visible(view.planes, x, y, caster[6], caster[4] + half + 0.5 * _REACH):
        return
    box = _screen_box(caster, view)
    rows, width = view.depth.shape
    for line in range(max(int(box[1]) - view.top, 0), min(int(box[3]) + 1 - view.top, rows)):
        for column in range(max(int(box[0]), 0), min(int(box[2]) + 1, width)):
            if view.depth[line, column] <= f4(0.0):
                continue
            x, y, z = point_of(view, line, column)
            dx, dy, rise = x - caster[0], y - caster[1], z - caster[6]
            along, aside = dx * caster[2] + dy * caster[3], dy * caster[2] - dx * caster[3]
            head = 255.0 * _head(along - caster[4], aside, rise)
            tail = 255.0 * _tail(-along - caster[4], aside, rise)
            shade[line, column, 2] = min(int(shade[line, column, 2]) + int(head), 255)
            shade[line, column, 3] = min(int(shade[line, column, 3]) + int(tail), 255)
