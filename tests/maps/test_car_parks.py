"""Car parks: inside their block, with a way to the street."""

import numpy as np
import pytest
import shapely

from eyas.maps.street.car_parks import place_car_parks

BLOCKS = [shapely.box(0, 0, 160, 120), shapely.box(200, 0, 330, 150)]


@pytest.fixture(scope="module")
def parks():
    sizes = [(69.0, 34.0), (49.0, 17.0)]
    return place_car_parks(BLOCKS, sizes, np.random.default_rng(1), shapely.Polygon())


def test_there_is_one_for_each_size_in_a_block_of_its_own(parks):
    homes = [[block.contains(park.area.buffer(-0.06)) for block in BLOCKS] for park in parks]
    assert sorted(homes) == [[False, True], [True, False]]
    assert [park.area.area for park in parks] == pytest.approx([69 * 34 + 33, 49 * 17 + 33], abs=9)


def test_the_driveway_crosses_the_kerb(parks):
    for park in parks:
        kerbs = [park.area.intersection(block.boundary).length for block in BLOCKS]
        assert max(kerbs) == pytest.approx(6.5)


def test_bay_lines_are_inside_and_not_across_the_driveway(parks):
    for park in parks:
        assert len(park.lines) > 20
        assert all(park.area.contains(line) for line in park.lines)


def test_what_must_stay_free_stays_free():
    free = shapely.box(0, 0, 160, 70)
    sizes = [(60.0, 30.0)]
    parks = place_car_parks(BLOCKS[:1], sizes, np.random.default_rng(1), free)
    assert len(parks) == 1
    assert not parks[0].area.intersects(free)


def test_what_fits_nowhere_is_left_out():
    assert not place_car_parks(BLOCKS, [(300.0, 34.0)], np.random.default_rng(1), shapely.Point())
