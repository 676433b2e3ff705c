"""Write an OpenStreetMap file of a town that does not exist, to try the importer without a network.

    python tools/synthetic_osm.py town.osm --columns 4 --rows 4
    python tools/synthetic_osm.py city.osm --columns 9 --rows 15
    python tools/synthetic_osm.py city.osm --columns 11 --rows 20 --as-found    # a city, 10 MB

The town has avenues, side streets and traffic lights, closed blocks with courtyards, towers of
several parts, houses with gardens, sheds, a church, parks with paths and ponds, a river, a railway,
car parks, trees and rows of trees. Some tags are missing, some are odd, as in real data. North of
it, in a quarter of its own, stands every tag that the importer reads (`osm_every_tag.py`). With
`--as-found` its streets are wider and its blocks denser, each object has a history, there are
thousands of shops with names in all scripts, and defects of many kinds.
"""

import argparse
import math
import random
from itertools import pairwise
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import shapely
from osm_as_found import add_defects, add_shops, as_found
from osm_every_tag import add_quarter
from shapely import affinity

from eyas.engine.world.projection import Projection

ORIGIN = Projection(13.4, 52.5)
_SHOPS = 16_000
Point = tuple[float, float]


class Writer:
    """Collects nodes, ways and relations."""

    def __init__(self) -> None:
        self._places: list[Point] = []
        self._tags: dict[int, dict[str, str]] = {}
        self._others: list[str] = []
        self._next = 1_000_000

    def node(self, place: Point, **tags: str) -> int:
        """Add a point; return its number."""
        self._places.append(place)
        self._tags[len(self._places)] = tags
        return len(self._places)

    def tag(self, node: int, **tags: str) -> None:
        """Add tags to a point."""
        self._tags[node] |= tags

    def way(self, nodes: list[int], **tags: str) -> int:
        """Add a line of points; return its number."""
        self._next += 1
        refs = "".join(f'<nd ref="{node}"/>' for node in nodes)
        self._others.append(f'<way id="{self._next}">{refs}{_tags(tags)}</way>')
        return self._next

    def ring(self, points: list[Point], **tags: str) -> int:
        """Add a closed line; return its number."""
        nodes = [self.node(point) for point in points]
        return self.way([*nodes, nodes[0]], **tags)

    def area(self, shape: shapely.Polygon, **tags: str) -> None:
        """Add an area, with holes as a relation."""
        rings = [list(ring.coords)[:-1] for ring in (shape.exterior, *shape.interiors)]
        if len(rings) == 1:
            self.ring(rings[0], **tags)
            return
        ways = [self.ring(ring) for ring in rings]
        roles = ["outer"] + ["inner"] * (len(rings) - 1)
        members = [("way", way, role) for way, role in zip(ways, roles, strict=True)]
        self.relation(members, type="multipolygon", **tags)

    def relation(self, members: list[tuple[str, int, str]], **tags: str) -> None:
        """Add a relation of members: kind, number and role of each."""
        self._next += 1
        said = "".join(
            f'<member type="{kind}" ref="{number}" role="{role}"/>'
            for kind, number, role in members
        )
        self._others.append(f'<relation id="{self._next}">{said}{_tags(tags)}</relation>')

    def raw(self, element: str) -> None:
        """Add an element as it is."""
        self._others.append(element)

    def lines(self, half: Point) -> list[str]:
        """Return the file's lines; `half` is half the extent of the town [m]."""
        degrees = ORIGIN.degrees(np.array(self._places))
        low, high = ORIGIN.degrees(np.array([[-half[0], -half[1]], half]))
        lines = [
            '<?xml version="1.0" encoding="UTF-8"?>',
            '<osm version="0.6" generator="eyas tools/synthetic_osm.py">',
            f'<bounds minlat="{low[1]:.7f}" minlon="{low[0]:.7f}" '
            f'maxlat="{high[1]:.7f}" maxlon="{high[0]:.7f}"/>',
        ]
        for number, (x, y) in enumerate(degrees, 1):
            tags = _tags(self._tags[number])
            lines.append(f'<node id="{number}" lat="{y:.7f}" lon="{x:.7f}">{tags}</node>')
        # Relations come last, as in real files.
        ways = [other for other in self._others if other.startswith("<way")]
        rest = [other for other in self._others if not other.startswith("<way")]
        return [*lines, *ways, *rest, "</osm>", ""]


def _tags(tags: dict[str, str]) -> str:
    return "".join(
        f"<tag k={quoteattr(key.replace('__', ':'))} v={quoteattr(value)}/>"
        for key, value in tags.items()
    )


class Town:
    """A town of blocks.

    Args:
        columns: Number of blocks from west to east.
        rows: Number of blocks from south to north.
        seed: Seed of everything.
        found: Whether it is written as found.
    """

    def __init__(self, columns: int, rows: int, seed: int, *, found: bool = False) -> None:
        self.out, self.rng, self.found = Writer(), random.Random(seed), found
        self.columns, self.rows = columns, rows
        widths = [self.rng.uniform(88, 128) for _ in range(columns)]
        depths = [self.rng.uniform(88, 132) for _ in range(rows)]
        self.half = (sum(widths) / 2 + 45, sum(depths) / 2 + 45)
        self._width = sum(widths)
        turn = math.radians(11)
        self.at: dict[tuple[int, int], Point] = {}
        for i in range(columns + 1):
            for j in range(rows + 1):
                x = sum(widths[:i]) - sum(widths) / 2 + self.rng.uniform(-5, 5)
                y = sum(depths[:j]) - sum(depths) / 2 + self.rng.uniform(-5, 5)
                shear = 0.12 * math.sin(y / 260)
                self.at[i, j] = (
                    x * math.cos(turn * shear) - y * math.sin(turn) * 0.3,
                    y + x * math.sin(turn) * 0.3,
                )
        self.nodes = {key: self.out.node(place) for key, place in self.at.items()}
        self.avenues_x = {columns // 2, *range(1, columns, 4)}
        self.avenues_y = {rows // 2, *range(2, rows, 5)}

    def build(self) -> str:
        """Return the whole file."""
        self._streets()
        for i in range(self.columns):
            for j in range(self.rows):
                self._block(i, j)
        self._railway()
        self._quarter()
        if not self.found:
            return "\n".join(self.out.lines(self.half))
        add_shops(self.out.node, self.half, _SHOPS, self.rng)
        add_defects(self.out.node, self.out.way, self.out.raw, self.half, self.rng)
        return "\n".join(as_found(self.out.lines(self.half), self.rng))

    def _streets(self) -> None:
        for i in range(self.columns + 1):
            self._street([(i, j) for j in range(self.rows + 1)], i in self.avenues_x, i)
        for j in range(self.rows + 1):
            self._street([(i, j) for i in range(self.columns + 1)], j in self.avenues_y, j)
        for i in self.avenues_x:
            for j in range(self.rows + 1):
                if j in self.avenues_y or (i + j) % 2 == 0:
                    self.out.tag(self.nodes[i, j], highway="traffic_signals")
        for j in self.avenues_y:
            for i in range(0, self.columns + 1, 2):
                self.out.tag(self.nodes[i, j], highway="traffic_signals")

    def _street(self, keys: list[tuple[int, int]], avenue: bool, index: int) -> None:
        tags = {"highway": "residential", "name": f"Street {index}"}
        if avenue:
            tags = {"highway": "primary", "lanes": "4", "sidewalk": "both", "maxspeed": "50"}
        elif index % 3 == 1:
            lanes = "4" if self.found else "2"
            tags = {"highway": "secondary", "lanes": lanes, "sidewalk": "both"}
        elif index % 3 == 2:
            tags |= {"oneway": "yes", "maxspeed": "30", "lanes": self.rng.choice(["1", "two"])}
        if self.found and tags["highway"] == "residential":
            tags |= {"lanes": "2" if "oneway" in tags else "4", "sidewalk": "right"}
        nodes = [self.nodes[keys[0]]]
        for a, b in pairwise(keys):
            (ax, ay), (bx, by) = self.at[a], self.at[b]
            bend = self.rng.uniform(-2, 2)
            nodes.append(self.out.node(((ax + bx) / 2 + bend, (ay + by) / 2 - bend)))
            nodes.append(self.nodes[b])
            side = self.rng.choice([-1, 1])
            if avenue:
                self._tree_row((ax, ay), (bx, by), 12.5 * side)
        self.out.way(nodes, **tags)

    def _tree_row(self, start: Point, end: Point, aside: float) -> None:
        dx, dy = end[0] - start[0], end[1] - start[1]
        size = math.hypot(dx, dy)
        normal = (-dy / size * aside, dx / size * aside)
        for step in range(24, int(size) - 20, 16):
            share = step / size
            place = (start[0] + share * dx + normal[0], start[1] + share * dy + normal[1])
            self.out.node(place, natural="tree", height=f"{self.rng.uniform(9, 15):.1f}")

    def _block(self, i: int, j: int) -> None:
        corners = [self.at[i, j], self.at[i + 1, j], self.at[i + 1, j + 1], self.at[i, j + 1]]
        ground = shapely.Polygon(corners).buffer(-13, join_style="mitre")
        away = math.hypot(i + 0.5 - self.columns / 2, j + 0.5 - self.rows / 2)
        reach = 0.5 * math.hypot(self.columns, self.rows)
        kind = self.rng.random()
        if i == 0 and self.columns > 3:
            self._river(shapely.Polygon(corners).buffer(-9, join_style="mitre"), j)
        elif kind < 0.09 or (i, j) == (self.columns // 2, self.rows // 2 + 1):
            self._park(ground)
        elif away < 0.28 * reach or kind > 0.93:
            self._towers(ground)
        elif self.found and kind < 0.7:
            self._towers(ground)
        elif away < 0.6 * reach or (self.found and kind < 0.8):
            self._closed_block(ground)
        elif kind < 0.75:
            self._houses(ground)
        else:
            self._sheds(ground)

    def _river(self, ground: shapely.Polygon, j: int) -> None:
        west, south, east, north = ground.bounds
        band = shapely.box(west, south, west + 0.55 * (east - west), north)
        self.out.area(ground.intersection(band), natural="water", water="river")
        self.out.area(ground.difference(band.buffer(2)), leisure="park")
        if j % 2:
            self._scatter(ground.difference(band.buffer(4)), 7)

    def _park(self, ground: shapely.Polygon) -> None:
        self.out.area(ground, leisure="park", name="Park")
        middle = ground.centroid
        pond = affinity.scale(middle.buffer(11), 1.7, 1.0)
        self.out.area(affinity.translate(pond.simplify(0.5), 14, 6), natural="water")
        corners = list(ground.exterior.coords)
        for a, b in ((0, 2), (1, 3)):
            line = [corners[a], (middle.x, middle.y), corners[b]]
            self.out.way([self.out.node(p) for p in line], highway="footway", surface="gravel")
        pitch = affinity.translate(shapely.box(-13, -7, 13, 7), middle.x - 18, middle.y - 14)
        if ground.contains(pitch):
            self.out.area(pitch, leisure="pitch", sport="tennis")
        self._scatter(ground, 26)

    def _scatter(self, ground: shapely.Polygon, count: int) -> None:
        west, south, east, north = ground.bounds
        for _ in range(count):
            place = (self.rng.uniform(west, east), self.rng.uniform(south, north))
            if ground.contains(shapely.Point(place)):
                self.out.node(place, natural="tree")

    def _closed_block(self, ground: shapely.Polygon) -> None:
        self.out.area(ground, landuse="residential")
        yard = ground.buffer(-self.rng.uniform(12, 15), join_style="mitre")
        if self.rng.random() < (0.7 if self.found else 0.35) and not yard.is_empty:
            tags = {"building": "apartments", "building__levels": str(self.rng.randint(4, 7))}
            self.out.area(shapely.Polygon(ground.exterior, [yard.exterior]), **tags)
            self._scatter(yard, 5)
            return
        corners = list(shapely.geometry.polygon.orient(ground).exterior.coords)[:-1]
        for k in range(4):
            pieces = 3 if k % 2 else 2
            for piece in range(pieces):
                shape = _slice(corners[k], corners[(k + 1) % 4], ground, piece, pieces, k)
                if shape is not None:
                    self.out.area(shape, **self._town_house())
        if self.rng.random() < 0.6:
            self._scatter(yard, 6)
        else:
            self.out.area(yard.buffer(-3, join_style="mitre"), amenity="parking")

    def _town_house(self) -> dict[str, str]:
        tags = {"building": self.rng.choice(["apartments", "residential", "yes", "retail"])}
        kind = self.rng.random()
        if kind < 0.4:
            tags["building__levels"] = str(self.rng.randint(3, 7))
        elif kind < 0.6:
            tags["height"] = self.rng.choice(["15 m", "18.5", "21", "40'", "high"])
        if self.rng.random() < 0.45:
            tags["roof__shape"] = self.rng.choice(["gabled", "gabled", "hipped", "flat"])
        if self.rng.random() < 0.2:
            tags["building__colour"] = self.rng.choice(["#d9c7a0", "beige", "#b5694d", "lightgrey"])
        return tags

    def _towers(self, ground: shapely.Polygon) -> None:
        self.out.area(ground, landuse="commercial")
        centre = ground.centroid
        quarters = [
            affinity.scale(ground, 0.42, 0.42, origin=corner)
            for corner in list(ground.exterior.coords)[:-1]
        ]
        for quarter in quarters:
            if self.rng.random() < 0.12:
                self.out.area(quarter, amenity="parking")
                continue
            levels = self.rng.choice([5, 6, 8, 10, 14, 18, 26])
            tags = {"building": self.rng.choice(["office", "commercial", "hotel", "apartments"])}
            self.out.area(quarter, **tags, building__levels=str(levels))
            if levels > 9:
                base = quarter.buffer(0)
                shaft = affinity.scale(quarter, 0.62, 0.62)
                self.out.area(base, building__part="yes", height="12")
                self.out.area(
                    shaft, building__part="yes", min_height="12", height=str(3.2 * levels)
                )
                top = affinity.scale(quarter, 0.3, 0.3)
                low, high = 3.2 * levels, 3.2 * levels + 5
                shape = self.rng.choice(["flat", "pyramidal", "dome"])
                self.out.area(
                    top,
                    building__part="yes",
                    min_height=f"{low}",
                    height=f"{high + (4 if shape != 'flat' else 0)}",
                    roof__shape=shape,
                    roof__height="4",
                )
        self.out.node((centre.x, centre.y), natural="tree", height="12")

    def _houses(self, ground: shapely.Polygon) -> None:
        self.out.area(ground, landuse="residential")
        corners = list(ground.exterior.coords)[:-1]
        west, south, east, north = ground.bounds
        angle = math.degrees(
            math.atan2(corners[1][1] - corners[0][1], corners[1][0] - corners[0][0])
        )
        for x in np.arange(west + 9, east - 8, 17.5):
            for y in (south + 10, south + 30, north - 30, north - 10):
                width, depth = self.rng.uniform(8, 12), self.rng.uniform(9, 13)
                house = affinity.rotate(
                    shapely.box(x - width / 2, y - depth / 2, x + width / 2, y + depth / 2), angle
                )
                if self.rng.random() < 0.2:
                    house = house.union(affinity.translate(house, 0.55 * width, 3.5))
                if ground.contains(house) and self.rng.random() < 0.86:
                    tags = {"building": self.rng.choice(["house", "detached", "yes"])}
                    if self.rng.random() < 0.5:
                        tags["roof__shape"] = self.rng.choice(
                            ["gabled", "hipped", "pyramidal", "half-hipped", "skillion"]
                        )
                    self.out.area(house, **tags)
        self._scatter(ground, 12)

    def _sheds(self, ground: shapely.Polygon) -> None:
        self.out.area(ground, landuse="industrial")
        hall = affinity.scale(ground, 0.6, 0.45)
        self.out.area(hall, building="industrial", height="9")
        self.out.area(
            affinity.translate(affinity.scale(ground, 0.7, 0.2), 0, 0.36 * _depth(ground)),
            amenity="parking",
        )
        self.out.area(
            affinity.translate(affinity.scale(ground, 0.3, 0.2), 0, -0.36 * _depth(ground)),
            building="warehouse",
        )

    def _quarter(self) -> None:
        """Add the quarter of all tags north of the town."""
        west, north = -0.5 * self._width, max(y for _, y in self.at.values()) + 40.0
        start = self.nodes[0, self.rows]
        end = add_quarter(self.out, west, north, self._width, start)
        self.half = (self.half[0], max(self.half[1], end))

    def _railway(self) -> None:
        x = max(place[0] for place in self.at.values()) + 26
        nodes = [self.out.node((x, y)) for y in np.linspace(-self.half[1], self.half[1], 12)]
        self.out.way(nodes, railway="rail")


def _depth(shape: shapely.Polygon) -> float:
    return float(shape.bounds[3] - shape.bounds[1])


def _slice(
    start: Point, end: Point, ground: shapely.Polygon, piece: int, pieces: int, side: int
) -> shapely.Polygon | None:
    """Return one building of a row along a side of a block."""
    along = np.array(end) - np.array(start)
    size = float(np.linalg.norm(along))
    along /= size
    inwards = np.array([-along[1], along[0]])
    room = 13.0 if side % 2 else 0.0  # the corners belong to the other two sides
    step = (size - 2 * room) / pieces
    low, high = room + piece * step, room + (piece + 1) * step
    corners = [
        np.array(start) + s * along + t * inwards
        for s, t in ((low, 0), (high, 0), (high, 13), (low, 13))
    ]
    shape = shapely.intersection(shapely.Polygon(corners), ground)
    return shape if shape.geom_type == "Polygon" and shape.area > 60 else None


def main() -> None:
    """Write the file that the arguments name."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("path", type=Path)
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--rows", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--as-found", action="store_true")
    said = parser.parse_args()
    text = Town(said.columns, said.rows, said.seed, found=said.as_found).build()
    said.path.write_text(text, encoding="utf-8")
    print(f"{said.path}: {len(text) / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
