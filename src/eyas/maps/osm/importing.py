"""The import of a map of OpenStreetMap, step by step; each step is made of those before it.

    file                                  `maps/osm/reader.py`
    -> place on earth, area               `maps/osm/projection.py`
    -> streets, through netconvert        `maps/osm/streets.py`, `maps/osm/network.py`
    -> survey: all that is known beside   `maps/osm/houses.py`, `land.py`
    -> plan -> folder                     `maps/plan/file.py`
    -> traffic                            `engine/traffic/library.py`

When the map is first used, `maps/towns` completes its plan, and `maps/plan/build.py` makes the
scene of it, as of any other plan.
"""

import gzip
import json
import re
import shlex
import shutil
import time
from collections import Counter
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from rich.console import Console

from eyas.engine.core.errors import ConfigError, DataFileError, EyasError, OutputError
from eyas.engine.core.files import flushed, refusals, sum_of, write_atomic
from eyas.engine.core.rng import stream
from eyas.engine.envs.registration import register_map
from eyas.engine.state.roads import RoadGraph, RoadNetwork
from eyas.engine.terminal.counts import many
from eyas.engine.terminal.progress import sumo_progress
from eyas.engine.traffic.library import record_canonical
from eyas.engine.traffic.net_file import (
    SumoNet,
    crossing_lines,
    pavement_area,
    road_network,
    signalled_edges,
)
from eyas.engine.traffic.network import graph_hash
from eyas.engine.traffic.recording_file import RecordingFile
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import ATTRIBUTION_FILE, NETWORK_FILE, PLAN_FILE, TRAFFIC_FILE
from eyas.engine.world.projection import Projection
from eyas.engine.world.roads.areas import polygons_of
from eyas.engine.world.roads.network_file import save_network
from eyas.lanes import exact
from eyas.maps.files import MAP_FILE, ROADS_FILE, Origin, maps_folder
from eyas.maps.osm.driving_side import tagged_side, usual_side
from eyas.maps.osm.features import Survey
from eyas.maps.osm.houses import buildings_beyond, houses_of
from eyas.maps.osm.land import add_land
from eyas.maps.osm.paint_colours import usual_paint
from eyas.maps.osm.parking import add_parking
from eyas.maps.osm.reader import Bounds, OsmData, covered, no_streets, read_osm
from eyas.maps.osm.rings import OsmShapes
from eyas.maps.osm.streets import is_street, osm_network, street_file
from eyas.maps.plan.file import write_plan
from eyas.maps.plan.plan import MapPlan, Roads
from eyas.maps.traffic.about import coverage


@dataclass(slots=True)
class Report:
    """What an import has found and guessed."""

    name: str
    folder: Path
    registered: bool  # Whether it is known by its name; otherwise by its folder
    size: tuple[float, float] = (0.0, 0.0)  # Extent of the floor [m]
    lanes: int = 0
    signals: int = 0  # Programs of traffic lights
    buildings: int = 0
    trees: int = 0
    guessed: Counter[str] = field(default_factory=Counter)
    """Number of things without a tag, by what had to be guessed."""
    odd: Counter[str] = field(default_factory=Counter)
    """Number of values that made no sense, by tag."""
    broken: Counter[str] = field(default_factory=Counter)
    """Number of outlines that were mended or left out, by what was wrong."""
    left_out: Counter[str] = field(default_factory=Counter)
    """Number of things that are not on the map, by what and why."""
    side: str = ""  # The side of the road on which one drives, and how that is known
    traffic: str = ""  # What was recorded, or why nothing was
    notices: tuple[str, ...] = ("© OpenStreetMap contributors",)
    seconds: float = 0.0

    @property
    def known_as(self) -> str:
        """What commands and settings call the map."""
        return self.name if self.registered else str(self.folder)

    def lines(self) -> list[str]:
        """Return the report for people."""
        width, height = self.size
        made = [
            f"{self.name}: {width:.0f} x {height:.0f} m, {many(self.lanes, 'lane')}, "
            f"{many(self.signals, 'traffic light')}, {many(self.buildings, 'building')}, "
            f"{many(self.trees, 'tree')}, in {self.seconds:.0f} s",
            f"kept in {self.folder}; use it with --map {shlex.quote(self.known_as)}",
        ]
        for word, counted in (("guessed", self.guessed), ("odd tags", self.odd),
                              ("mended or left out", self.broken),
                              ("left out", self.left_out)):  # fmt: skip
            if counted:
                parts = ", ".join(
                    f"{count} {_ONE.get(what, what) if count == 1 else what}"
                    for what, count in sorted(counted.items())
                )
                made.append(f"{word}: {parts}")
        return [*made, self.side, self.traffic, *self.notices]


_ONE = {
    "heights": "height",
    "roofs": "roof",
    "heights of trees": "height of a tree",
    "buildings beyond the area": "building beyond the area",
    "streets beyond the area": "street beyond the area",
    "short streets without a way to others": "short street without a way to others",
}
"""Words of a report for a single thing."""

ATTRIBUTION = """\
© OpenStreetMap contributors

This map is made of data of OpenStreetMap, which is available under the Open Database License
(ODbL) 1.0: https://www.openstreetmap.org/copyright
Pictures, films and data sets made from it must show this notice; a data base made from it must be
offered under the same licence.
"""

LARGEST = 8000.0  # Longest side of a map [m]
_SEAM = 179.0  # Longitude beyond which an area may lie across the date line [degrees]
_SMALLEST = 40.0
_MARGIN = 30.0  # Floor beyond the imported area [m]


def run(
    path: Path,
    name: str | None,
    *,
    out: Path | None = None,
    bounds: Bounds | None = None,
    drive_on: str | None = None,
    record: bool = True,
    parked: bool = True,
    overwrite: bool = False,
) -> Report:
    """Import a file of OpenStreetMap.

    Args:
        path: The file: `.osm`, `.osm.gz`, `.osm.bz2` or `.osm.pbf`.
        name: Name of the map; None: the file's.
        out: Folder of the map; None: below the user's folder of maps.
        bounds: Area to import, in degrees; None: all that the file covers.
        drive_on: `left` or `right`; None: as the file says, or else as usual at the place.
        record: Whether the traffic is recorded now; otherwise on first use.
        parked: Whether cars park along the kerbs.
        overwrite: Whether a map of that name is replaced.

    Raises:
        EyasError: The file is damaged, or the map cannot be made or written.
    """
    begun = time.monotonic()
    name = name_of(name if name is not None else re.sub(r"\.osm(\.\w+)?$|\.pbf$", "", path.name))
    folder = (out if out is not None else maps_folder() / name).absolute()
    check_free(folder, name, overwrite=overwrite, own=out is None)
    report = Report(name, folder, registered=out is None)
    data = read_osm(path)
    place = _place(data, bounds, str(path))
    streets = _streets(data, place, _side(data, place, drive_on, report), report)
    survey = survey_of(data, place, streets, report, parked=parked)
    origin = Origin(
        name, f"Imported from OpenStreetMap: {path.name}", path.name,
        round((place.projection.longitude + 180.0) % 360.0 - 180.0, 7),
        place.projection.latitude, place.size,
    )  # fmt: skip
    write_map(folder, streets, _plan(origin, survey), origin)
    if out is None:
        register_map(name)
    report.traffic = recorded(streets, folder, record=record)
    report.seconds = time.monotonic() - begun
    return report


def name_of(text: str) -> str:
    """Return a name that a map can have."""
    name = re.sub(r"\W+", "-", text).strip("-")
    if not name:
        raise ConfigError(f"--name: {text!r} is not allowed; allowed: words joined by hyphens")
    return name


def check_free(folder: Path, name: str, *, overwrite: bool, own: bool) -> None:
    """Refuse a folder that holds something else, or a map that is not to be replaced.

    Args:
        own: Whether the folder is that of the name.

    Raises:
        EyasError: It is refused.
    """
    if own and name in MAPS.built_in:
        raise ConfigError(f"--name: {name!r} is a map of Eyas; choose another name")
    if not folder.exists():
        return
    if not (folder / MAP_FILE).is_file() and (not folder.is_dir() or any(folder.iterdir())):
        raise OutputError(f"{folder}: is there already, and no imported map; choose another place")
    if not overwrite and (folder / MAP_FILE).is_file():
        raise OutputError(f"{folder}: is there already; replace it with --overwrite")


class Place(NamedTuple):
    """Position of the map on earth."""

    source: str  # name of the file, for messages
    limits: Bounds  # [degrees]
    meridian: float  # From where netconvert counts longitudes [degrees]
    projection: Projection
    extent: shapely.Polygon  # the imported area [m]
    size: tuple[float, float]  # of the floor [m]


def _place(data: OsmData, bounds: Bounds | None, source: str) -> Place:
    """Return the area to import, in degrees and in metres around its middle."""
    west, south, east, north = limits = covered(data, bounds, source)
    middle = round((west + east) / 2, 7)
    projection = Projection(middle, round((south + north) / 2, 7))
    corners = projection.metres([(west, south), (east, south), (east, north), (west, north)])
    width, height = np.ptp(corners, axis=0)
    if max(width, height) > LARGEST:
        raise DataFileError(
            f"{source}: covers {width / 1000:.1f} x {height / 1000:.1f} km; at most "
            f"{LARGEST / 1000:g} km are imported: name a part with --bbox WEST,SOUTH,EAST,NORTH, "
            f"for example its middle: --bbox {middle_of(data, limits)}"
        )
    if min(width, height) < _SMALLEST:
        raise DataFileError(
            f"{source}: covers {width:.0f} x {height:.0f} m, too little for a map; allowed: "
            f"at least {_SMALLEST:g} m"
        )
    extent = shapely.Polygon(corners)
    x, y = np.abs(shapely.get_coordinates(extent)).max(axis=0)
    size = 2 * float(np.ceil(x + _MARGIN)), 2 * float(np.ceil(y + _MARGIN))
    meridian = middle if max(-west, east) > _SEAM else 0.0
    return Place(source, limits, meridian, projection, extent, size)


def middle_of(data: OsmData, limits: Bounds) -> str:
    """Return a part of a large area as `--bbox` takes it, in the middle of its streets."""
    nodes = [node for way in data.ways.values() if is_street(way.tags) for node in way.nodes]
    places = np.array([data.places[node] for node in nodes if node in data.places] or [limits[:2]])
    west, south, east, north = limits
    inside = ((places >= (west, south)) & (places <= (east, north))).all(axis=1)
    x, y = (
        np.median(places[inside], axis=0)
        if inside.any()
        else (0.5 * (west + east), 0.5 * (south + north))
    )
    dy = 0.3 * LARGEST / 111_000.0
    dx = dy / float(exact.cos(np.radians(y)))
    x = (x + 180.0) % 360.0 - 180.0
    return ",".join(f"{each:.4f}" for each in (x - dx, y - dy, x + dx, y + dy))


def _side(data: OsmData, place: Place, asked: str | None, report: Report) -> str:
    """Return the side of the road on which one drives."""
    tagged, usual = (
        tagged_side(data),
        usual_side(place.projection.longitude, place.projection.latitude),
    )
    side = asked or tagged or usual
    why = "--drive-on" if asked else "the file's driving_side" if tagged else "the place"
    report.side = f"traffic keeps {side} ({why}); --drive-on changes it"
    return side


class Streets(NamedTuple):
    """The streets, as netconvert has made them."""

    graph: RoadGraph  # holds the bytes of SUMO's file
    net: SumoNet
    network: RoadNetwork


def _streets(data: OsmData, place: Place, side: str, report: Report) -> Streets:
    """Return the streets for cars within the area."""
    left_hand = side == "left"
    cut = street_file(
        data,
        place.limits,
        lambda key: report.odd.update([key]),
        lambda what: report.left_out.update([what]),
        left_hand=left_hand,
        meridian=place.meridian,
    )
    if b"<way " not in cut:
        raise no_streets(data, place.source)
    projection = replace(
        place.projection, longitude=round(place.projection.longitude - place.meridian, 7)
    )
    finished = osm_network(cut, projection.text, place.source, left_hand=left_hand)
    graph, net = RoadGraph(report.name, 0, (), (), finished), SumoNet(finished)
    network = road_network(net, graph_hash(graph))
    report.size, report.lanes, report.signals = (
        place.size, len(network.lane_width), len(net.programs),
    )  # fmt: skip
    return Streets(graph, net, network)


def survey_of(
    data: OsmData, place: Place, streets: Streets, report: Report, *, parked: bool = True
) -> Survey:
    """Return everything but the streets, and count in the report what is guessed or left out.

    `parked`: whether cars park along the kerbs.
    """

    def odd(key: str) -> None:
        report.odd[key] += 1

    shapes = OsmShapes(
        data, place.projection, place.extent, lambda what: report.broken.update([what])
    )
    crossings, middles = usual_paint(place.projection.longitude, place.projection.latitude)
    survey = Survey(houses=houses_of(shapes, odd), crossing_paint=crossings, middle_paint=middles)
    report.left_out["buildings beyond the area"] += buildings_beyond(data, place.limits)
    report.left_out += Counter()  # drops what there was none of
    add_land(survey, shapes, odd, stream(0, "imported tree rows"))
    if parked:
        add_parking(survey, shapes, streets.network)
    # Without the lines in which sidewalks of bridges meet others.
    pavement = snapped(pavement_area(streets.net))
    survey.pavement = shapely.MultiPolygon(polygons_of(pavement))
    survey.signals = signalled_edges(streets.net)
    survey.lit_crossings = {
        name: shapely.LineString(line) for name, line in crossing_lines(streets.net).items()
    }
    report.buildings, report.trees = len(survey.houses), len(survey.trees)
    for house in survey.houses:
        report.guessed["heights"] += house.height is None and house.levels is None
        report.guessed["roofs"] += not house.roof
    report.guessed["heights of trees"] += sum(not tall for _, _, tall in survey.trees)
    report.guessed += Counter()  # drops what was never guessed
    return survey


def _plan(origin: Origin, survey: Survey) -> MapPlan:
    """Return the plan, which says only what is known."""
    return MapPlan(
        name=origin.name,
        title=origin.title,
        attribution=ATTRIBUTION,
        size=origin.size,
        roads=Roads(file=ROADS_FILE),
        survey=survey,
    )


def write_map(
    folder: Path, streets: Streets, plan: MapPlan, origin: Origin, attribution: str = ATTRIBUTION
) -> None:
    """Write the map, in the place of what the folder holds."""
    with refusals(folder):
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir(parents=True)
    write_atomic(folder / ROADS_FILE, gzip.compress(streets.graph.finished, mtime=0))
    save_network(folder / NETWORK_FILE, streets.network)
    write_plan(folder / PLAN_FILE, plan)
    write_atomic(folder / ATTRIBUTION_FILE, attribution.encode())
    kept = (ROADS_FILE, NETWORK_FILE, PLAN_FILE, ATTRIBUTION_FILE)
    flushed(folder / name for name in kept)
    origin = replace(origin, checksums={name: sum_of(folder / name) for name in kept})
    # Last, since a folder with this file is a map.
    write_atomic(folder / MAP_FILE, (json.dumps(asdict(origin), indent=1) + "\n").encode())
    MAPS.forget()


def recorded(streets: Streets, folder: Path, *, record: bool) -> str:
    """Record the canonical traffic; return a sentence about it."""
    if not record:
        return "traffic: recorded on first use"
    try:
        with sumo_progress() as progress:
            record_canonical(streets.graph, folder / TRAFFIC_FILE, progress=progress)
        return coverage(RecordingFile.read(folder / TRAFFIC_FILE).load(), streets.network)
    except EyasError as error:
        Console(stderr=True).print(f"no traffic recorded: {error}", markup=False, soft_wrap=True)
        return "traffic: none recorded; targets that walk need none: --set target=Pedestrian"
