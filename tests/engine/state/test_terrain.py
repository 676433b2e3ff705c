"""Height of the ground: linear between the points of a raster, level beyond it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eyas.engine.state.terrain import Terrain, ground_at, relief_at, reliefs, slope_at

FLOOR, WEST, SOUTH, SPACING = -0.1, -30.0, 12.0, 2.5
RELIEF = np.random.default_rng(3).uniform(0.0, 40.0, (9, 14)).astype(np.float32)
HILLS = Terrain(FLOOR, RELIEF, WEST, SOUTH, SPACING)
EAST, NORTH = WEST + 13 * SPACING, SOUTH + 8 * SPACING

inside = st.tuples(st.floats(WEST, EAST), st.floats(SOUTH, NORTH))
anywhere = st.tuples(st.floats(-200.0, 200.0), st.floats(-200.0, 200.0))


def bilinear(x, y) -> float:
    """Along each row of the raster, then across the rows."""
    columns, rows = WEST + SPACING * np.arange(14), SOUTH + SPACING * np.arange(9)
    return float(np.interp(y, rows, [np.interp(x, columns, row) for row in RELIEF]))


@given(anywhere)
def test_heights_are_those_of_linear_interpolation_and_the_edge_goes_on(point):
    assert relief_at(HILLS, *point) == pytest.approx(bilinear(*point), abs=1e-9)
    assert ground_at(HILLS, *point) == FLOOR + relief_at(HILLS, *point)


def test_the_points_of_the_raster_have_its_heights():
    for row, column in np.ndindex(RELIEF.shape):
        height = relief_at(HILLS, WEST + SPACING * column, SOUTH + SPACING * row)
        assert height == RELIEF[row, column]


@given(st.lists(anywhere, min_size=1, max_size=20))
def test_many_points_at_once_have_the_heights_of_each(points):
    each = [relief_at(HILLS, *point) for point in points]
    np.testing.assert_allclose(reliefs(HILLS, np.array(points)), each, rtol=0, atol=1e-9)


@given(inside)
def test_slopes_are_differences_of_heights(point):
    x, y = point
    step = 1e-4
    # Across a line of the raster the slope changes: stay on one side of it.
    for value, low in ((x, WEST), (y, SOUTH)):
        if (value - low) % SPACING < step or SPACING - (value - low) % SPACING < step:
            return
    east = (relief_at(HILLS, x + step, y) - relief_at(HILLS, x - step, y)) / (2 * step)
    north = (relief_at(HILLS, x, y + step) - relief_at(HILLS, x, y - step)) / (2 * step)
    assert slope_at(HILLS, x, y) == pytest.approx((east, north), abs=1e-6)


def test_beyond_the_raster_the_ground_does_not_rise_away_from_it():
    middle = SOUTH + 3.3 * SPACING
    for x in (WEST - 5.0, EAST + 5.0):
        along, across = slope_at(HILLS, x, middle)
        edge = slope_at(HILLS, WEST if x < WEST else EAST, middle)
        assert (along, across) == (0.0, edge[1])
    assert slope_at(HILLS, WEST - 5.0, NORTH + 5.0) == (0.0, 0.0)


@given(anywhere)
def test_a_flat_map_is_exactly_its_floor(point):
    flat = Terrain.flat(FLOOR)
    assert ground_at(flat, *point) == FLOOR
    assert relief_at(flat, *point) == 0.0
    assert slope_at(flat, *point) == (0.0, 0.0)
    assert reliefs(flat, np.array([point])) == 0.0


def test_a_flat_map_holds_no_raster():
    assert Terrain.flat(0.0).relief.nbytes == 0
