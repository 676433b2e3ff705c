"""A map as those see it who walk on it: what is in their way, and where they walk."""

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from eyas.engine.behaviours.chain import chain_through, outline
from eyas.engine.behaviours.crossings import crossings_of
from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.pavements import (
    LANES,
    Walkway,
    along,
    bridged,
    closed_blocks,
    is_hard,
    paved_parts,
    pavement_ways,
)
from eyas.engine.behaviours.surface import WalkedSurface
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.variation import Variation, bounds, sample
from eyas.engine.state.motion import SampledMotion
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import Footways, Scene
from eyas.engine.targets.catalogue import KINDS, MODELS, habit_of, models_of
from eyas.engine.targets.config import TargetName
from eyas.engine.traffic.signals import SignalPlan
from eyas.engine.world.roads.areas import Street, polygons_of, streets
from eyas.lanes import exact

# Ways along the kerbs of imported towns, whose pavements begin and end and are narrow.

_LANES: Final = (0.9, 1.45)
"""Distances from the kerb of those who have the road on their left, and on their right [m]."""

_BESIDE_CARS: Final = 0.6
"""Nearest to the kerb that one passes a wall or a tree; else it is passed on its other side [m]."""

_SPARE: Final = 0.15
"""How much wider obstacles are passed than need be, as corners of ways are rounded [m]."""

_ROUNDED: Final = 0.05  # How much nearer to obstacles ways may come where their corners are cut [m]

_CLEARANCE: Final = 1.0  # Distance to such places that is kept [m]

_KERB_HEIGHT: Final = 0.05
"""Pavements are higher than this: paving at the foot of buildings is not [m]."""

_FROM_CARS: Final = 1.1
"""Nobody walks nearer to where vehicles come, at the points that are tested [m]."""

_GRAIN: Final = 0.1  # Places nearer to each other than half of this are one [m]

_TURN: Final = 0.03  # The same for headings [rad]


def kerb_ways(
    footways: Footways,  # The kerbs
    obstacles: GroundObstacles,  # What stands in the way, without the roads
    surface: WalkedSurface,  # The ground
    radius: float,  # Distance to obstacles that is kept [m]
    # Those that may come over kerbs, as in narrow corners; None: there are none
    vehicles: SampledMotion | None = None,
) -> list[Walkway]:
    """Return the ways along all kerbs with pavements, round what stands on these."""
    swept = shapely.STRtree(_swept(vehicles) if vehicles is not None else [])
    place = _Place(obstacles, surface, swept, radius)
    found = []
    for first, last in pairwise(footways.kerb_first):
        kerb = shapely.LinearRing(footways.kerb_points[first:last])
        for lane, beyond in enumerate(_LANES):
            for ring in _rings(kerb, beyond, obstacles, radius):
                line = shapely.reverse(ring) if lane == 1 else ring
                found += _paved(line, place, lane)
    return found


class _Place(NamedTuple):
    """What decides where one walks along a kerb."""

    obstacles: GroundObstacles
    surface: WalkedSurface
    swept: shapely.STRtree  # Where vehicles come
    radius: float  # Distance to obstacles that is kept [m]


def _paved(ring: shapely.LinearRing, place: _Place, lane: int) -> list[Walkway]:
    """Return the parts of a ring that are on pavement, where no vehicle comes."""
    free, hard = _walked(ring, place)
    if not free.all():
        # It begins where nobody walks, so that no part of it is cut in two.
        ring = _from(ring, float(np.argmin(free)))
        free, hard = _walked(ring, place)
        free = bridged(free, hard)
    return paved_parts(ring, free, lane)


def _walked(ring: shapely.LinearRing, place: _Place) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which points along a ring are on pavement, and which are hard ground.

    Neither are those where cars come, or where obstacles leave no room on either side.
    """
    points = along(ring)
    under, clear = place.surface.at(points), np.ones(len(points), np.bool_)
    near = place.swept.query(shapely.points(points), predicate="dwithin", distance=_FROM_CARS)
    clear[near[0]] = False
    least = place.radius - _ROUNDED
    narrow = shapely.buffer(place.obstacles.near(ring, least), least, quad_segs=2)
    if len(narrow):
        met = shapely.intersection(ring, shapely.union_all(narrow))
        shapely.prepare(met)
        clear &= ~shapely.dwithin(shapely.points(points), met, _CLEARANCE)
    raised = under.pavement & (under.height > _KERB_HEIGHT)
    return raised & clear, is_hard(under.height) & clear


def _swept(vehicles: SampledMotion) -> NDArray[np.object_]:
    """Return where vehicles are, as boxes seen from above, each but once."""
    made = []
    for kind in np.unique(vehicles.kind).tolist():
        rows = vehicles.table[:, vehicles.kind == kind]
        rows = rows[rows["present"] > 0.0]
        # One number for each place and heading: unique rows would take five times as long.
        place = np.rint([rows["x"] / _GRAIN, rows["y"] / _GRAIN, rows["yaw"] / _TURN])
        _, first = np.unique((place[0] * 1e5 + place[1]) * 1e4 + place[2], return_index=True)
        x, y, yaw = place[:, first] * [[_GRAIN], [_GRAIN], [_TURN]]
        length, width, _ = np.array([MODELS[model].size for model in models_of(kind)]).max(axis=0)
        ahead = KINDS[kind].ahead + 0.5 * length * np.array([-1.0, 1.0, 1.0, -1.0])
        aside = 0.5 * width * np.array([-1.0, -1.0, 1.0, 1.0])
        cosine, sine = exact.cos(yaw)[:, None], exact.sin(yaw)[:, None]
        east = x[:, None] + ahead * cosine - aside * sine
        north = y[:, None] + ahead * sine + aside * cosine
        made.append(shapely.polygons(np.stack([east, north], axis=2)))
    return np.concatenate(made) if made else np.zeros(0, object)


def _from(ring: shapely.LinearRing, place: float) -> shapely.LinearRing:
    """Return a ring that begins at a place on it [m]."""
    parts = substring(ring, place, ring.length), substring(ring, 0.0, place)
    first, last = (shapely.get_coordinates(part) for part in parts)
    return shapely.LinearRing(np.concatenate([first[:-1], last]))


def _rings(
    kerb: shapely.LinearRing, beyond: float, obstacles: GroundObstacles, radius: float
) -> list[shapely.LinearRing]:
    """Return the ways at a distance from a kerb [m], with the road on their left."""
    around = shapely.is_ccw(kerb)  # the road lies within; otherwise it lies round a block
    plan = shapely.Polygon(kerb)
    aside = shapely.buffer(plan, beyond if around else -beyond, quad_segs=2)
    made = []
    for part in polygons_of(aside):
        inner = shapely.Polygon(part.exterior)
        near = obstacles.near(inner.exterior, radius + 0.1)
        kept = shapely.buffer(near, radius + _SPARE, quad_segs=2)
        at_kerb = shapely.distance(kept, kerb) < _BESIDE_CARS
        # What stands at the kerb is passed on the far side of it, all else on the near side.
        joined, cut = (at_kerb, ~at_kerb) if around else (~at_kerb, at_kerb)
        whole = shapely.union_all([inner, *kept[joined]])
        free = shapely.difference(whole, shapely.union_all(kept[cut]))
        parts = polygons_of(shapely.simplify(free, 0.04))
        if parts:
            ring = max(parts, key=shapely.area).exterior
            made.append(ring if shapely.is_ccw(ring) == around else shapely.reverse(ring))
    return made


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


class WalkingGround:
    """A map, as those see it who walk on it.

    Args:
        scene: The map.
        roads: Whether roads are left to cars.
        lights: What crossings with lights show, see `walk_plan`; None: there are none.
    """

    def __init__(self, scene: Scene, *, roads: bool, lights: SignalPlan | None = None) -> None:
        self.scene, self.lights = scene, lights
        self.solids = GroundObstacles(scene, roads=False)  # The obstacles without the roads
        self.obstacles = self.solids
        if roads:
            self.obstacles = GroundObstacles(scene, roads=True, others=self.solids)
        # Pavement walkers are beside the roads by the choice of their ways.
        self.surface = WalkedSurface(scene)
        self.roadside = Roadside(scene.network, self.obstacles)

    @cached_property
    def blocks(self) -> list[shapely.Polygon]:
        """The blocks with roads all round."""
        return closed_blocks(self.scene.network, self.scene.size)


def walkways(
    ground: WalkingGround,  # The map
    breadth: float,  # Diameter of the circle in which those fit who walk [m]
    bend: float,  # Radius at which they round corners [m]
    # Those that may come over kerbs in narrow corners; None: there are none
    vehicles: SampledMotion | None = None,
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
        obstacles, blocks = ground.obstacles, ground.blocks
        found = pavement_ways(blocks, obstacles, ground.surface, radius, verges=verges, lanes=lanes)
    once = [outline(chain_through(way.corners, bend, 1)) for way in found]
    # A rounded corner may come too near to what the way leads round.
    lines = np.array([shapely.LineString(points) for points in once], object)
    blocked = obstacles.blocked(lines, 0.5 * breadth)
    return [way for way, stopped in zip(found, blocked.tolist(), strict=True) if not stopped]


def usable_crossings(scene: Scene) -> list[str]:
    """Return the name of the light of each crossing that joins pavements; empty: it has none."""
    ground, bend = WalkingGround(scene, roads=True), habit_of(TargetName.PEDESTRIAN).radius
    ways = walkways(ground, _BREADTH, bend)
    found = crossings_of(scene, ways, ground.solids, 0.5 * _BREADTH)
    return list({one.number: one.light for one in found}.values())
