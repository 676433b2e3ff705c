"""What the tests of the maps with hills share."""

from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.state.terrain import reliefs
from eyas.engine.traffic.recording_file import load
from eyas.engine.world.maps.recipe import TRAFFIC_FILE
from eyas.engine.world.roads.areas import road_area


def lane_points(network, step=2.0):
    """Points along all lanes [m], and half the width of the lane at each."""
    points, halves = [], []
    for lane, (low, high) in enumerate(pairwise(network.lane_first)):
        line = shapely.segmentize(shapely.LineString(network.lane_points[low:high]), step)
        points.append(shapely.get_coordinates(line))
        halves.append(np.full(len(points[-1]), network.lane_width[lane] / 2))
    return np.concatenate(points), np.concatenate(halves)


def outline(solids, index):
    first = solids.prism_first
    return shapely.Polygon(solids.prism_points[first[index] : first[index + 1]])


def in_the_way(scene, network, height=5.0):
    """Solids lower than a truck that touch a lane."""
    points, halves = lane_points(network)
    tree = shapely.STRtree(shapely.buffer(shapely.points(points), halves))
    solids = scene.colliders
    low = np.flatnonzero(solids.prism_bottom < height)
    shapes = [outline(solids, index) for index in low]
    found = low[np.unique(tree.query(shapes, predicate="intersects")[0])].tolist()
    low = np.flatnonzero(solids.cylinder_bottom < height)
    poles = shapely.buffer(shapely.points(solids.cylinder_centre[low]), solids.cylinder_radius[low])
    return found, low[np.unique(tree.query(poles, predicate="intersects")[0])].tolist()


def relief_on_lanes(scene, network):
    """The height of the ground on the kerb side and the middle of all lanes [m]."""
    roads = shapely.get_coordinates(shapely.segmentize(road_area(network), 2.0))
    points = np.concatenate([lane_points(network)[0], roads])
    return reliefs(scene.terrain, points)


def recorded_off_road(recipe, network, reach=0.6):
    """Share of the recorded positions outside of the asphalt."""
    recording = load(recipe.shipped(TRAFFIC_FILE))
    room = shapely.buffer(road_area(network), reach)
    shapely.prepare(room)
    places = recording.position[::7][recording.present[::7]]
    return 1.0 - shapely.contains_xy(room, places[:, 0], places[:, 1]).mean()


def surface_heights(scene, points):
    """The height of the highest ground or road triangle over points [m]; NaN: none."""
    mesh = scene.static
    corners = mesh.positions[mesh.triangles].astype(float)
    tree = shapely.STRtree(shapely.polygons(corners[..., :2]))
    point, cell = tree.query(shapely.points(points), predicate="intersects")
    a, b, c = np.moveaxis(corners[cell], 1, 0)
    normal = np.cross(b - a, c - a)
    level = np.abs(normal[:, 2]) > 1e-9
    point, a, normal = point[level], a[level], normal[level]
    away = points[point] - a[:, :2]
    z = a[:, 2] - (normal[:, :2] * away).sum(axis=1) / normal[:, 2]
    highest = np.full(len(points), -np.inf)
    np.maximum.at(highest, point, z)
    return highest
