"""Road paint: where it lies, how much of it there is, and that it is where traffic expects it."""

import numpy as np
import pytest
import shapely
from shapely.ops import substring

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.roads.areas import joints, road_area, streets
from eyas.maps.roads.markings import road_paint
from eyas.maps.roads.painting import PAINT_HEIGHT, mesh_of, stripes
from eyas.maps.towns.crossings import town_paint


@pytest.fixture(scope="module")
def paint(network):
    return road_paint(network)


def white_areas(paint):
    return [line.area for line in paint.lines] + paint.arrows


def test_every_arm_of_every_junction_has_a_crossing_of_the_originals_size(network, paint):
    meeting = joints(network)
    assert len(paint.zebras) == sum(roads for roads in meeting.values() if roads > 2) == 36
    for bars in paint.zebras:
        box = shapely.minimum_rotated_rectangle(shapely.MultiPolygon([bar.area for bar in bars]))
        ring = shapely.get_coordinates(box)
        sides = sorted(np.linalg.norm(np.diff(ring, axis=0), axis=1)[:2])
        assert sides[0] == pytest.approx(5.6, abs=0.01)
        assert 12.0 < sides[1] < 14.0


def test_paint_is_on_asphalt(network, paint):
    road = road_area(network).buffer(0.02)
    shapely.prepare(road)
    assert all(shapely.covers(road, shape) for shape in white_areas(paint))
    assert all(shapely.covers(road, bar.area) for bars in paint.zebras for bar in bars)


def test_crossings_do_not_overlap(paint):
    every = [shapely.MultiPolygon([bar.area for bar in bars]) for bars in paint.zebras]
    assert shapely.union_all(every).area == pytest.approx(sum(z.area for z in every))


def test_lane_lines_do_not_lie_where_wheels_roll(network, paint):
    """The middles of all lanes, but for arrows and stop lines near their ends, are bare."""
    white = shapely.union_all(white_areas(paint))
    for lane in range(len(network.lane_width)):
        points = network.lane_points[network.lane_first[lane] : network.lane_first[lane + 1]]
        line = shapely.LineString(points)
        if line.length > 40:
            middle = shapely.line_interpolate_point(line, [0.3, 0.5], normalized=True)
            assert not shapely.intersects(white, middle).any()


def test_the_middle_of_a_road_is_painted_through_and_between_lanes_there_are_dashes(network, paint):
    white = shapely.union_all(white_areas(paint))
    shapely.prepare(white)
    shares = []
    for street in streets(network):
        # Near bends the arc of the line leaves that of the lanes, which have a corner there.
        whole = shapely.LineString(street.left)
        middle = substring(whole, 9.0, whole.length - 9.0)
        shares.append(shapely.LineString(street.dividers[0]).intersection(white).length)
        assert middle.intersection(white).length == pytest.approx(middle.length, rel=0.02)
    whole = sum(shapely.LineString(street.dividers[0]).length for street in streets(network))
    assert sum(shares) / whole == pytest.approx(1 / 3, abs=0.05)


def test_lines_go_round_bends_without_corners(paint):
    """No piece of a line turns by more than an arc's chord does."""
    long = [shape for shape in white_areas(paint) if shape.area > 20.0]
    assert len(long) > 20
    for shape in long:
        ring = shapely.get_coordinates(shapely.simplify(shape, 1e-4).exterior)
        steps = np.diff(ring, axis=0)
        bearing = np.degrees(np.arctan2(steps[:, 1], steps[:, 0]))
        turn = np.roll(bearing, -1) - bearing
        turn = np.abs((turn + 180) % 360 - 180)
        assert np.sum(turn > 10.0) == 4  # those of both ends


def test_dashes_are_spread_evenly_over_a_line():
    line = np.array([[0.0, 0.0], [100.0, 0.0]])
    dashes = [dash.area for dash in stripes(line, 0.2, (3.0, 6.0))]
    assert len(dashes) == 11
    assert [dash.bounds[2] - dash.bounds[0] for dash in dashes] == pytest.approx([3.0] * 11)
    assert dashes[0].bounds[0] == pytest.approx(100.0 - dashes[-1].bounds[2])


def test_paint_lies_just_above_the_road(paint):
    mesh = mesh_of(paint)
    assert np.allclose(mesh.positions[:, 2], PAINT_HEIGHT)
    assert {material.tint[2] < 0.3 for material in mesh.palette} == {True, False}


def roads_of(*edges):
    """Return a network of edges: names of both nodes, positions of both [m], number of lanes."""
    lanes = []
    for index, (_, ends, count) in enumerate(edges):
        start, end = np.array(ends, np.float64)
        along = (end - start) / np.linalg.norm(end - start)
        right = np.array([along[1], -along[0]])
        lanes += [
            (index, lane, np.stack([start, end]) + 3.5 * (count - lane - 0.5) * right)
            for lane in range(count)
        ]
    nodes = sorted({name for names, _, _ in edges for name in names})
    return RoadNetwork(
        graph_hash="", builder="",
        lane_points=np.concatenate([line for _, _, line in lanes]),
        lane_first=2 * np.arange(len(lanes) + 1, dtype=np.int32),
        lane_width=np.full(len(lanes), 3.5), lane_speed=np.full(len(lanes), 13.9),
        lane_edge=np.array([edge for edge, _, _ in lanes], np.int32),
        lane_index=np.array([lane for _, lane, _ in lanes], np.int32),
        edges=tuple(f"e{k}" for k in range(len(edges))),
        edge_start=tuple(names[0] for names, _, _ in edges),
        edge_end=tuple(names[1] for names, _, _ in edges),
        junction_points=np.zeros((0, 2)),
        junction_first=np.zeros(len(nodes) + 1, np.int32), junctions=tuple(nodes),
    )  # fmt: skip


A, B, C, D = (0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)


@pytest.mark.parametrize(
    ("edges", "lines"),
    [
        # Two edge lines for each one-way street, joined where one leads on to the other.
        ([("ab", (A, B), 1), ("bc", (B, C), 1)], 2),
        ([("ab", (A, B), 1), ("cb", (C, B), 1)], 4),
        ([("ba", (B, A), 1), ("bc", (B, C), 1)], 4),
        # Where lanes begin or end: two edge lines each, and the dashes of the wider street.
        ([("ab", (A, B), 2), ("bc", (B, C), 1)], 4 + 11),
        # A ring without a junction.
        ([("ab", (A, B), 1), ("bc", (B, C), 1), ("cd", (C, D), 1), ("da", (D, A), 1)], 2),
    ],
)
def test_lines_go_on_around_bends_and_end_where_the_street_changes(edges, lines):
    paint = road_paint(roads_of(*edges))
    assert len(paint.lines) == lines
    painted = shapely.union_all(white_areas(paint))
    for _, ends, _ in edges:
        assert shapely.LineString(ends).buffer(3.5).intersection(painted).area > 20.0


def test_stop_lines_of_imported_streets_lie_before_the_ends_of_their_lanes(network):
    roads, every = road_area(network), streets(network)
    unlit, _ = town_paint(network, roads, [], ())
    lit, _ = town_paint(network, roads, [], network.edges)
    known = {line.middle.tobytes() for line in unlit}
    stops = [line.middle for line in lit if line.middle.tobytes() not in known]
    assert len(stops) == len(network.edges)
    for street, stop in zip(every, stops, strict=True):
        way = shapely.LineString(street.right)
        ends = way.project(shapely.points(stop))
        assert (way.length - ends).max() == pytest.approx(0.6, abs=0.05)
        across = np.linalg.norm(stop[1] - stop[0])
        assert 2.0 < across < 7.0


def test_paint_of_imported_streets_is_white_or_yellow_as_the_country_has_it(network):
    roads = road_area(network)
    white, yellow = town_paint(network, roads, [], (), middles="white")
    assert not yellow
    rest, between = town_paint(network, roads, [], (), middles="yellow")
    assert between
    assert sorted(line.middle.tobytes() for line in [*rest, *between]) == sorted(
        line.middle.tobytes() for line in white
    )
