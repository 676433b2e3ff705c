"""Maps with roofs over some of their roads, from 10 to 150 m long: what `recover-wide` flies over.

They have the roads, and so the traffic, of the maps that they are made of. They are no names of the
table: `--map eyas.maps.covered:VILLAGE`, or with the seed of a town behind a colon.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.maps.citystreet import CITYSTREET as _CITYSTREET
from eyas.maps.downtown import DOWNTOWN as _DOWNTOWN
from eyas.maps.farmland import FARMLAND as _FARMLAND
from eyas.maps.lake import LAKE as _LAKE
from eyas.maps.village import VILLAGE as _VILLAGE

if TYPE_CHECKING:  # maps load with `eyas`; shapes only when a scene is built
    import shapely
    from numpy.random import Generator

    from eyas.engine.state.roads import RoadNetwork
    from eyas.engine.world.roads.areas import Street
    from eyas.maps.plan.plan import Building, MapPlan

_LENGTHS = (10.0, 15.0, 22.0, 33.0, 50.0, 75.0, 110.0, 150.0)  # Of roofs along the road [m]
_SHARE, _MOST = 0.15, 3  # Largest share of the roads below roofs; sites of each length
_PAIRED = 4  # One site of so many has two roofs, one after the other
_BETWEEN = 12.0, 30.0  # Distance of these two [m]
_ASIDE = 5.0
"""Width beyond the kerb [m]: a camera 9 m beside a car looks under a lower edge by 2.5 m."""
_BOTTOM, _HEIGHT = 6.5, 1.0  # Height above the road, and thickness [m]: trailers have 4 m
_APART = 40.0  # Least distance of two sites [m]: a drone that waits at one sees no other
_TRIED = 4_000  # Roofs that are tried in all


def _with_roofs(bare: "MapPlan", network: "RoadNetwork") -> "MapPlan":
    from eyas.maps.plan.plan import Buildings

    return replace(bare, layers=(*bare.layers, Buildings(items=tuple(_roofs(bare, network)))))


def _roofs(bare: "MapPlan", network: "RoadNetwork") -> Iterator["Building"]:
    """Yield the roofs of each site, as one object of the scene."""
    import shapely

    from eyas.engine.core.rng import stream
    from eyas.engine.world.build.materials import material
    from eyas.engine.world.build.millimetres import snapped
    from eyas.engine.world.roads.areas import streets
    from eyas.maps.build.heights import FLOOR_HEIGHT
    from eyas.maps.plan.plan import Building, BuildingPart, Buildings, Tunnels

    ways, rng = streets(network), stream(bare.seed, "roofs over roads")
    walls = [one for layer in bare.layers if isinstance(layer, Buildings) for one in layer.items]
    houses = shapely.union_all([part.outline for one in walls for part in one.parts])
    tunnels = [
        one.area for layer in bare.layers if isinstance(layer, Tunnels) for one in layer.items
    ]
    taken = shapely.union_all(tunnels)
    total = 0.5 * sum(shapely.length(shapely.LineString(way.left)) for way in ways)
    sites = min(max(int(_SHARE * total / sum(_LENGTHS)), 1), _MOST)
    left = [length for length in _LENGTHS for _ in range(sites)]
    for _ in range(_TRIED):
        if not left:
            return
        length, pair = left[-1], len(left) % _PAIRED == 0  # the longest first
        spans = [(0.0, length)]
        if pair:
            second = length + float(rng.uniform(*_BETWEEN))
            spans.append((second, second + length))
        road = int(rng.integers(len(ways)))
        line = _way(ways, road, spans[-1][1], rng)
        if line is None:
            continue
        wide = shapely.length(shapely.LineString([ways[road].left[0], ways[road].right[0]]))
        shapes = []
        for first, last in spans:
            part = shapely.ops.substring(line, first, last)
            strip = shapely.buffer(part, wide + _ASIDE, cap_style="flat", join_style="mitre")
            free = snapped(shapely.difference(strip, shapely.buffer(houses, 0.5)))
            shapes.append(max(shapely.get_parts(free), key=shapely.area))
        site = shapely.union_all(shapes)
        if shapely.distance(site, taken) < _APART or not all(map(_is_plain, shapes)):
            continue
        taken = shapely.union(taken, site)
        left.pop()
        shade = float(rng.uniform(0.55, 1.0).__round__(2))
        yield Building(
            parts=tuple(
                BuildingPart(
                    outline=shapely.geometry.polygon.orient(shape),
                    bottom=FLOOR_HEIGHT + _BOTTOM,
                    height=_HEIGHT,
                    facade="facade_concrete",
                    cover=material("roof_membrane", (shade, shade, shade)),
                    parapet=False,
                )
                for shape in shapes
            )
        )


def _is_plain(shape: "shapely.Geometry") -> bool:
    return shape.geom_type == "Polygon" and not shape.interiors and shape.area > 100.0


def _way(
    ways: "list[Street]", road: int, length: float, rng: "Generator"
) -> "shapely.LineString | None":
    """Return a way along the middle of roads from a place on one, over junctions; None: it ends."""
    import numpy as np
    import shapely

    points = ways[road].left
    begin = float(rng.uniform(0.0, 1.0)) * float(shapely.length(shapely.LineString(points)))
    for _ in range(20):
        line = shapely.LineString(points)
        if shapely.length(line) >= begin + length:
            return shapely.ops.substring(line, begin, begin + length)
        on = [
            number
            for number, way in enumerate(ways)
            if way.start == ways[road].end and way.end != ways[road].start
        ]
        if not on:
            return None
        road = on[int(rng.integers(len(on)))]
        points = np.concatenate([points, ways[road].left])
    return None


def _citystreet(network: "RoadNetwork", seed: int) -> "MapPlan":
    return _with_roofs(_CITYSTREET.plan(network, seed), network)


def _downtown(network: "RoadNetwork", seed: int) -> "MapPlan":
    return _with_roofs(_DOWNTOWN.plan(network, seed), network)


def _farmland(network: "RoadNetwork", seed: int) -> "MapPlan":
    return _with_roofs(_FARMLAND.plan(network, seed), network)


def _lake(network: "RoadNetwork", seed: int) -> "MapPlan":
    return _with_roofs(_LAKE.plan(network, seed), network)


def _village(network: "RoadNetwork", seed: int) -> "MapPlan":
    return _with_roofs(_VILLAGE.plan(network, seed), network)


CITYSTREET, DOWNTOWN, FARMLAND, LAKE, VILLAGE = (
    replace(base, name=f"{base.name}-covered", title=f"{base.title}, roofs over roads", plan=plan)
    for base, plan in (
        (_CITYSTREET, _citystreet),
        (_DOWNTOWN, _downtown),
        (_FARMLAND, _farmland),
        (_LAKE, _lake),
        (_VILLAGE, _village),
    )
)
