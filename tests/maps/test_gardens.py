"""Points that are scattered within shapes: how far apart they are, and how long it takes."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from eyas.maps.plants.gardens import paved_yards, scattered

YARD = shapely.box(-40.0, -25.0, 60.0, 30.0)
ISLES = shapely.MultiPolygon([shapely.box(0, 0, 30, 30), shapely.box(33, 0, 60, 30)])


def one_by_one(room, apart, density, rng):
    """The same points, each compared with all before it."""
    chosen = np.zeros((0, 2))
    for part in shapely.get_parts(room):
        west, south, east, north = part.bounds
        tries = rng.poisson(density * (east - west) * (north - south))
        points = rng.uniform((west, south), (east, north), (tries, 2))
        for point in points[shapely.contains_xy(part, points)]:
            if np.linalg.norm(chosen - point, axis=1).min(initial=np.inf) > apart:
                chosen = np.concatenate([chosen, point[None]])
    return chosen


@pytest.mark.parametrize("room", [YARD, ISLES, YARD.buffer(-3).difference(shapely.Point(0, 0))])
@pytest.mark.parametrize("apart", [0.7, 4.0, 11.0, 500.0])
def test_a_point_stands_where_no_earlier_one_is_near(room, apart):
    found = scattered(room, apart, 0.4, np.random.default_rng(5))
    np.testing.assert_array_equal(found, one_by_one(room, apart, 0.4, np.random.default_rng(5)))
    assert len(found) > 0


def test_a_shape_without_room_holds_none():
    assert scattered(shapely.Polygon(), 2.0, 1.0, np.random.default_rng(0)).shape == (0, 2)


def test_the_forests_of_a_lake_are_dense():
    found = scattered(shapely.box(0, 0, 400, 400), 2.0, 0.2, np.random.default_rng(1))
    assert len(found) > 13_500


def test_the_paving_of_a_house_depends_on_its_neighbours_only():
    corners = np.array([(0.0, 0.0), (12.0, 0.0), (12.0, 9.0), (0.0, 9.0)])
    east, north, step = np.array([14.0, 0.0]), np.array([0.0, 12.0]), np.array([90.0, 0.0])
    houses = [corners, corners + east, corners + north]
    kerb = shapely.box(-50, -12, 2000, -10)
    few = paved_yards(houses, kerb, kerb)
    many = paved_yards([*houses, *(corners + k * step for k in range(1, 20))], kerb, kerb)
    assert [shapely.to_wkb(yard) for yard in many[:3]] == [shapely.to_wkb(yard) for yard in few]
    assert all(a.intersection(b).area < 1e-6 for a, b in pairwise(few))
    assert all(yard.contains(shapely.box(*house.min(axis=0), *house.max(axis=0)).buffer(-0.5))
               for yard, house in zip(few, houses, strict=True))  # fmt: skip
    assert few[0].bounds[1] == pytest.approx(-10.0, abs=0.01)  # a path to the pavement
