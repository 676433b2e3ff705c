"""Texture coordinates of car bodies: where each point lies between the landmarks of its model."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from art.cars.frame import Frame
from art.cars.regions import (
    BAND,
    BEAMS,
    FRONT,
    REAR,
    REAR_WINDOW,
    SIDE,
    SIDE_PANE,
    SIDE_SHARES,
    TOP,
    TOP_SHARES,
    WINDSCREEN,
)
from art.cars.shape import CarShape, arch_radius

Points = NDArray[np.float64]

_DOOR = 0.5  # Side windows that are shorter are not those of doors [m]


class _Marks(NamedTuple):
    """Landmarks of a model: x [m]."""

    side: Points  # See `SIDE_SHARES`
    top: Points  # See `TOP_SHARES`
    band: Points  # See `BEAMS`


def _marks(frame: Frame, shape: CarShape) -> _Marks:
    tail, nose = shape.top[0][0], shape.top[-1][0]
    ahead, behind = frame.axles[0].x, frame.axles[1].x
    reach = arch_radius(frame.wheel_radius)
    doors = [window for window in shape.windows if window[1] - window[0] > _DOOR]
    pillar = 0.5 * (doors[-1][0] + doors[-2][1]) if len(doors) > 1 else doors[-1][0]
    door = min(doors[-1][1] + 0.05, ahead - reach - 0.04)
    side = [tail, behind - reach, behind + reach, pillar, door]
    side += [ahead - reach, ahead + reach, nose]
    top = [tail, *shape.rear_window, *shape.windscreen, nose]
    band = [shape.windows[0][0], pillar, shape.windows[-1][1]]
    return _Marks(*(np.maximum.accumulate(np.array(row)) for row in (side, top, band)))


class Wrap:
    """Finds texture coordinates of points on the left half of a body or on either side of it."""

    def __init__(self, frame: Frame, shape: CarShape) -> None:
        self._shape = shape
        self._marks = _marks(frame, shape)

    def side(self, points: Points) -> Points:
        """Return those of points below the windows, shape (..., 3)."""
        x = points[..., 0]
        belt = np.interp(x, *np.array(self._shape.belt).T)
        low = self._shape.clearance
        up = (points[..., 2] - low) / np.maximum(belt - low, 0.1)
        return SIDE.at(np.interp(x, self._marks.side, SIDE_SHARES), up)

    def top(self, points: Points, edge: Points) -> Points:
        """Return those of points on boot, roof and bonnet; `edge` is half the width there [m]."""
        across = np.abs(points[..., 1]) / edge
        return TOP.at(np.interp(points[..., 0], self._marks.top, TOP_SHARES), across)

    def band(self, points: Points, up: Points) -> Points:
        """Return those of points at the height of the side windows; `up` is 0 to 1."""
        return BAND.at(np.interp(points[..., 0], self._marks.band, BEAMS), up)

    def end(self, points: Points, half: float, *, front: bool) -> Points:
        """Return those of points at an end; `half` is half its width [m]."""
        belt, low = self._shape.belt[-1 if front else 0][1], self._shape.clearance
        up = (points[..., 2] - low) / (belt - low)
        return (FRONT if front else REAR).at(np.abs(points[..., 1]) / half, up)

    def screen(self, points: Points, edge: Points, *, front: bool) -> Points:
        """Return those of points of the windscreen or of the rear window, see `top`."""
        lower, upper = self._shape.windscreen[::-1] if front else self._shape.rear_window
        up = (points[..., 0] - lower) / ((upper - lower) or 1.0)
        across = 0.5 + 0.5 * points[..., 1] / edge * (1.0 if front else -1.0)
        return (WINDSCREEN if front else REAR_WINDOW).at(across, up)

    def pane(self, points: Points, up: Points) -> Points:
        """Return those of points of a side window, see `band`."""
        x = points[..., 0]
        middle = float(x.mean())
        start, end = next(w for w in self._shape.windows if w[0] < middle < w[1])
        return SIDE_PANE.at((x - start) / (end - start), up)

    def upright(self, points: Points, half: float) -> Points:
        """Return those of points of a window in an upright end: as in `screen`, by height."""
        z, y = points[..., 2], points[..., 1]
        return REAR_WINDOW.at(0.5 - 0.5 * y / half, (z - z.min()) / max(float(np.ptp(z)), 0.1))
