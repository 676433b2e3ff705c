"""Traffic lights: at every stop line, beside the road, over the lanes that they are for."""

import numpy as np
import pytest
import shapely

from eyas.engine.world.roads.areas import road_area, streets
from eyas.engine.world.street.signals import POLE_HEIGHT, signal_levels, signal_places


def test_every_arm_of_every_junction_has_one(network):
    assert len(signal_places(network)) == 36


def test_they_stand_beside_the_road_and_reach_over_it_facing_the_traffic(network):
    road = road_area(network)
    ends = [street.right[-1] for street in streets(network)]
    for foot, turn in signal_places(network):
        assert 0.3 < road.distance(shapely.Point(foot)) < 1.0
        tip = foot + 5.0 * np.array([np.cos(turn), np.sin(turn)])
        assert road.contains(shapely.Point(tip))
        street = streets(network)[int(np.argmin(np.linalg.norm(ends - foot, axis=1)))]
        facing = np.array([-np.sin(turn), np.cos(turn)])
        assert (street.right[-1] - street.right[-2]) @ facing < 0


def test_a_truck_passes_below_the_arm():
    fine, coarse = signal_levels()
    for mesh in (fine, coarse):
        over_lanes = mesh.positions[:, 0] > 1.0
        assert mesh.positions[over_lanes, 2].min() > 4.6
        assert mesh.positions[:, 2].max() == pytest.approx(POLE_HEIGHT, abs=0.1)
    assert len(coarse.triangles) < len(fine.triangles) < 300
