"""Figures of a map: extent, streets, buildings, trees, whose data it is; also with another seed."""

from dataclasses import dataclass
from importlib.resources.abc import Traversable

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.behaviours.ground import usable_crossings
from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.roads import LEFT_ENDING, RoadNetwork
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.recording_file import RecordingFile
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import Original


@dataclass(frozen=True, slots=True)
class MapFigures:
    """Figures of a scene."""

    size: tuple[float, float]  # Extent of the floor [m]
    area: float  # Area of the rectangle around the streets [km^2]
    road: float
    """Length of the streets from the middle of one junction to that of the next, both directions
    counted once [km]."""
    between: float  # Length of the streets without what lies within junctions [km]
    lanes: float  # Length of all lanes [km]
    buildings: int
    height: float  # Median height of the buildings [m]
    trees: int  # Trees by themselves and in stands; no shrubs or hedges
    stands: int  # Copies that are several trees each
    lamps: int


def figures_of(scene: Scene) -> MapFigures:
    """Return the figures of a scene."""
    network, solids = scene.network, scene.colliders
    span = np.ptp(network.lane_points, axis=0) if len(network.lane_points) else np.zeros(2)
    kinds = scene.object_class
    built = kinds[solids.prism_object] == ObjectClass.BUILDING
    tops: dict[int, float] = {}
    for owner, top in zip(solids.prism_object[built], solids.prism_top[built], strict=True):
        tops[int(owner)] = max(tops.get(int(owner), 0.0), float(top))
    counts = np.array(scene.fixtures.trees or (0,), np.int64)
    planted = counts[scene.fixtures.prototype]
    ways = _ways(network)
    within = sum(_within_junctions(network, edge, line) for edge, line in ways)
    between = sum(line.length for _, line in ways)
    return MapFigures(
        size=scene.size,
        area=float(np.prod(span)) / 1e6,
        road=(between + within) / 1000.0,
        between=between / 1000.0,
        lanes=float(_lengths(network).sum()) / 1000.0,
        buildings=len(tops),
        height=float(np.median(list(tops.values()))) if tops else 0.0,
        trees=int(planted.sum()),
        stands=int((planted > 1).sum()),
        lamps=len(scene.lamps.position),
    )


def street_lines(network: RoadNetwork) -> list[shapely.LineString]:
    """Return the middle of each street between junctions, once for both directions [m]."""
    return [line for _, line in _ways(network)]


def _within_junctions(network: RoadNetwork, edge: int, line: shapely.LineString) -> float:
    """Return the distance from both ends of a street to the middles of its junctions [m]."""
    ends = shapely.get_coordinates(line)[[0, -1]]
    total = 0.0
    for end, name in zip(ends, (network.edge_start[edge], network.edge_end[edge]), strict=True):
        index = network.junctions.index(name)
        low, high = network.junction_first[index : index + 2]
        if high - low >= 3:
            middle = shapely.Polygon(network.junction_points[low:high]).centroid
            total += float(middle.distance(shapely.Point(end)))
    return total


def _ways(network: RoadNetwork) -> list[tuple[int, shapely.LineString]]:
    """Return the index of an edge of each street, and its middle [m]."""
    first = network.lane_first
    ends = list(zip(network.edge_start, network.edge_end, strict=True))
    reverse: dict[tuple[str, str], list[int]] = {}
    for edge, (start, end) in enumerate(ends):
        reverse.setdefault((end, start), []).append(edge)
    leftmost: dict[int, int] = {}
    for lane, edge in enumerate(network.lane_edge.tolist()):
        if edge not in leftmost or network.lane_index[lane] > network.lane_index[leftmost[edge]]:
            leftmost[edge] = lane
    lines, done = [], set()
    for edge, lane in leftmost.items():
        back = [other for other in reverse.get(ends[edge], []) if other not in done]
        if edge in done:
            continue
        done.add(edge)
        points = network.lane_points[first[lane] : first[lane + 1]]
        line = shapely.LineString(points)
        if back:
            done.add(back[0])
            line = shapely.offset_curve(line, float(network.lane_width[lane]) / 2)
        if line.geom_type == "LineString" and not line.is_empty:
            lines.append((edge, line))
    return lines


@dataclass(frozen=True, slots=True)
class MapFacts:
    """What there is to say about a map with a seed."""

    name: str
    title: str
    seed: int
    weathers: tuple[str, ...]
    figures: MapFigures
    crossings: int  # Number of crossings from pavement to pavement
    crossings_with_lights: int
    original: Original | None  # Figures of the map of the DAT benchmark that it stands for
    recorded_traffic: list[str]  # Names of the recordings that ship with it
    folder: str | None  # Folder of an imported map; None: it comes with Eyas
    drive_on: str  # The side of the road on which one drives, `left` or `right`
    attribution: list[str]  # Notices of whose data the map is made of


def about(name: str, seed: int) -> MapFacts:
    """Return what there is to say about a map.

    Raises:
        EyasError: There is no such map, or it cannot be built.
    """
    recipe, scene = MAPS.get(name), load_scene(name, seed)
    lights = usable_crossings(scene)
    return MapFacts(
        name=recipe.name,
        title=recipe.title,
        seed=seed,
        weathers=tuple(recipe.weathers),
        figures=figures_of(scene),
        crossings=len(lights),
        crossings_with_lights=sum(map(bool, lights)),
        original=recipe.original,
        recorded_traffic=[
            file.name
            for file in recipe.shipped_traffic()
            # An imported map has its streets at any seed.
            if recipe.home is not None or _town_of(file) == seed
        ],
        folder=None if recipe.home is None else str(recipe.home),
        drive_on="left" if scene.network.left_hand else "right",
        attribution=recipe.attribution().splitlines(),
    )


def describe(name: str, seed: int) -> list[str]:
    """Return what `eyas maps info` prints.

    Raises:
        EyasError: There is no such map, or it cannot be built.
    """
    known = about(name, seed)
    said, lit = known.figures, known.crossings_with_lights
    area = max(said.area, 1e-9)
    lines = [
        f"{known.name}: {known.title}",
        f"weathers: {', '.join(known.weathers)}",
        f"floor: {said.size[0]:.0f} x {said.size[1]:.0f} m; streets within {said.area:.2f} km2",
        f"streets: {said.road:.2f} km, {said.between:.2f} km without junctions "
        f"({said.road / area:.1f} km per km2)",
        f"lanes: {said.lanes:.2f} km; lamps: {said.lamps}; traffic keeps {known.drive_on}",
        f"buildings: {said.buildings} ({said.buildings / area:.0f} per km2), "
        f"median height {said.height:.0f} m",
        f"trees: {said.trees} ({said.trees / area:.0f} per km2)"
        + (f", in {said.stands} stands" if said.stands else ""),
        f"crossings from pavement to pavement: {known.crossings}"
        + (f", of which {lit} have traffic lights" if lit else ""),
    ]
    if known.original is not None:
        lines.append(_of_the_original(known.original))
    recorded = ", ".join(known.recorded_traffic) or "none; recorded on first use"
    lines.append(f"recorded traffic: {recorded}")
    if known.folder is not None:
        lines.append(f"folder: {known.folder}")
    return lines + known.attribution


def _town_of(file: Traversable) -> int:
    """Return the seed of the map that a recording was made on."""
    return RecordingFile.read(file).outline().provenance.map_seed


def _of_the_original(figures: Original) -> str:
    built = f", median height {figures.height:.0f} m" if figures.buildings else ""
    return (
        f"the original has {figures.road:.2f} km of streets, {figures.buildings} buildings{built}, "
        f"{figures.trees} trees"
    )


def _lengths(network: RoadNetwork) -> NDArray[np.float64]:
    first = network.lane_first
    lines = [
        shapely.LineString(network.lane_points[first[k] : first[k + 1]])
        for k in range(len(first) - 1)
    ]
    return np.asarray(shapely.length(lines), np.float64)


def make_another(name: str, seed: int, *, left_hand: bool = False) -> list[str]:
    """Make the map's roads, scene, geometry and traffic, all of which are kept in the cache.

    Args:
        left_hand: Whether traffic keeps left on it; of a map that ships.

    Returns:
        Its figures, and how to use it.

    Raises:
        EyasError: There is no such map, or it cannot be made.
    """
    if left_hand and name not in MAPS.built_in:
        known = ", ".join(sorted(MAPS.built_in))
        raise ConfigError(f"--drive-on: 'left' is not allowed for {name!r}; allowed for: {known}")
    map_name = MAPS.get(name).name + (LEFT_ENDING if left_hand else "")
    world = WorldConfig(map=map_name, seed=seed)
    load_assets(world, TrafficConfig(), 1).renderer.part_reach()  # makes what is drawn, too
    told = [line for line in describe(map_name, seed) if not line.startswith("recorded traffic")]
    return [*told, f"use it with --map {world.map} --set world.seed={seed}"]
