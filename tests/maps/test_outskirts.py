"""Beyond the streets: the way to the elevated road and the way down from it."""

import numpy as np
import pytest
import shapely

from eyas.maps.land.outskirts import access_road, descent


def test_an_access_road_joins_the_street_and_meets_the_ramp_in_full_width():
    street = shapely.box(-200, -7, 200, 7)
    foot = np.array([20.0, 60.0])
    road = access_road(foot, np.array([1.0, 0.0]), street)
    assert road.intersection(street).area == pytest.approx(0.0, abs=1e-6)
    assert shapely.union(street, road).buffer(1e-6).geom_type == "Polygon"
    ramp = shapely.LineString([[20, 53], [20, 67]])
    assert road.buffer(1e-6).covers(ramp)
    assert road.bounds[2] == pytest.approx(20.0)
    # Where it leaves the street, kerbs are round: wider than the road itself.
    mouth = road.intersection(shapely.box(-200, 7, 200, 7.2))
    assert mouth.bounds[2] - mouth.bounds[0] > 26.0


def test_the_way_down_goes_on_straight_and_ends_on_the_ground():
    middle = np.array([[0.0, 0.0, 50.0], [3.0, 4.0, 50.0]])
    down = descent(middle, -0.1)
    assert np.allclose(down[0], middle[-1])
    assert down[-1, 2] == pytest.approx(-0.1)
    steps = np.diff(down, axis=0)
    assert np.all(steps[:, 2] <= 0.0)
    assert np.allclose(steps[:, :2] / np.hypot(*steps[:, :2].T)[:, None], [0.6, 0.8])
    assert np.max(-steps[:, 2] / np.hypot(*steps[:, :2].T)) < 0.15
