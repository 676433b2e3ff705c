"""Arcs where streets turn, for kerbs, lines and the elevated road alike."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import dot, rounded, snapped, unit
from eyas.lanes import exact

TURN = 7.5
"""Smallest radius of a kerb, so that cars turn on asphalt; also the reach of slight bends [m]."""

Points = NDArray[np.float64]


def arc(
    before: Points,  # Any point on the straight piece before the corner
    corner: Points,  # Point where the straight pieces would meet
    after: Points,  # Any point on the straight piece after the corner
    radius: float,  # Radius of the arc [m]
) -> Points:
    """Return an arc that touches both sides of a corner, in steps of 5° or less, shape (K, 2) [m].

    Its points are at whole millimetres.
    """
    back, onwards = unit(before - corner), unit(after - corner)
    half = 0.5 * exact.acos(np.clip(dot(back, onwards), -1.0, 1.0))
    reach = radius / exact.tan(half)
    centre = corner + unit(back + onwards) * radius / exact.sin(half)
    first, last = corner + reach * back - centre, corner + reach * onwards - centre
    turn = exact.atan2(first[0] * last[1] - first[1] * last[0], dot(first, last))
    steps = max(3, int(np.ceil(abs(turn) / np.radians(5.0))))
    angle = np.linspace(0.0, turn, steps + 1)[:, None]
    return rounded(centre + exact.cos(angle) * first + exact.sin(angle) * [-first[1], first[0]])


def turn_reach(angle: float) -> float:
    """Return how far before a bend by an angle [rad] the arc of the inner kerb begins [m]."""
    return TURN * max(1.0, float(exact.tan(angle / 2)))


def joined(before: Points, after: Points) -> Points:
    """Return two lines that meet in a bend as one line with an arc between them.

    Args:
        before: Line up to the bend, shape (K, 2) [m].
        after: Line after the bend, shape (K, 2) [m].
    """
    onwards, further = unit(before[-1] - before[-2]), unit(after[1] - after[0])
    sine = _cross(onwards, further)
    if abs(sine) < 1e-3:
        return np.concatenate([before, after])
    gap = after[0] - before[-1]
    # From the ends of both lines to the point where they would meet; negative if they cross.
    left, right = _cross(gap, further) / sine, _cross(onwards, gap) / sine
    corner = before[-1] + left * onwards
    angle = float(exact.atan2(abs(sine), dot(onwards, further)))
    reach = max(left, right, turn_reach(angle))
    bend = arc(corner - onwards, corner, corner + further, reach / exact.tan(angle / 2))
    return np.concatenate([before[:-1], bend, after[1:]])


def rounded_kerbs(area: shapely.Geometry, bends: list[tuple[Points, float]]) -> shapely.Geometry:
    """Return asphalt whose inner corners are arcs; outer corners stay as they are.

    Args:
        area: Asphalt with sharp corners [m].
        bends: Middle [m] and angle [rad] of each bend, where two roads meet.
    """
    parts = [area, _closed(area, TURN)]
    for place, angle in bends:
        radius = round(float(turn_reach(angle) / max(exact.tan(angle / 2), 1e-3)), 3)
        if radius > TURN:
            near = shapely.intersection(area, _disc(place, 45.0))
            parts.append(shapely.intersection(_closed(near, radius), _disc(place, 30.0)))
    return shapely.union_all(parts)


def _closed(area: shapely.Geometry, radius: float) -> shapely.Geometry:
    # Eight chords in a right angle deviate 4 cm from the arc; a larger radius needs more.
    steps = int(max(8, radius))
    grown = shapely.buffer(area, radius, quad_segs=steps)
    return snapped(shapely.buffer(grown, -radius, quad_segs=steps))


def _disc(place: Points, radius: float) -> shapely.Polygon:
    return shapely.buffer(shapely.Point(place), radius)


def _cross(a: Points, b: Points) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
