"""Where the camera looks: at a point, and for stated shares of the time past it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.flights.signals import STEP, averaged, steps_in
from eyas.lanes import exact

Floats = NDArray[np.float64]

_LOWEST, STEEPEST = 0.0, 1.45
"""Pitches of the camera, positive down, within what the gimbal holds [rad]."""

_SHALLOW = 0.6
"""Down to this pitch a camera that looks past something turns, else it looks higher [rad]."""


class Glances(NamedTuple):
    """When the camera looks past the target; M samples each."""

    cut: Floats  # 1 while the target is to be at the border of the picture, else 0, shape (M,)
    away: Floats  # 1 while it is to be outside, else 0, shape (M,)

    def after(self, count: int) -> "Glances":
        """Return the same after some samples, in which all is as it is at first."""
        return Glances(*(np.pad(part, (count, 0), mode="edge") for part in self))


class Aside(NamedTuple):
    """How the camera looks past the target in one flight."""

    side: float  # 1: to its left, so that it is on the right of the picture; -1: to its right
    margin: float  # How far outside the picture it is while the camera looks away, in half pictures
    searches: bool  # Whether the camera looks around meanwhile
    sweep: float  # How far it then turns [rad]


def glances(
    count: int,  # M
    cut: float,  # Share of the time in which the target is at the border
    away: float,  # Share of the time in which it is outside
    rng: np.random.Generator,  # Samples how often and when
    *,
    away_first: bool,  # Whether it is outside at the beginning, if ever
) -> Glances:
    """Return at random when the camera looks past the target."""
    parts: list[tuple[int, int]] = []
    for kind, share in ((0, cut), (1, away)):
        total = round(min(max(share, 0.0), 1.0) * count)
        if total == 0:
            continue
        number = max(round(total * STEP / float(rng.uniform(1.5, 3.0))), 1)
        parts += [(kind, total // number)] * number
    order = rng.permutation(len(parts)).tolist()
    if away_first and away > 0.0:
        order.sort(key=lambda part: part != len(parts) - 1)
    gaps = rng.uniform(0.4, 1.0, len(parts) + 1)
    if away_first:
        gaps[0] = 0.0
    free = max(count - sum(length for _, length in parts), 0)
    ends = np.floor(np.cumsum(gaps) / gaps.sum() * free).astype(int).tolist() if parts else []
    table, taken = np.zeros((2, count)), 0
    for number, part in enumerate(order):
        kind, length = parts[part]
        begin = ends[number] + taken
        table[kind, begin : begin + length] = 1.0
        taken += length
    return Glances(table[0], table[1])


def aimed(place: Floats, look: Floats) -> tuple[Floats, Floats]:
    """Return yaw and pitch, positive down, at which points are in the middle [rad], (M,) each."""
    way = look - place
    flat = exact.hypot(way[:, 0], way[:, 1])
    yaw = exact.atan2(way[:, 1], way[:, 0])
    turns = np.diff(yaw, prepend=yaw[:1])
    full = np.cumsum(np.where(turns > math.pi, -1.0, np.where(turns < -math.pi, 1.0, 0.0)))
    return yaw + 2.0 * math.pi * full, exact.atan2(-way[:, 2], flat)


def turned_aside(
    # Yaw and pitch at which that is in the middle [rad], shape (M,) each
    view: tuple[Floats, Floats],
    field: Floats,  # Horizontal field of view [rad], shape (M,)
    aspect: float,  # Height of the picture over its width
    when: Glances,  # When it looks past it
    how: Aside,
) -> tuple[Floats, Floats]:
    """Return yaw and pitch with which the camera looks past what is in its middle."""
    yaw, pitch = view
    cut, away = averaged(when.cut, 0.4), averaged(when.away, 0.45)
    # 1 brings it to the border; while searching, the sweep alone takes it out of the picture.
    halves = cut if how.searches else np.maximum(cut, (1.0 + how.margin) * away)
    shallow = averaged((pitch < _SHALLOW).astype(np.float64), 0.6)
    half_width = exact.tan(0.5 * field)
    tangent = half_width * halves
    along, across = exact.cos(pitch), exact.sin(pitch)
    # The target at this pitch, the camera turned by an angle d: its column is
    # along sin(d) / (along^2 cos(d) + across^2), which is to be the tangent.
    ahead = tangent * along * along
    length = np.sqrt(along * along + ahead * ahead)
    sine = np.minimum(tangent * across * across / length, 1.0)
    turn = exact.atan2(ahead, along) + exact.asin(sine)
    upright = 2.0 * exact.atan(half_width * aspect)
    higher = exact.atan(exact.tan(0.5 * upright) * halves)
    new_yaw = yaw + how.side * shallow * turn
    new_pitch = pitch - (1.0 - shallow) * higher
    if how.searches:
        swing = 1.0 + 0.35 * exact.sin(2.0 * math.pi / 3.1 * STEP * np.arange(len(yaw)))
        new_yaw = new_yaw + how.side * how.sweep * swing * away
        new_pitch = new_pitch + (np.minimum(pitch, 0.55) - pitch) * away
    return new_yaw, np.clip(new_pitch, _LOWEST, STEEPEST)


def held(when: Glances) -> Floats:
    """Return how much of its lag a pilot gives up, to hold the target where it is, shape (M,)."""
    return averaged(np.minimum(when.cut + when.away, 1.0), steps_in(0.6) * STEP)
