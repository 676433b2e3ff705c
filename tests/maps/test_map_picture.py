"""Pictures of maps from above: what a map has can be seen, where it is."""

import numpy as np
import pytest
from PIL import Image

from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.scene import ObjectClass
from eyas.engine.state.terrain import reliefs
from eyas.maps.commands import show


@pytest.fixture(scope="module")
def village(tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "village.png"
    show.run("village", 0, path, 400, tracks=False)
    return np.asarray(Image.open(path), float)


def pixels(scene, picture, points):
    """Return the colours of a picture at places of its map."""
    paper = show._Paper(scene, picture.shape[1])
    column, row = (np.array(paper.at(points)) / show._SHARP).astype(int).T
    return picture[np.clip(row, 0, picture.shape[0] - 1), column]


def test_hills_are_dark_where_they_fall_to_the_south_east(village):
    scene = load_scene("village", 0)
    points = np.random.default_rng(0).uniform(-300, 300, (4000, 2))
    step = np.array([3.0, -3.0])
    fall = reliefs(scene.terrain, points - step) - reliefs(scene.terrain, points + step)
    steep = 5.0  # [m] over 8.5 m
    away, towards = (pixels(scene, village, points[side]) for side in (fall > steep, fall < -steep))
    assert min(len(away), len(towards)) > 50
    assert np.median(away) < 200 < np.median(towards)


def test_each_tree_is_green(village):
    scene = load_scene("village", 0)
    fixtures = scene.fixtures
    trees = scene.object_class[fixtures.object_id] == ObjectClass.TREE
    tall = [name.startswith("cone tree") for name in fixtures.names]
    places = fixtures.pose[trees & np.array(tall)[fixtures.prototype], :2, 3]
    seen = pixels(scene, village, places[np.abs(places).max(axis=1) < 300.0])
    assert len(seen) > 60
    assert (seen[:, 1] > seen[:, 0] + 5).mean() > 0.9  # some are below the roof of a tunnel
