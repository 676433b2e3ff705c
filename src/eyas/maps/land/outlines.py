"""Natural outlines: shores, drifts and patches."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact

Points = NDArray[np.float64]


def blob(
    middle: Points,  # Its middle [m], shape (2,)
    half: tuple[float, float],  # Half its length and width [m]
    turn: float,  # Direction of its length, counter-clockwise from east [rad]
    rng: np.random.Generator,
    corners: int = 40,
    full: float = 0.75,  # 1: an ellipse; less: nearer to a rectangle, with full ends
) -> shapely.Polygon:
    """Return an uneven ellipse."""
    angle = np.linspace(0.0, 2 * np.pi, corners, endpoint=False)
    phase, size = rng.uniform(0, 2 * np.pi, (3, 1)), rng.uniform(0.04, 0.11, (3, 1))
    waves = 1.0 + (size * exact.sin(angle * [[2], [3], [5]] + phase)).sum(axis=0)
    around = np.stack([exact.cos(angle), exact.sin(angle)])
    around = np.sign(around) * exact.power(np.abs(around), full)
    x, y = np.asarray(half)[:, None] * waves * around
    cosine, sine = exact.cos(turn), exact.sin(turn)
    return shapely.Polygon(
        rounded(middle + np.stack([x * cosine - y * sine, x * sine + y * cosine], axis=1))
    )


def wavy(
    shape: shapely.Polygon,  # The shape, with a smooth outline [m]
    depth: float,  # Largest distance from the old outline [m]
    rng: np.random.Generator,
    step: float = 5.0,  # Distance between the corners of the new one [m]
) -> shapely.Polygon:
    """Return a shape whose outline wanders to both sides."""
    ring = shapely.get_coordinates(shapely.segmentize(shapely.get_exterior_ring(shape), step))[:-1]
    along = np.linspace(0.0, 2 * np.pi, len(ring), endpoint=False)
    phase, size = rng.uniform(0, 2 * np.pi, (6, 1)), rng.uniform(0.08, 0.25, (6, 1))
    rate = np.array([[3], [5], [8], [11], [17], [23]])
    offset = depth * (size * exact.sin(rate * along + phase)).sum(axis=0)
    ahead = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    away = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1)
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    outline = shapely.Polygon(rounded(ring + offset[:, None] * away))
    valid = shapely.get_parts(shapely.make_valid(outline))
    return max(valid, key=shapely.area)
