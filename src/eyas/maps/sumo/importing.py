"""The import of a network of SUMO, with its traffic: roads as they are, buildings along them."""

import time
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import shapely

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.rng import stream
from eyas.engine.envs.registration import register_map
from eyas.engine.state.roads import RoadGraph, RoadNetwork
from eyas.engine.terminal.progress import sumo_progress
from eyas.engine.traffic.net_file import (
    SumoNet,
    crossing_lines,
    pavement_area,
    road_network,
    signalled_edges,
)
from eyas.engine.traffic.network import graph_hash
from eyas.engine.traffic.recording_file import save
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.maps.recipe import TRAFFIC_FILE
from eyas.engine.world.roads.areas import corridors, polygons_of, streets
from eyas.lanes import exact
from eyas.maps.files import ROADS_FILE, Origin, maps_folder, roads_in
from eyas.maps.osm.features import House, PaintColour, Survey
from eyas.maps.osm.importing import (
    ATTRIBUTION,
    Report,
    Streets,
    check_free,
    name_of,
    recorded,
    survey_of,
    write_map,
)
from eyas.maps.osm.importing import Place as Area
from eyas.maps.osm.paint_colours import usual_paint
from eyas.maps.osm.parking import everywhere
from eyas.maps.osm.reader import read_osm
from eyas.maps.plan.plan import MapPlan, Roads
from eyas.maps.sumo.files import Place, SumoFiles, configured, demand_of, moved, place_of
from eyas.maps.sumo.traffic import record_others
from eyas.maps.traffic.about import coverage

ENDINGS = (".net.xml", ".net.xml.gz", ".sumocfg")

_LARGEST = 8000.0  # Longest side of a map, as of one of OpenStreetMap [m]
_MARGIN = 60.0  # Floor beyond the streets: a row of buildings, and some lawn [m]
_SIDEWALK = 2.0  # Width of those along streets of a network that has none [m]
_FASTEST = 17.0  # Streets with a higher limit have no buildings [m/s]
_SETBACK = 5.0  # From the kerb to the houses [m]
_FRONT, _DEEP, _GAP = (11.0, 24.0), (10.0, 14.0), (3.0, 16.0)
"""Length along the street, depth, and distance to the next, of the houses [m]."""
_CELL, _ROUND = 30.0, (-1, 0, 1)  # Side of the cells in which houses look for others [m]
_FROM_END = 12.0  # From the end of a street to its first house [m]


def is_sumo(path: Path) -> bool:
    """Return whether a file is taken for SUMO's, by its ending."""
    return path.name.lower().endswith(ENDINGS)


def run(
    path: Path,
    name: str | None,
    routes: Sequence[Path] = (),
    config: Path | None = None,
    *,
    out: Path | None = None,
    buildings: bool | Path = True,
    record: bool = True,
    parked: bool = True,
    overwrite: bool = False,
) -> Report:
    """Import a network of SUMO.

    Args:
        path: `.net.xml`, `.net.xml.gz`, or a `.sumocfg` that names one.
        name: Name of the map; None: the file's.
        routes: Files of the vehicles that drive; none: those of the configuration, or else usual
            traffic.
        config: The configuration; None: there is none beside `path`.
        out: Folder of the map; None: below the user's folder of maps.
        buildings: Whether houses are made along the streets, of which the files say nothing; or a
            file of OpenStreetMap, whose buildings, trees and grounds are those of the map.
        record: Whether usual traffic is recorded now; otherwise on first use.
        parked: Whether cars park along the kerbs: where a file of OpenStreetMap says so or it is
            usual, and without one along all slow streets.
        overwrite: Whether a map of that name is replaced.

    Raises:
        EyasError: A file is damaged, or the map cannot be made or written.
    """
    begun = time.monotonic()
    name = name_of(name if name is not None else path.name.split(".")[0])
    folder = (out if out is not None else maps_folder() / name).absolute()
    check_free(folder, name, overwrite=overwrite, own=out is None)
    named = path if path.name.endswith(".sumocfg") else config
    files = configured(named) if named is not None else SumoFiles(path)
    net_path = files.net if path == named else path
    files = files._replace(net=net_path, routes=tuple(routes) or files.routes)
    report = Report(name, folder, registered=out is None, notices=())
    demand = demand_of(files, lambda what: report.left_out.update([what])) if files.routes else b""
    xml = roads_in(net_path)
    place = place_of(xml, str(net_path))
    if max(place.size) > _LARGEST:
        raise DataFileError(
            f"{net_path}: covers {place.size[0] / 1000:.1f} x {place.size[1] / 1000:.1f} km; at "
            f"most {_LARGEST / 1000:g} km are imported: cut a part out of it with netconvert "
            "--keep-edges.in-boundary"
        )
    graph = RoadGraph(
        name, 0, (), (), moved(xml, (-place.middle[0], -place.middle[1]), str(net_path))
    )
    net = SumoNet(graph.finished, str(net_path))
    network = road_network(net, graph_hash(graph))
    made = Streets(graph, net, network)
    width, height = (2.0 * float(np.ceil(0.5 * side + _MARGIN)) for side in place.size)
    longitude = latitude = None
    if place.projection is not None:
        longitude, latitude = np.round(place.projection.degrees((0.0, 0.0))[0], 7).tolist()
    title, source = f"Imported from SUMO: {net_path.name}", net_path.name
    origin = Origin(name, title, source, longitude, latitude, (width, height))
    if isinstance(buildings, Path):
        survey = _surveyed(buildings, place, made, report, parked=parked)
    else:
        survey = _survey(made, usual_paint(longitude or 0.0, latitude or 0.0))
        survey.houses = _houses(network, survey) if buildings else []
        survey.parking = everywhere(network) if parked and survey.houses else {}
    report.size, report.lanes, report.signals = origin.size, len(network.lane_width), len(
        net.programs
    )  # fmt: skip
    report.buildings = len(survey.houses)
    report.side = f"traffic keeps {'left' if net.left_hand else 'right'}, as in the file"
    plan = MapPlan(
        name=name, title=title, size=origin.size, roads=Roads(file=ROADS_FILE), survey=survey
    )
    write_map(folder, made, plan, origin, ATTRIBUTION if isinstance(buildings, Path) else "")
    if out is None:
        register_map(name)
    if demand:
        with sumo_progress() as progress:
            recording = record_others(
                graph, demand, lambda what: report.left_out.update([what]), progress
            )
        save(recording, folder / TRAFFIC_FILE)
        report.traffic = coverage(recording, network)
    else:
        report.traffic = recorded(made, folder, record=record)
    report.seconds = time.monotonic() - begun
    return report


def _surveyed(path: Path, place: Place, made: Streets, report: Report, *, parked: bool) -> Survey:
    """Return what a file of OpenStreetMap knows of a network's place besides its streets."""
    if place.projection is None:
        raise DataFileError(
            f"{path}: the network does not say where on earth it lies, by UTM or a transverse "
            "Mercator; allowed: --buildings, which makes houses along the streets"
        )
    data = read_osm(path)
    x, y = (0.5 * side + _MARGIN for side in place.size)
    corners = place.projection.degrees([(-x, -y), (x, -y), (x, y), (-x, y)])
    (west, south), (east, north) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    near = [west < x < east and south < y < north for x, y in data.places.values()]
    if not any(near):
        raise DataFileError(
            f"{path}: of another place: the network is about latitude {0.5 * (south + north):.4f}, "
            f"longitude {0.5 * (west + east):.4f}"
        )
    area = Area(
        str(path),
        (west, south, east, north),
        0.0,
        place.projection,
        shapely.box(-x, -y, x, y),
        (2.0 * x, 2.0 * y),
    )
    report.notices = ("© OpenStreetMap contributors",)
    return survey_of(data, area, made, report, parked=parked)


def _survey(made: Streets, paint: tuple[PaintColour, PaintColour]) -> Survey:
    """Return what the network knows besides its lanes."""
    pavement = shapely.MultiPolygon(polygons_of(snapped(pavement_area(made.net))))
    return Survey(
        pavement=pavement,
        sidewalks=_SIDEWALK if pavement.is_empty else 0.0,
        signals=signalled_edges(made.net),
        crossing_paint=paint[0],
        middle_paint=paint[1],
        lit_crossings={
            name: shapely.LineString(line) for name, line in crossing_lines(made.net).items()
        },
    )


def _houses(network: RoadNetwork, survey: Survey) -> list[House]:
    """Return rows of houses along both sides of all slow streets."""
    rng = stream(0, "houses along streets")
    taken = [shapely.buffer(corridors(network), _SETBACK - 1.0), survey.pavement]
    tree = shapely.STRtree(polygons_of(taken))
    speeds = {int(edge): network.lane_speed[k] for k, edge in enumerate(network.lane_edge)}
    made: list[House] = []
    beside: dict[tuple[int, int], list[shapely.Polygon]] = defaultdict(list)  # By cells
    for edge, street in enumerate(streets(network)):
        kerb = shapely.LineString(street.right)
        if speeds[edge] > _FASTEST:
            continue
        along = _FROM_END + float(rng.uniform(*_GAP))
        while True:
            front, deep = (float(rng.uniform(*each)) for each in (_FRONT, _DEEP))
            if along + front > kerb.length - _FROM_END:
                break
            ends = shapely.get_coordinates(
                shapely.line_interpolate_point(kerb, [along, along + front])
            )
            step = ends[1] - ends[0]
            onwards = step / max(float(exact.hypot(*step)), 1e-9)
            outwards = -street.inwards(onwards)
            feet = ends + _SETBACK * outwards
            corners = np.round([*feet, *(feet + deep * outwards)[::-1]], 3)
            shape = shapely.Polygon(corners)
            free = not len(tree.query(shape, predicate="intersects"))
            here = [(int(x // _CELL), int(y // _CELL)) for x, y in corners.tolist()]
            near = [one for cell in here for one in beside[cell]]
            apart = not shapely.dwithin(near, shape, _GAP[0] - 0.5).any() if near else True
            if shape.is_valid and free and apart:
                made.append(House(shape, "house" if front < 16.0 else "apartments"))
                for x, y in {(x + i, y + j) for x, y in here for i in _ROUND for j in _ROUND}:
                    beside[x, y].append(shape)
            along += front + float(rng.uniform(*_GAP))
    return made
