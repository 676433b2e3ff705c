"""Plan shapes of roads: streets and their lines, asphalt, blocks, cutting along the grid."""

import numpy as np
import pytest
import shapely

from eyas.engine.state.mesh import Material
from eyas.engine.world.build.materials import material
from eyas.engine.world.roads.areas import (
    blocks,
    joints,
    kerbstones,
    road_area,
    skirt,
    split_on_grid,
    streets,
    surface,
)


def test_a_street_is_two_lanes_wide_and_shares_its_middle_with_the_other_direction(network):
    every = {(street.start, street.end): street for street in streets(network)}
    for (start, end), street in every.items():
        width = shapely.distance(shapely.LineString(street.left), shapely.LineString(street.right))
        assert width == pytest.approx(7.0, abs=0.05)
        assert len(street.dividers) == 1
        other = every[end, start]
        assert np.allclose(street.left, other.left[::-1], atol=0.05)


def test_traffic_drives_on_the_right(network):
    for street in streets(network):
        onwards = street.left[-1] - street.left[0]
        aside = street.right[0] - street.left[0]
        assert onwards[0] * aside[1] - onwards[1] * aside[0] < 0


def test_asphalt_is_one_piece_under_every_lane(network):
    area = road_area(network)
    assert len(area.geoms) == 1
    assert shapely.covers(area.buffer(0.06), shapely.MultiPoint(network.lane_points))


def test_blocks_and_asphalt_share_the_floor_out(network):
    extent = shapely.box(-450, -450, 450, 450)
    closed, outside = blocks(road_area(network), extent)
    assert len(closed) == 9
    whole = road_area(network).area + sum(part.area for part in closed + outside)
    assert whole == pytest.approx(extent.area, rel=1e-9)


def test_joints_count_the_roads_that_meet(network):
    assert sorted(joints(network).values()) == [2] * 14 + [3] * 4 + [4] * 6


def test_cutting_along_the_grid_loses_nothing_and_keeps_to_the_squares():
    ring = shapely.Point(7, -11).buffer(90) - shapely.Point(0, 0).buffer(40)
    parts = split_on_grid(ring, 32.0)
    assert sum(part.area for part in parts) == pytest.approx(ring.area, rel=1e-9)
    for part in parts:
        low, high = np.array(part.bounds[:2]), np.array(part.bounds[2:])
        assert np.all(np.floor(low / 32 + 1e-9) == np.ceil(high / 32 - 1e-9) - 1)


def test_a_surface_faces_up_and_covers_the_shape():
    mesh = surface(shapely.box(-50, -3, 47, 20), 1.5, Material(), 2.0)
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(normal[:, 2] > 0)
    assert normal[:, 2].sum() / 2 == pytest.approx(97 * 23)
    assert np.all(mesh.positions[:, 2] == 1.5)


def test_a_skirt_faces_outwards_on_outlines_and_into_holes():
    shape = shapely.box(0, 0, 10, 10) - shapely.box(4, 4, 6, 6)
    mesh = skirt(shape, -1.0, 0.0, Material(), 1.0)
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = corners.mean(1)[:, :2] + 1e-3 * np.sign(normal[:, :2])
    assert not shapely.contains_xy(shape, *middle.T).any()
    assert np.linalg.norm(normal, axis=1).sum() / 2 == pytest.approx(40 + 8)


def test_joints_of_kerb_stones_run_across_the_kerb():
    road = shapely.Point(3.0, -2.0).buffer(10.0, quad_segs=32)
    kerb = shapely.difference(shapely.buffer(road, 0.35, quad_segs=32), road)
    mesh = kerbstones(kerb, 0.15, road, material("stone"), 4.0)
    corners = mesh.positions[mesh.triangles][..., :2].astype(float) - (3.0, -2.0)
    u, v = np.moveaxis(4.0 * mesh.uvs[mesh.triangles].astype(float), -1, 0)
    assert np.abs(v - (np.hypot(*np.moveaxis(corners, -1, 0)) - 10.0)).max() < 0.02
    # From corner to corner u grows by the way along the road, whatever the distance from it.
    angle = np.unwrap(np.arctan2(corners[..., 1], corners[..., 0]), axis=1)
    way = np.abs(angle[:, 1:] - angle[:, :1]) * 10.0
    assert np.abs(np.abs(u[:, 1:] - u[:, :1]) - way).max() < 0.15
    assert np.ptp(u) > 60.0
