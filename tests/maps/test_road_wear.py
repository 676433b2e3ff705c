"""Tracks, patches and lids lie on the road, in layers below the paint."""

import numpy as np
import pytest
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.world.roads.areas import road_area
from eyas.maps.roads.painting import PAINT_HEIGHT
from eyas.maps.roads.wear import WEAR_HEIGHTS, road_wear


@pytest.fixture(scope="module")
def wear(network):
    return road_wear(network, stream(0, "wear"))


def test_wear_lies_on_asphalt(network, wear):
    road = road_area(network).buffer(0.05)
    shapely.prepare(road)
    assert shapely.covers(road, shapely.points(wear.positions[:, :2].astype(float))).all()


def test_layers_are_apart_from_each_other_the_asphalt_and_the_paint():
    levels = [0.0, *WEAR_HEIGHTS, PAINT_HEIGHT]
    assert min(np.diff(levels)) >= 0.0029  # what a picture from 100 m tells apart, many times over


def test_there_is_some_of_all_but_little_enough(network, wear):
    kinds = [wear.palette[index].texture for index in wear.materials]
    tints = [wear.palette[index].tint for index in wear.materials]
    patched = [
        t == (1.0, 1.0, 1.0) for k, t in zip(kinds, tints, strict=True) if k == "asphalt_patch"
    ]
    lids, patches, sealed = (
        kinds.count("manhole") / 2,
        sum(patched) / 2,
        len(patched) - sum(patched),
    )
    assert 200 < sealed < 3000
    assert 40 < kinds.count("asphalt_oil") <= 2 * len(network.lane_width)
    assert 20 < lids < 300
    assert 40 < patches < 500
    assert len(kinds) < 8000


def test_all_of_it_faces_up(wear):
    corners = wear.positions[wear.triangles].astype(float)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normal[:, 2] > 0).all()
    assert np.allclose(wear.normals, (0, 0, 1))


def test_it_is_always_the_same(network, wear):
    again = road_wear(network, stream(0, "wear"))
    assert again.positions.tobytes() == wear.positions.tobytes()
