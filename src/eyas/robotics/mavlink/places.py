"""Places of vehicles before they take off: on free ground beside the road."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import SpawnError
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.terrain import reliefs
from eyas.engine.task.clearance import Margin
from eyas.lanes import exact
from eyas.robotics.mavlink.pilot import FEET

_FREE = 2.0  # Radius without things [m]
_ROAD = 5.0  # Distance from the middle of the nearest lane [m]
_APART = 4.0  # Least distance between two vehicles [m]
_REACH = 120.0  # Largest distance of a place from the first target [m]
_RING = 4.0  # Between rings of places, and between the places of one [m]


def standing_places(simulation: Simulation) -> NDArray[np.float64]:
    """Return a place for each tracker: east, north, up [m], heading [rad], shape (N, 4).

    They are those nearest to the first tracker's target that are free, and away from all lanes.

    Raises:
        SpawnError: There are too few.
    """
    near = simulation.snapshot.targets.position[0, :2]
    places = _candidates(near)
    places = places[_far_from_lanes(simulation, places)]
    ground = simulation.scene.terrain.floor + reliefs(simulation.scene.terrain, places)
    free = simulation.clearance.lifted(np.column_stack([places, ground]), Margin(_FREE, 3.0, 0.0))
    good = np.flatnonzero(free < ground + 0.3)  # the ground itself may slope
    chosen: list[int] = []
    for at in good.tolist():
        away = places[chosen] - places[at]
        if (away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1] >= _APART * _APART).all():
            chosen.append(at)
        if len(chosen) == simulation.count:
            break
    if len(chosen) < simulation.count:
        raise SpawnError(
            f"mavlink.vehicles: only {len(chosen)} of {simulation.count} find free ground within "
            f"{_REACH:g} m; allowed there: up to {len(chosen)}"
        )
    height = ground[chosen] + FEET
    return np.column_stack([places[chosen], height, np.zeros(len(chosen))])


def _candidates(middle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return places around one, the nearest first [m], shape (K, 2)."""
    found = []
    for ring in range(1, int(_REACH / _RING) + 1):
        radius = ring * _RING
        turns = np.linspace(0.0, 2.0 * math.pi, 6 * ring, endpoint=False)
        circle = np.stack([exact.cos(turns), exact.sin(turns)], axis=1)
        found.append(middle + radius * circle)
    return np.concatenate(found)


def _far_from_lanes(simulation: Simulation, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which places are far enough from all lanes, shape (K,)."""
    network = simulation.scene.network
    points, first = network.lane_points, network.lane_first
    begin, way = points[:-1], np.diff(points, axis=0)
    way[first[1:-1] - 1] = 0.0  # from one lane to the next there is no road
    square = np.maximum((way * way).sum(axis=1), 1e-12)
    far = np.ones(len(places), np.bool_)
    for at, place in enumerate(places):
        off = place - begin
        share = np.clip((off * way).sum(axis=1) / square, 0.0, 1.0)
        off = off - share[:, None] * way
        far[at] = (off * off).sum(axis=1).min() > _ROAD * _ROAD
    return far
