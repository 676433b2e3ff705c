"""Hills and dunes of uneven outline: their shapes, and their places beside roads."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact
from eyas.maps.build.values import Positive

_TRIES = 400
"""Number of places tried for each mound inside."""
_APART = 0.52
"""Least distance of two summits as a share of the larger radius: closer ones would be one hill."""

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Mound:
    """A hill: gentle at its foot and its summit, with an uneven outline."""

    x: float
    """East [m]."""
    y: float
    """North [m]."""
    radius: Positive
    """Largest radius of its foot [m]."""
    height: float
    """Height of the summit above the floor [m]."""
    phases: tuple[float, ...] = ()
    """Phases of the waves of its outline [rad]; none: it is round."""
    waviness: float = 0.0
    """Depth of these waves, as a share of the radius."""
    lean: tuple[float, float] = (0.0, 0.0)
    """From the middle of the foot to the summit, as a share of the radius: the side that it leans
    to is steep."""

    def heights(self, points: Points) -> Points:
        """Return its height above the floor at points, 0 beyond its foot [m].

        Args:
            points: East and north [m], shape (P, 2).
        """
        away = (points - (self.x, self.y)) / self.radius
        if self.phases:
            angle = exact.atan2(away[:, 1], away[:, 0])
            wave = sum(
                exact.sin((k + 2) * angle + phase) / (k + 1) for k, phase in enumerate(self.phases)
            )
            away = away / (1.0 - self.waviness * (0.5 + 0.5 * np.asarray(wave) / 1.9))[:, None]
        # The share of the way from the summit to the edge of the unit circle.
        lean = np.asarray(self.lean)
        way = away - lean
        square = np.square(way).sum(axis=1)
        onto, inside = exact.product(way, lean), 1.0 - float(exact.product(lean, lean))
        share = square / np.maximum(-onto + np.sqrt(np.square(onto) + square * inside), 1e-12)
        bell = 0.5 + 0.5 * exact.cos(np.pi * np.clip(share, 0.0, 1.0))
        # Whole millimetres: the last bits of a cosine differ between machines.
        return rounded(self.height * bell)


def highest(
    mounds: Sequence[Mound],  # The mounds; where some overlap, the highest counts
    points: Points,  # East and north [m], shape (P, 2)
) -> tuple[Points, NDArray[np.intp]]:
    """Return the height of the ground above the floor [m], and the mound under it; -1: none."""
    best, owner = np.zeros(len(points)), np.full(len(points), -1, np.intp)
    for index, mound in enumerate(mounds):
        near = np.flatnonzero(np.abs(points - (mound.x, mound.y)).max(axis=1) < mound.radius)
        height = mound.heights(points[near])
        higher = height > best[near]
        best[near[higher]], owner[near[higher]] = height[higher], index
    return best, owner


def sizes(
    count: int,
    radius: tuple[float, float, float],  # Smallest, median and largest [m]
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Return radii, the largest first, spread between limits about a median [m]."""
    share = (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count
    return rounded(np.interp(share, (0.0, 0.5, 1.0), radius))[::-1]


def place_inside(
    radii: Sequence[float],  # Radii, the largest first [m]
    steepness: tuple[float, float],  # Least and largest height, as a share of the radius
    room: shapely.Geometry,  # Area that the mounds must keep to [m]
    rng: np.random.Generator,
) -> list[Mound]:
    """Return round mounds in the ground between roads, each as close to the edge as it can be.

    Where there is no room for one, a smaller one takes its place.
    """
    edge = shapely.boundary(room)
    shapely.prepare(room)
    west, south, east, north = room.bounds
    made: list[Mound] = []
    for radius in radii:
        spots = rounded(rng.uniform((west, south), (east, north), (_TRIES, 2)))
        spots = spots[shapely.contains_xy(room, spots)]
        space = np.round(shapely.distance(edge, shapely.points(spots)), 3)
        fit = np.minimum(space, radius)
        for other in made:
            apart = exact.hypot(*(spots - (other.x, other.y)).T)
            fit[apart < _APART * np.maximum(fit, other.radius)] = 0.0
        # Of the places with room for all of it the tightest, otherwise the roomiest.
        best = int(np.argmax(fit - 1e-3 * np.round(space - fit)))
        share = rng.uniform(*steepness)
        if fit[best] > 0.5 * radius:
            x, y = spots[best].tolist()
            made.append(Mound(x, y, float(fit[best]), round(float(share * fit[best]), 3)))
    return made


def place_ring(
    radii: Sequence[float],  # Radii [m]
    gaps: tuple[float, float],  # Least and largest distance of a foot from the area [m]
    steepness: tuple[float, float],  # Least and largest height, as a share of the radius
    inside: shapely.Polygon,  # The area [m]
    rng: np.random.Generator,
) -> list[Mound]:
    """Return round mounds in a closed ring around an area."""
    ring = shapely.get_exterior_ring(shapely.convex_hull(inside))
    middle = shapely.get_coordinates(ring.centroid)[0]
    made = []
    for index, radius in enumerate(rng.permutation(np.asarray(radii))):
        at = (index + rng.uniform(-0.2, 0.2)) / len(radii) % 1.0
        foot = shapely.get_coordinates(ring.interpolate(at, normalized=True))[0]
        # Small shares are more frequent, as in the original.
        gap = gaps[0] + (gaps[1] - gaps[0]) * np.square(rng.uniform())
        away = foot - middle
        x, y = rounded(foot + away / exact.hypot(*away) * (gap + radius)).tolist()
        space = round(float(inside.distance(shapely.Point(x, y))), 3) - gaps[0]
        fit = min(float(radius), space)
        made.append(Mound(x, y, fit, round(float(rng.uniform(*steepness) * fit), 3)))
    return made
