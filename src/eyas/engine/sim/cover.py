"""Where lanes are out of sight of a drone above them: under decks, in tunnels, beneath crowns."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sensors.obstacles import Solids
from eyas.engine.sim.scenes import load_network, load_scene, load_solids
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.terrain import Terrain, reliefs
from eyas.engine.task.clearance import Clearance
from eyas.engine.traffic.cover import Cover, Stretch
from eyas.engine.world.weather import Season
from eyas.lanes import exact

_HEIGHT = 22.0  # Height of the drone above the road, as in the protocols [m]

_ASIDE = (4.5, 10.0)
"""How far beside the car it is [m]: so that its camera, which looks down by 1.37 rad, centres the
car, and so that the car is at the edge of the picture. A drone may be on any side, so a place is
hidden only if all four sides see none of it: else, who flies on sees the car under a crown."""

_STEP = 1.0  # Between two places on a lane that are looked at [m]

_POINTS = (-0.8, 0.0, 0.8)  # Points of a car's width that are looked at, to the left [m]

_ROOF = 1.3  # Their height: the roof is what is seen longest [m]

Floats = NDArray[np.float64]


def cover_of(map_name: str, seed: int) -> Cover:
    """Return the stretches of a map's lanes that are hidden from above; a second of computing."""
    network, scene = load_network(map_name, seed), load_scene(map_name, seed)
    return hidden_stretches(network, load_solids(map_name, seed, Season.SUMMER), scene.terrain)


def hidden_stretches(network: RoadNetwork, solids: Solids, terrain: Terrain) -> Cover:
    """Return the hidden stretches of lanes below solids that stand on a terrain."""
    nobody = SampledMotion(np.zeros((2, 0), SAMPLE), np.zeros(0, np.int32), 10.0).packed()
    clearance = Clearance(solids, terrain, nobody)
    return tuple(
        stretch
        for lane in range(len(network.lane_width))
        for stretch in _stretches_of(network, lane, clearance, terrain)
    )


def _stretches_of(
    network: RoadNetwork, lane: int, clearance: Clearance, terrain: Terrain
) -> Iterator[Stretch]:
    points = network.lane_points[slice(*network.lane_first[lane : lane + 2])]
    along = np.concatenate([[0.0], np.cumsum(exact.hypot(*np.diff(points, axis=0).T))])
    places = np.arange(0.0, along[-1], _STEP)
    hidden = _hidden(points, along, places, clearance, terrain)
    change = np.flatnonzero(np.diff(np.concatenate([[False], hidden, [False]]).astype(np.int8)))
    name = f"{network.edges[network.lane_edge[lane]]}_{network.lane_index[lane]}"
    for first, last in change.reshape(-1, 2).tolist():
        yield Stretch(name, float(places[first]), float(places[last - 1]))


def _hidden(
    points: Floats, along: Floats, places: Floats, clearance: Clearance, terrain: Terrain
) -> NDArray[np.bool_]:
    """Return whether nothing of a car at each place (M,) of a lane is seen from any side."""

    def at(place: Floats) -> Floats:
        return np.stack([np.interp(place, along, points[:, axis]) for axis in (0, 1)], axis=-1)

    middle, ahead = at(places), at(places + 0.5 * _STEP) - at(places - 0.5 * _STEP)
    ahead /= np.asarray(exact.hypot(*ahead.T))[:, None]
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)
    ground = terrain.floor + reliefs(terrain, middle)

    def raised(place: Floats, height: float) -> Floats:
        return np.concatenate([place, (ground + height)[:, None]], axis=1)

    roof = np.stack([raised(middle + aside * left, _ROOF) for aside in _POINTS], axis=1)
    seen = [
        clearance.in_sight(raised(middle + aside * side, _HEIGHT), roof)
        for aside in _ASIDE
        for side in (ahead, -ahead, left, -left)
    ]
    return np.asarray(~np.any(seen, axis=(0, 2)))
