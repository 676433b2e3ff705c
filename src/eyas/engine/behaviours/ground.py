"""A map as those see it who walk on it: what is in their way, and where they walk."""

from collections.abc import Sequence
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.behaviours.chain import chain_through, outline
from eyas.engine.behaviours.crossings import crossings_of
from eyas.engine.behaviours.kerbs import kerb_ways
from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.pavements import LANES, Walkway, pavement_ways
from eyas.engine.behaviours.surface import WalkedSurface
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.variation import Variation, bounds, sample
from eyas.engine.state.motion import Motion
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import Scene
from eyas.engine.targets.catalogue import habit_of
from eyas.engine.targets.config import TargetName
from eyas.engine.traffic.signals import SignalPlan
from eyas.engine.world.roads.areas import Street, streets
from eyas.lanes import exact

_ROUNDS: Final = 200  # How often places are sampled for those that have none yet

_PATIENT: Final = 10
"""Rounds with the offset that is asked for; then it grows, by up to `_WIDER` more each round."""

_WIDER: Final = 0.3  # [m]

_HOPELESS: Final = 40  # Rounds without a single place after which there is none

_APART: Final = 0.3  # Free ground around each [m]

Floats = NDArray[np.float64]


class _Middle(NamedTuple):
    """Points on the middles of roads, shape (K, 2) each."""

    point: Floats  # [m]
    left: Floats  # Unit vectors across the road


class Roadside:
    """Draws places at an offset from the middle of a random road.

    As in the original, all roads are equally likely, whatever their lengths; unlike there, the
    offset is perpendicular to the road, and the middle follows its bends.

    Args:
        network: The roads.
        obstacles: What stands in the way.
    """

    def __init__(self, network: RoadNetwork, obstacles: GroundObstacles) -> None:
        self._lines = [_line(street) for street in streets(network)]
        self._obstacles = obstacles

    def sample(
        self,
        count: int,  # How many
        offset: Variation,  # To the left of the middle of the road [m]
        radius: float,  # Distance to obstacles [m]
        rng: np.random.Generator,  # Random numbers
        what: str,  # Setting that asks for them, for the message
    ) -> Floats:
        """Return free places [m], shape (count, 2).

        Where there is nothing free at the offset, places are sought ever farther from it.

        Raises:
            SpawnError: The map has no room.
        """
        places, open_ = np.zeros((count, 2)), np.arange(count)
        for round_ in range(_ROUNDS):
            hopeless = round_ == _HOPELESS and len(open_) == count
            if not len(open_) or not self._lines or hopeless:
                break
            middle = self._middles(len(open_), rng)
            aside = np.array([sample(offset, rng) for _ in open_])
            aside += rng.uniform(-1.0, 1.0, len(open_)) * _WIDER * max(round_ - _PATIENT, 0)
            sampled = middle.point + aside[:, None] * middle.left
            free = ~self._obstacles.blocked(shapely.points(sampled), radius + _APART)
            places[open_[free]] = sampled[free]
            open_ = open_[~free]
        if len(open_):
            least, most = (f"{end:g}" for end in bounds(offset))
            raise SpawnError(
                f"{what}: beside the roads, {least if least == most else f'{least} to {most}'} m "
                f"from their middle, the map has only {count - len(open_)} of the {count} places "
                "that are needed one after the other; allowed: fewer, or a smaller offset"
            )
        return places

    def _middles(self, count: int, rng: np.random.Generator) -> _Middle:
        road = rng.integers(len(self._lines), size=count)
        lines = np.array(self._lines, object)[road]
        length = shapely.length(lines)
        along = rng.uniform(0.0, 1.0, count) * length
        before, after = np.maximum(along - 0.5, 0.0), np.minimum(along + 0.5, length)
        here, low, high = (
            shapely.get_coordinates(shapely.line_interpolate_point(lines, way))
            for way in (along, before, after)
        )
        onwards = high - low
        onwards /= np.maximum(exact.hypot(onwards[:, 0], onwards[:, 1]), 1e-9)[:, None]
        return _Middle(here, np.column_stack([-onwards[:, 1], onwards[:, 0]]))


def _line(street: Street) -> shapely.LineString:
    return shapely.LineString(street.left)


ROOM: Final = 0.1  # Room between a body and obstacles [m]

_BREADTH: Final = 0.82  # Diameter of the circle in which any pedestrian fits [m]


class Ground:
    """A map, as those see it who walk on it.

    Args:
        scene: The map.
        roads: Whether roads are left to cars.
        lights: What crossings with lights show, see `walk_plan`; None: there are none.
    """

    def __init__(self, scene: Scene, *, roads: bool, lights: SignalPlan | None = None) -> None:
        self.scene, self.lights = scene, lights
        self.obstacles = GroundObstacles(scene, roads=roads)
        self._roads = roads
        # Pavement walkers are beside the roads by the choice of their ways.
        self.surface = WalkedSurface(scene)
        self.roadside = Roadside(scene.network, self.obstacles)

    @cached_property
    def solids(self) -> GroundObstacles:
        """The obstacles without the roads."""
        return GroundObstacles(self.scene, roads=False) if self._roads else self.obstacles


def walkways(
    ground: Ground,  # The map
    breadth: float,  # Diameter of the circle in which those fit who walk [m]
    bend: float,  # Radius at which they round corners [m]
    # Those that may come over kerbs in narrow corners; None: there are none
    vehicles: Motion | None = None,
    *,
    verges: bool = False,  # Whether one also walks along the edges of roads that have no pavement
    # Distances from the kerb, see `pavement_ways`; in towns whose kerbs are known, the usual ones
    lanes: Sequence[float] = LANES,
) -> list[Walkway]:
    """Return the ways on pavements."""
    scene, radius = ground.scene, 0.5 * breadth + ROOM
    if scene.footways.told:
        # Its kerbs tell where the roads are; those of the network have sharp corners.
        obstacles = ground.solids
        found = kerb_ways(scene.footways, obstacles, ground.surface, radius, vehicles)
    else:
        obstacles, extent = ground.obstacles, scene.size
        found = pavement_ways(
            scene.network, extent, obstacles, ground.surface, radius, verges=verges, lanes=lanes
        )
    once = [outline(chain_through(way.corners, bend, 1)) for way in found]
    # A rounded corner may come too near to what the way leads round.
    lines = np.array([shapely.LineString(points) for points in once], object)
    blocked = obstacles.blocked(lines, 0.5 * breadth)
    return [way for way, stopped in zip(found, blocked.tolist(), strict=True) if not stopped]


def usable_crossings(scene: Scene) -> list[str]:
    """Return the name of the light of each crossing that joins pavements; empty: it has none."""
    ground, bend = Ground(scene, roads=True), habit_of(TargetName.PEDESTRIAN).radius
    ways = walkways(ground, _BREADTH, bend)
    found = crossings_of(scene, ways, ground.solids, 0.5 * _BREADTH)
    return list({one.number: one.light for one in found}.values())
