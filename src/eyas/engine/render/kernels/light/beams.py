"""Light of vehicles' head and tail lamps on the road."""

from eyas.engine.render.kernels.bundles import Band, View
from eyas.engine.render.kernels.light.caster import Caster, camera_of
from eyas.engine.render.kernels.samples import (
    ScreenBox,
    around,
    empty_box,
    own_row,
    point_of,
    ray_of_row,
)
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.engine.render.kernels.visibility.cull import sphere_is_visible
from eyas.engine.render.kernels.visibility.key import distance_inverse
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    greater,
    lane_numbers,
    lesser,
    load,
    load_words,
    magnitude,
    select,
    store_words,
    to_u4,
)

_REACH = 34.0  # Distance ahead of a vehicle up to which its lamps light the road [m]

_BEHIND = 5.0  # The same for its tail lamps, behind it [m]

_BRAKING = 2.0  # How much more brake lamps light there; near the vehicle, no more than can be told

_CUT_OFF = 1.2  # Height above the bottom of a vehicle up to which its lamps light things [m]

_DEPTH = 2.0  # Depth below the bottom of a vehicle down to which its lamps light things [m]

_SPREAD = 0.9 + 0.30 * _REACH

BEAM_REACH = _REACH + _SPREAD
"""Distance from the end of a vehicle up to which its lamps may light things, at most [m]."""


@kernel(inline=True)
def _head(ahead: float, aside: float, rise: float) -> float:
    """Return the light at points ahead of a vehicle's front [m], 0 to 1.

    The pattern of a dipped beam on the road: a fan that starts under the bumper, is brightest
    a car's length ahead, fades with distance and is cut off above the lamps.
    """
    one, zero = f4(1.0), f4(0.0)
    lit = (ahead > zero) & (ahead < f4(_REACH)) & (rise <= f4(_CUT_OFF))
    across = aside / (f4(0.9) + f4(0.30) * ahead)
    fan = greater(one - across * across, zero)
    near = lesser(ahead * f4(0.4), one)
    far = one - ahead * f4(1.0 / _REACH)
    low = lesser((f4(_CUT_OFF) - rise) * f4(2.0), one)
    return select(lit, fan * fan * near * near * far * far * low, zero)


@kernel(inline=True)
def _tail(behind: float, aside: float, rise: float) -> float:
    """Return the red light at points behind a vehicle's back [m], 0 to 1."""
    one, zero = f4(1.0), f4(0.0)
    lit = (behind > zero) & (behind < f4(_BEHIND)) & (rise <= f4(_CUT_OFF))
    across = aside / (one + f4(0.35) * behind)
    far = one - behind * f4(1.0 / _BEHIND)
    return select(lit, greater(one - across * across, zero) * far * far, zero)


@kernel
def _screen_box(caster: Caster, view: View) -> ScreenBox:
    """Return the box around all that a vehicle's lamps may light, see `around`."""
    box = empty_box()
    for corner in range(8):
        ahead = caster.length + _REACH if corner & 1 else -caster.length - _BEHIND
        wide = _SPREAD if corner & 1 else 3.0
        aside = wide if corner & 2 else -wide
        x = caster.x + ahead * caster.along_x - aside * caster.along_y
        y = caster.y + ahead * caster.along_y + aside * caster.along_x
        box = around(box, view, x, y, caster.bottom + (_CUT_OFF if corner & 4 else -_DEPTH))
    return box


@kernel
def cast_beam(
    caster: Caster,  # The vehicle
    band: Band,
    brakes: bool,  # Whether its brake lamps are lit
) -> None:
    """Brighten the samples that one vehicle's lamps light, channels 2 and 3 of `Band.shade`.

    Its own body lies neither ahead of its front nor behind its back.
    """
    steps = f4(255.0 * _BRAKING) if brakes else f4(255.0)
    view, key, shade = band.camera, band.key, band.shade
    half = 0.5 * (_REACH - _BEHIND)
    x, y = caster.x + half * caster.along_x, caster.y + half * caster.along_y
    radius = caster.length + 0.5 * (_REACH + _BEHIND) + _SPREAD
    if not sphere_is_visible(view.planes, x, y, caster.bottom, radius):
        return
    box = _screen_box(caster, view)
    camera = camera_of(caster, view)
    stride, length = key.shape[1], f4(caster.length)
    begin, end = max(int(box.left), 0), min(int(box.right) + 1, view.width)
    bottom = min(int(box.bottom) + 1 - view.top, view.rows)
    for line in range(own_row(band, max(int(box.top) - view.top, 0)), bottom, band.members):
        ray = ray_of_row(camera, view, line)
        for start in range(begin, end, WIDTH):
            first = min(start, stride - WIDTH)
            at = line * stride + first
            columns = lane_numbers() + i4(first)
            inverse = distance_inverse(load(key, at))
            # Samples before `start` had their light from the lanes before.
            seen = (inverse > f4(0.0)) & (columns >= i4(start)) & (columns < i4(end))
            x, y, z = point_of(camera, view, ray, columns, select(seen, inverse, f4(1.0)))
            seen &= (
                (z <= f4(_CUT_OFF))
                & (z > f4(-_DEPTH))
                & (x < length + f4(_REACH))
                & (x > -length - f4(_BEHIND))
            )
            away = magnitude(x) - length  # ahead or behind; wider than both lights are there
            seen &= (away > f4(0.0)) & (magnitude(y) < f4(0.35) * away + f4(1.01))
            if not any_of(seen):
                continue
            head, tail = _head(x - length, y, z), _tail(-x - length, y, z)
            words = load_words(shade, 4 * at)
            white = ((words >> u4(16)) & u4(255)) + to_u4(head * f4(255.0))
            red = (words >> u4(24)) + to_u4(tail * steps)
            lit = (lesser(white, u4(255)) << u4(16)) | (lesser(red, u4(255)) << u4(24))
            store_words(shade, 4 * at, select(seen, (words & u4(0xFFFF)) | lit, words))
