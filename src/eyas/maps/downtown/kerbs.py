"""What stands along the kerbs: cars in bays, rows of trees, and a lamp at each crossing."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import rounded, snapped, unit
from eyas.engine.world.roads.areas import Street, joints, streets
from eyas.lanes import exact
from eyas.maps.downtown.roads import Grid

__all__ = ["Kerbs", "crossing_lamps", "make_kerbs"]

_BAY_DEPTH, _BAY_LENGTH = 2.3, 6.1  # Size of a bay along a kerb [m]
_FROM_CROSSING = 17.0  # From the end of a street to the nearest bay [m]
_BAYS = (4, 9)  # Bays in a row; between two rows the pavement reaches out to the kerb
_BETWEEN = 11.0
_OCCUPIED = 0.82
_GREAT_SPACING, _GREAT_BEYOND = 21.0, 2.6
"""Distances along the park of its great trees, and from the kerb to their trunks [m]."""
_GREAT = 32
_SLIM_SPACING, _SLIM_BEYOND = 10.6, 1.5  # The same for the slim trees of the street that they line
_SLIM = 59
_SLIM_STREET = 5  # The street with slim trees on both sides, counted from the south
_PARK_STREET = 7
_PAST_LINE = 2.2  # From a stop line to the lamp at the crossing for walkers beyond it [m]

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Kerbs:
    """What stands along the kerbs, world frame."""

    bays: shapely.Geometry  # Asphalt of the parking bays [m]
    lines: list[shapely.Polygon]  # Paint between them [m]
    cars: Points  # Middle of each parked car [m] and its heading [rad], shape (K, 3)
    great_trees: Points  # Trunks of the great trees along the park [m], shape (K, 2)
    slim_trees: Points  # Trunks of the slim trees [m], shape (K, 2)


def make_kerbs(
    network: RoadNetwork, grid: Grid, railway: shapely.Geometry, rng: np.random.Generator
) -> Kerbs:
    """Return what stands along the kerbs.

    Args:
        network: The roads.
        grid: Their grid.
        railway: The ground of the elevated railway, where no tree stands [m].
        rng: Random numbers of the kerbs.
    """
    every = streets(network)
    slim = [s for s in every if _is_along(s, _SLIM_STREET)]
    # Traffic keeps right, so the kerb of the westbound side is the park's.
    great = [s for s in every if _is_along(s, _PARK_STREET) and s.start > s.end and s.end < "E"]
    bays: list[shapely.Geometry] = []
    lines: list[shapely.Polygon] = []
    cars: list[list[float]] = []
    for street in every:
        if not street.dividers and street not in slim and street.start[1:] == street.end[1:]:
            for row in _rows(street, rng):
                bays.append(_beside(row, 0.0, _BAY_DEPTH, 0.0, row.length))
                count = round(row.length / _BAY_LENGTH)
                for k in range(count + 1):
                    at = float(np.clip(k * _BAY_LENGTH, 0.05, row.length - 0.05))
                    lines.append(_beside(row, 0.0, _BAY_DEPTH - 0.1, at - 0.05, at + 0.05))
                cars += _parked(row, count, rng)
    slim_trees = _row_of_trees(slim, _SLIM_SPACING, _SLIM_BEYOND, 13.0)
    return Kerbs(
        bays=snapped(shapely.union_all(bays)),
        lines=lines,
        cars=np.array(cars).reshape(-1, 3),
        great_trees=_row_of_trees(great, _GREAT_SPACING, _GREAT_BEYOND, 4.0)[:_GREAT],
        slim_trees=slim_trees[shapely.distance(railway, shapely.points(slim_trees)) > 1.0][:_SLIM],
    )


def crossing_lamps(network: RoadNetwork, beyond: float) -> list[tuple[Points, float]]:
    """Return the foot of a lamp at each crossing, and the direction of its arm [rad].

    The lamp stands beside the crossing for walkers that lies on the widest road into it.

    Args:
        network: The roads.
        beyond: From the kerb to the pole [m].
    """
    meeting = joints(network)
    ways: dict[str, list[Street]] = {}
    for street in streets(network):
        if meeting[street.end] >= 3:
            ways.setdefault(street.end, []).append(street)
    made = []
    for node in sorted(ways):
        street = max(ways[node], key=lambda s: (len(s.dividers), s.start))
        onwards = unit(street.right[-1] - street.right[-2])
        leftwards = np.array([-onwards[1], onwards[0]])
        foot = street.right[-1] - beyond * leftwards + _PAST_LINE * onwards
        made.append((rounded(foot), float(exact.atan2(leftwards[1], leftwards[0]))))
    return made


def _is_along(street: Street, index: int) -> bool:
    return street.start[1:] == street.end[1:] == str(index + 1)


def _rows(street: Street, rng: np.random.Generator) -> list[shapely.LineString]:
    """Return the kerb along each row of bays."""
    kerb = shapely.LineString(street.right)
    made: list[shapely.LineString] = []
    at = _FROM_CROSSING + float(rng.uniform(0.0, 6.0))
    while True:
        length = _BAY_LENGTH * int(rng.integers(*_BAYS))
        if at + length > kerb.length - _FROM_CROSSING:
            return made
        if rng.random() < 0.86:
            made.append(substring(kerb, at, at + length))
        at += length + _BETWEEN


def _parked(row: shapely.LineString, count: int, rng: np.random.Generator) -> list[list[float]]:
    """Return the cars in a row of bays, some a little askew."""
    start, end = shapely.get_coordinates(row)[[0, -1]]
    along = unit(end - start)
    across = np.array([along[1], -along[0]])
    heading = float(exact.atan2(along[1], along[0]))
    cars = []
    for k in range(count):
        here = rng.random() < _OCCUPIED
        shift = (k + 0.5) * _BAY_LENGTH + rng.uniform(-0.35, 0.35)
        place = start + shift * along + (1.18 + rng.uniform(-0.1, 0.1)) * across
        turn = heading + rng.uniform(-0.055, 0.055)
        if here:
            cars.append([*rounded(place), float(turn)])
    return cars


def _beside(
    line: shapely.LineString, near: float, far: float, low: float, high: float
) -> shapely.Polygon:
    """Return a rectangle on the right of a straight kerb [m]."""
    start, end = shapely.get_coordinates(line)[[0, -1]]
    along = unit(end - start)
    across = np.array([along[1], -along[0]])
    corners = [(low, near), (low, far), (high, far), (high, near)]
    return shapely.Polygon([rounded(start + x * along + y * across) for x, y in corners])


def _row_of_trees(rows: list[Street], spacing: float, beyond: float, clear: float) -> Points:
    """Return trunks along kerbs, evenly spaced between crossings."""
    trunks = [np.zeros((0, 2))]
    for street in rows:
        kerb = shapely.LineString(street.right)
        count = max(int((kerb.length - 2 * clear) // spacing), 0) + 1
        first = (kerb.length - (count - 1) * spacing) / 2
        for k in range(count):
            piece = substring(kerb, first + k * spacing, first + k * spacing + 0.5)
            start, end = shapely.get_coordinates(piece)[[0, -1]]
            along = unit(end - start)
            trunks.append(rounded(start + beyond * np.array([along[1], -along[0]]))[None])
    return np.concatenate(trunks)
