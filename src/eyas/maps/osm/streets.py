"""The streets of OpenStreetMap: cut to an area, made clean, and put through SUMO's netconvert."""

import re
import subprocess
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, pairwise
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.scratch import scratch
from eyas.engine.traffic.network import without_comments
from eyas.engine.traffic.sumo_install import sumo_binary, sumo_environment
from eyas.lanes import exact
from eyas.maps.osm.measures import Odd, number
from eyas.maps.osm.reader import Bounds, OsmData, Tags, Way

_DRIVEN = re.compile(
    r"(motorway|trunk|primary|secondary|tertiary)(_link)?|unclassified|residential|living_street"
    r"|service|road"
)
_NO_STREETS = {"parking_aisle", "driveway", "drive-through", "emergency_access"}
"""Kinds of `service` that lead to one building only."""

_KEPT = (
    "highway oneway lanes lanes:forward lanes:backward maxspeed junction access vehicle "
    "motor_vehicle motorcar sidewalk sidewalk:left sidewalk:right sidewalk:both footway layer "
    "turn:lanes turn:lanes:forward turn:lanes:backward width"
).split()
"""Tags of ways that netconvert uses."""

_NOT_WALKED = ("motorway", "motorway_link", "living_street", "service")
"""Streets that have no sidewalk unless it is mapped."""

_WALKED_BESIDE = (21.0, 51.0)
"""Usual streets with sidewalks are faster than the first and no faster than the second [km/h]."""

_TURNS = ("type", "restriction", "except")  # Tags of turn restrictions that netconvert uses

_SPEED = re.compile(r"\d{1,3}(\.\d+)?( ?(km/h|kmh|mph|knots))?")


def street_file(
    data: OsmData,  # The content of the user's file
    bounds: Bounds,  # The area; streets are cut at its border
    odd: Odd,  # Told of tags whose values make no sense
    left_out: Odd = lambda what: None,  # Told of each street that is not in the file
    *,
    left_hand: bool = False,  # Whether traffic keeps left
    meridian: float = 0.0,  # From where longitudes count, as netconvert's end at 180 [degrees]
) -> bytes:
    """Return the streets for cars within an area, with signals and turn restrictions."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', '<osm version="0.6">']
    pieces: list[tuple[int, tuple[int, ...], Tags]] = []
    cutter = _Cutter(data, bounds)
    for way in data.ways.values():
        if is_street(way.tags):
            tags, count = _clean(way.tags, odd, left_hand=left_hand), len(pieces)
            for k, nodes in enumerate(cutter.inside(way)):
                # The first piece keeps the number, so that restrictions still name it.
                pieces.append((way.id if k == 0 else -way.id - k, nodes, tags))
            if len(pieces) == count:
                left_out("streets beyond the area")
    together = _together([nodes for _, nodes, _ in pieces], cutter.places)
    for _ in range(together.count(False)):
        left_out("short streets without a way to others")
    pieces = [piece for piece, kept in zip(pieces, together, strict=True) if kept]
    used = dict.fromkeys(node for _, nodes, _ in pieces for node in nodes)
    for node in used:
        east, north = cutter.places[node]
        said = data.nodes.get(node, {})
        tags = {"highway": said["highway"]} if _is_signal(said) else {}
        place = f'lat="{north:.7f}" lon="{east - meridian:.7f}"'
        lines.append(f'<node id="{node}" {place}>{_xml(tags)}</node>')
    for name, nodes, tags in pieces:
        refs = "".join(f'<nd ref="{node}"/>' for node in nodes)
        lines.append(f'<way id="{name}">{refs}{_xml(tags)}</way>')
    lines += _restrictions(data, {name for name, _, _ in pieces}, used)
    return "\n".join([*lines, "</osm>", ""]).encode()


def is_street(tags: Tags) -> bool:
    """Return whether a way is a street for cars."""
    kind = tags.get("highway", "")
    if not _DRIVEN.fullmatch(kind) or tags.get("area") == "yes":
        return False
    return not (kind == "service" and tags.get("service") in _NO_STREETS)


def _is_signal(tags: Tags) -> bool:
    return tags.get("highway") == "traffic_signals"


_MIRRORED = {"left": "right", "right": "left", "sidewalk:left": "sidewalk:right",
             "sidewalk:right": "sidewalk:left"}  # fmt: skip


def _clean(tags: Tags, odd: Odd, *, left_hand: bool) -> Tags:
    """Return the tags that netconvert uses, without values that it would stumble over."""
    kept = {key: tags[key] for key in _KEPT if key in tags}
    for key in ("lanes", "lanes:forward", "lanes:backward"):
        if key in kept:
            count = number(kept, key, (1, 12), odd)
            if count is None:
                del kept[key]
            else:
                kept[key] = str(int(count))
    speed = kept.get("maxspeed")
    if speed is not None and not _SPEED.fullmatch(speed):
        if speed not in ("none", "walk", "signals", "variable") and ":" not in speed:
            odd("maxspeed")
        del kept["maxspeed"]
    kept.pop("width", None)
    for key in [key for key in kept if key.startswith("sidewalk")]:
        # One that is mapped by itself is made beside its street, like the others.
        kept[key] = {"separate": "yes"}.get(kept[key], kept[key])
    if not any(key.startswith("sidewalk") for key in kept) and _has_usual_sidewalk(kept):
        one_way = kept.get("oneway", "no") != "no" or kept.get("junction") == "roundabout"
        kept["sidewalk"] = "right" if one_way else "both"
    elif left_hand:  # netconvert means the sides of the road as where traffic keeps right
        kept = {_MIRRORED.get(key, key): text for key, text in kept.items()}
        if "sidewalk" in kept:
            kept["sidewalk"] = _MIRRORED.get(kept["sidewalk"], kept["sidewalk"])
    return kept


def _has_usual_sidewalk(tags: Tags) -> bool:
    """Return whether streets of a kind and speed usually have sidewalks."""
    if tags["highway"] in _NOT_WALKED:
        return False
    speed = re.match(r"(\d+(?:\.\d+)?)(?: ?(\w+))?", tags.get("maxspeed", "50"))
    assert speed is not None  # as other values are left out
    unit = {"mph": 1.609, "knots": 1.852}.get(speed[2] or "", 1.0)
    return _WALKED_BESIDE[0] < float(speed[1]) * unit <= _WALKED_BESIDE[1]


_STUB = 2.0  # Shorter pieces from the last node within the area to its border are left out [m]
_DEGREE = 111_000.0  # Of latitude [m]


class _Cutter:
    """Cuts ways at the border of an area.

    Attributes:
        places: Longitude and latitude of all nodes, those on the border, too [degrees].
    """

    def __init__(self, data: OsmData, bounds: Bounds) -> None:
        self.places = dict(data.places)
        self._bounds = bounds
        self._next = max(data.places, default=0) + 1

    def inside(self, way: Way) -> Iterator[tuple[int, ...]]:
        """Yield the parts of a way within the area, each of two nodes or more."""
        piece: list[int] = []
        for start, end in pairwise((*way.nodes, None)):
            part = self._part(start, end)
            if part is not None:
                first, last, whole = part
                piece = piece or [first]
                piece += [last] if last != piece[-1] else []
                if whole:
                    continue
            if len(piece) >= 2:
                yield tuple(piece)
            piece = []

    def _part(self, start: int | None, end: int | None) -> tuple[int, int, bool] | None:
        """Return the ends of what is inside of a segment, and whether its end is (Liang-Barsky)."""
        here, there = (self.places.get(node) if node is not None else None for node in (start, end))
        if start is None or end is None or here is None or there is None:
            return None
        low, high = 0.0, 1.0
        for axis in (0, 1):
            step = there[axis] - here[axis]
            ends = [self._bounds[axis] - here[axis], self._bounds[axis + 2] - here[axis]]
            if step == 0.0:
                if not ends[0] <= 0.0 <= ends[1]:
                    return None
                continue
            near, far = sorted(each / step for each in ends)
            low, high = max(low, near), min(high, far)
        if low >= high:
            return None
        if (high - low) * _distance(here, there) < _STUB and (low, high) != (0.0, 1.0):
            return None
        first = start if low == 0.0 else self._node(here, there, low)
        last = end if high == 1.0 else self._node(here, there, high)
        return first, last, high == 1.0

    def _node(self, here: tuple[float, float], there: tuple[float, float], share: float) -> int:
        x, y = (a + share * (b - a) for a, b in zip(here, there, strict=True))
        self.places[self._next] = x, y
        self._next += 1
        return self._next - 1


_LEAST = 80.0  # Streets that hang together with no others are left out if shorter [m]


def _together(
    pieces: Sequence[Sequence[int]], places: Mapping[int, tuple[float, float]]
) -> list[bool]:
    """Return whether each piece hangs together with streets of some length."""
    root: dict[int, int] = {}

    def find(node: int) -> int:
        while root.setdefault(node, node) != node:
            root[node] = root[root[node]]
            node = root[node]
        return node

    for nodes in pieces:
        for node in nodes[1:]:
            root[find(node)] = find(nodes[0])
    length = Counter[int]()
    for nodes in pieces:
        long = sum(_distance(places[a], places[b]) for a, b in pairwise(nodes))
        length[find(nodes[0])] += round(long)
    most = max(length.values(), default=0)
    return [length[find(nodes[0])] >= min(_LEAST, most) for nodes in pieces]


def _distance(here: tuple[float, float], there: tuple[float, float]) -> float:
    """Return about how far two places are from each other [m]."""
    east = (there[0] - here[0]) * float(exact.cos(np.radians(here[1])))
    return _DEGREE * float(exact.hypot(there[1] - here[1], east))


def _restrictions(data: OsmData, ways: set[int], nodes: dict[int, None]) -> Iterator[str]:
    for relation in data.relations:
        kinds = {"way": ways, "node": nodes}
        known = all(ref in kinds.get(kind, ()) for kind, ref, _ in relation.members)
        if relation.tags.get("type") == "restriction" and known:
            members = "".join(
                f'<member type="{kind}" ref="{ref}" role={quoteattr(role)}/>'
                for kind, ref, role in relation.members
            )
            tags = {key: text for key, text in relation.tags.items() if key in _TURNS}
            yield f'<relation id="{relation.id}">{members}{_xml(tags)}</relation>'


def _xml(tags: Tags) -> str:
    return "".join(f"<tag k={quoteattr(k)} v={quoteattr(v)}/>" for k, v in tags.items())


_TYPES = ("osmNetconvert.typ.xml", "osmNetconvertUrbanDe.typ.xml")
"""Lanes, speeds and users of each kind of road, in the folder `data/typemap` of SUMO."""

OPTIONS = {
    "--offset.disable-normalization": "true",
    # Streets for cars, with sidewalks as tagged.
    "--keep-edges.by-vclass": "passenger",
    "--osm.sidewalks": "true",
    "--walkingareas": "true",
    # Crossings, with lights for those on foot, only where there are traffic lights.
    "--crossings.guess": "true",
    "--crossings.guess.speed-threshold": "0",
    # Bends are not junctions, and what is one crossing for drivers is one junction.
    "--geometry.remove": "true",
    "--junctions.join": "true",
    "--max-join-ids": "3",
    "--roundabouts.guess": "true",
    "--tls.guess-signals": "true",
    "--tls.discard-simple": "true",
    "--tls.join": "true",
    # SUMO's 20 m join all lights of an interchange into one program, with a red of five minutes.
    "--tls.join-dist": "8",
    # As for the maps of recipes, see `eyas.engine.traffic.network`.
    "--junctions.corner-detail": "8",
    "--junctions.internal-link-detail": "20",
    "--junctions.limit-turn-speed": "5.5",
    "--no-turnarounds.except-deadend": "true",
    "--output.street-names": "false",
    "--precision": "3",
}
"""netconvert's options, except its files and the projection."""


def osm_network(streets: bytes, projection: str, source: str, *, left_hand: bool = False) -> bytes:
    """Return SUMO's network of streets.

    Args:
        streets: The streets as an OpenStreetMap file (XML).
        source: Name of the user's file, for the message.
        left_hand: Whether traffic keeps left.

    Raises:
        MissingExtraError: SUMO is not installed.
        DataFileError: netconvert makes no network of these streets.
    """
    program, environment = sumo_binary("netconvert"), sumo_environment()
    folder_of_types = Path(environment["SUMO_HOME"]) / "data" / "typemap"
    types = ",".join(str(folder_of_types / name) for name in _TYPES)
    with scratch() as folder:
        given, out = folder / "streets.osm", folder / "net.xml"
        given.write_bytes(streets)
        files = ["--osm-files", str(given), "--type-files", types, "-o", str(out)]
        files += ["--lefthand", "true"] if left_hand else []
        done = subprocess.run(
            [str(program), *files, "--proj", projection, *chain.from_iterable(OPTIONS.items())],
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        if done.returncode != 0 or not out.is_file():
            said = [line for line in done.stderr.splitlines() if line.startswith("Error")]
            reason = (said or ["it ended without a message"])[0].removeprefix("Error: ")
            raise DataFileError(f"{source}: netconvert makes no road network of it: {reason}")
        return without_comments(out.read_bytes())
