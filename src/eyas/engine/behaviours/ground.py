"""A map as those see it who walk on it: what is in their way, and where they walk."""

from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np
import shapely

from eyas.engine.behaviours.chain import chain_through, outline
from eyas.engine.behaviours.crossings import crossings_of
from eyas.engine.behaviours.kerbs import kerb_ways
from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.pavements import LANES, Walkway, pavement_ways
from eyas.engine.behaviours.places import Roadside
from eyas.engine.behaviours.surface import WalkedSurface
from eyas.engine.state.motion import Motion
from eyas.engine.state.scene import Scene
from eyas.engine.targets.catalogue import habit_of
from eyas.engine.targets.config import TargetName
from eyas.engine.traffic.signals import SignalPlan

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
