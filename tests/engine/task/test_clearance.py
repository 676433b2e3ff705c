"""Where a camera may fly, and what it sees from there."""

import numpy as np
import pytest

from eyas.engine.sensors.grid import grid_of
from eyas.engine.sensors.obstacles import Solids
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.clearance import Clearance, Margin

MARGIN = Margin(aside=1.5, above=1.0, ground=4.0)


@pytest.fixture(scope="module")
def clearance() -> Clearance:
    """A house of 10 x 10 x 8 m around the origin, a bridge 20 m up over it, a mast beside it."""
    square = np.array([(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)])
    bounds = np.array([(-5, -5, 5, 5), (-5, -5, 5, 5), (19, -1, 21, 1)], np.float64)
    top = np.array([8.0, 21.0, 12.0])
    solids = Solids(
        points=np.concatenate([square, square]),
        first=np.array([0, 4, 8], np.int32),
        round=np.array([(20.0, 0.0, 1.0)]),
        bottom=np.array([0.0, 20.0, 0.0]),
        top=top,
        thing=np.array([1, 2, 3], np.int32),
        grid=grid_of(bounds, top),
        ground=0,
    )
    nobody = SampledMotion(np.zeros((2, 0), SAMPLE), np.zeros(0, np.int32), 10.0).packed()
    return Clearance(solids, Terrain.flat(0.0), nobody)


@pytest.mark.parametrize(
    ("place", "height"),
    [
        ((50.0, 50.0, 1.0), 4.0),  # the ground
        ((50.0, 50.0, 6.0), 6.0),
        ((0.0, 0.0, 5.0), 9.0),  # in the house
        ((6.4, 0.0, 5.0), 9.0),  # beside its wall
        ((6.6, 0.0, 5.0), 5.0),
        ((0.0, 0.0, 15.0), 15.0),  # between house and bridge
        ((0.0, 0.0, 19.5), 22.0),
        ((0.0, 0.0, 40.0), 40.0),
        ((22.4, 0.0, 11.0), 13.0),  # beside the mast
        ((22.6, 0.0, 11.0), 11.0),
    ],
)
def test_places_are_lifted_over_what_is_beside_them_and_no_higher(clearance, place, height):
    assert clearance.lifted(np.array([place]), MARGIN).tolist() == [height]


def test_a_narrow_gap_is_lifted_over(clearance):
    wide = Margin(aside=1.5, above=7.0, ground=4.0)
    assert clearance.lifted(np.array([(0.0, 0.0, 5.0)]), wide).tolist() == [28.0]


def test_what_stands_hides_what_is_behind_it(clearance):
    eyes = np.array([(-20.0, 0.0, 4.0), (-20.0, 0.0, 12.0)])
    points = np.array([[(15.0, 0.0, 1.0), (-15.0, 0.0, 1.0)]] * 2)
    assert clearance.in_sight(eyes, points).tolist() == [[False, True], [False, True]]
    aside = np.array([0.0, 9.0, 0.0])
    assert clearance.in_sight(eyes + aside, points + aside).all()
