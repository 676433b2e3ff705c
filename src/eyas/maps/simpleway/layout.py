"""Layout of the simple maps: the asphalt, its loops, and bars of sand blown across the roads."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.roads.areas import corridors, polygons_of, streets
from eyas.engine.world.roads.curves import rounded_kerbs
from eyas.lanes import exact
from eyas.maps.roads.painting import Stripe
from eyas.maps.simpleway.roads import is_loop

FLOOR = (7000.0, 5000.0)  # Extent of the floor, as in the original [m]
_ROWS = 7  # Bars on each road
_REACH = 1110.0  # Distance from the middle of a road to its first and last bar [m]
_LENGTH = (10.0, 25.0)  # Extent of a bar along the road [m]
_HALF = 50.0  # Half its extent across [m]
_TUFTS = 9  # Small drifts before and behind each bar


def paved(network: RoadNetwork) -> shapely.Geometry:
    """Return the asphalt [m]."""
    return rounded_kerbs(corridors(network), [])


def loop_lines(network: RoadNetwork) -> list[Stripe]:
    """Return lines along the inner edges of loops: `road_paint` draws them on one half only."""
    return [
        Stripe(middle=street.left, width=0.2)
        for edge, street in zip(network.edges, streets(network), strict=True)
        if is_loop(edge)
    ]


def sand_bars(
    lines: NDArray[np.float64],  # Ends of the roads, shape (R, 2, 2) [m]
    roads: shapely.Geometry,  # Asphalt [m]
    rng: np.random.Generator,
) -> list[shapely.Polygon]:
    """Return the sand on the asphalt [m]."""
    shapes: list[shapely.Geometry] = []
    for south, north in lines:
        for y in np.linspace(-_REACH, _REACH, _ROWS) + rng.uniform(-70.0, 70.0, _ROWS):
            share = (y - south[1]) / (north[1] - south[1])
            middle = south + share * (north - south)
            half = rng.uniform(*_LENGTH) / 2
            shapes.append(_bar(middle, half, rng))
            shapes += _tufts(middle, half, rng)
    return polygons_of(shapely.intersection(shapely.union_all(shapes), roads))


def _bar(middle: NDArray[np.float64], half: float, rng: np.random.Generator) -> shapely.Polygon:
    """Return a bar with wavy edges."""
    x = np.arange(-_HALF, _HALF + 0.1, 1.0)
    edges = []
    for side in (-1.0, 1.0):
        wave = np.zeros_like(x)
        for length, height in ((31.0, 0.9), (9.0, 0.55), (3.7, 0.3)):
            wave += height * exact.sin(2 * np.pi * x / length + rng.uniform(0, 2 * np.pi))
        edges.append(np.stack([x, side * (half + wave)], axis=1)[:: int(-side)])
    return shapely.make_valid(shapely.Polygon(rounded(middle + np.concatenate(edges))))


def _tufts(
    middle: NDArray[np.float64], half: float, rng: np.random.Generator
) -> list[shapely.Polygon]:
    """Return small drifts, longer across the road than along it."""
    angle = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
    made = []
    for _ in range(_TUFTS):
        side = rng.choice([-1.0, 1.0])
        aside, ahead = rng.uniform(-7.0, 7.0), side * (half + rng.uniform(0.6, 3.2))
        at = middle + np.array([aside, ahead])
        size = rng.uniform([0.5, 0.15], [2.2, 0.45])
        ring = np.stack([exact.cos(angle), exact.sin(angle)], axis=1) * size
        made.append(shapely.Polygon(rounded(at + ring * rng.uniform(0.75, 1.1, (12, 1)))))
    return made
