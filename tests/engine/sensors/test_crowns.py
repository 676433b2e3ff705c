"""The solids of trees: as wide at each height as the leaves that are drawn."""

import numpy as np
import pytest

from eyas.engine.sensors.obstacles import crown_slices, furniture, solids_of
from eyas.engine.sim.scenes import load_scene, load_solids
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.weather import Season


@pytest.fixture(scope="module")
def village():
    return load_scene("village")


def test_a_cone_is_wide_below_and_narrow_above(village):
    names = village.fixtures.names
    number = next(k for k, name in enumerate(names) if name.startswith("cone tree"))
    mesh = village.fixtures.levels[number][0]
    corners = mesh.positions.astype(np.float64)
    slices = np.array(crown_slices(mesh, corners.min(axis=0), corners.max(axis=0)))
    assert len(slices) == 5
    assert slices[1:, 0] == pytest.approx(slices[:-1, 1])  # one on the other
    assert slices[-1, 2] < 0.5 * slices[1, 2]
    away = np.hypot(corners[:, 0], corners[:, 1])
    for bottom, top, radius in slices:
        there = away[(corners[:, 2] >= bottom) & (corners[:, 2] <= top)]
        if len(there):
            assert radius == pytest.approx(0.85 * there.max(), rel=0.3)


def test_every_tree_stands_where_it_is_drawn_and_none_beside(village):
    fixtures = village.fixtures
    trees = village.object_class[fixtures.object_id] == ObjectClass.TREE
    made = furniture(village)
    crowns = [c for c in made.cylinders if village.object_class[c.thing] == ObjectClass.TREE]
    assert {c.thing for c in crowns} <= set(fixtures.object_id[trees].tolist())
    for copy in np.flatnonzero(trees)[::7].tolist():
        thing = fixtures.object_id[copy]
        own = [c for c in crowns if c.thing == thing]
        if not own:
            continue  # a hedge
        pose = fixtures.pose[copy].astype(np.float64)
        leaves = fixtures.levels[fixtures.prototype[copy]][0].positions @ pose[:, :3].T
        leaves = leaves + pose[:, 3]
        x, y, _ = own[0].place
        reach = np.hypot(leaves[:, 0] - x, leaves[:, 1] - y).max()
        assert max(c.place[2] for c in own) <= reach
        assert max(c.top for c in own) == pytest.approx(leaves[:, 2].max(), abs=1e-3)


def test_solids_are_the_same_made_and_loaded(village):
    made, loaded = solids_of(village), load_solids("village", 0, Season.SUMMER)
    for ours, theirs in zip(made[:6], loaded[:6], strict=True):
        np.testing.assert_array_equal(ours, theirs)
    for ours, theirs in zip(made.grid, loaded.grid, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    assert made.ground == loaded.ground
