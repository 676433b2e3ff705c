"""Autumn's crowns: the same trees in other colours, some of them nearly bare."""

import numpy as np
import pytest

from eyas.engine.state.mesh import Surface
from eyas.engine.world.weather import Season
from eyas.maps.plants.foliage import COLOURS, in_autumn
from eyas.maps.plants.forest import SPECIES, stand_levels
from eyas.maps.plants.shrubs import DECIDUOUS, PLANTS
from eyas.maps.plants.trees import street_tree_levels


@pytest.fixture(scope="module")
def tree():
    return street_tree_levels(np.random.default_rng(1), 0)


@pytest.mark.parametrize("which", range(len(COLOURS)))
def test_leaves_turn_and_wood_stays(tree, which):
    for before, after in zip(tree, in_autumn(tree, which), strict=True):
        assert (after.positions == before.positions).all()
        for one, other in zip(before.palette, after.palette, strict=True):
            if one.texture == "bark":
                assert other == one
            else:
                assert other.texture == f"pale_{one.texture}"
                assert other.surface == one.surface
                red, green, blue = other.tint
                assert blue < green
                assert red > blue


@pytest.mark.parametrize("which", range(len(COLOURS)))
def test_as_many_leaves_are_left_as_the_colour_says(tree, which):
    def cards(mesh):
        leafy = np.array([one.surface == Surface.FOLIAGE for one in mesh.palette])
        return int(leafy[mesh.materials].sum())

    share = COLOURS[which][1]
    after = in_autumn(tree, which)
    for level in range(2):
        assert cards(after[level]) / cards(tree[level]) == pytest.approx(share, abs=0.03)
        # Whole cards of four or two triangles.
        assert cards(after[level]) % (4, 2)[level] == 0
    assert all(len(mesh.triangles) == len(mesh.materials) > 0 for mesh in after)


def test_a_bare_crown_is_seen_through(tree):
    thin = next(k for k, (_, share) in enumerate(COLOURS) if share < 0.4)
    near = in_autumn(tree, thin)[0]
    inner = [one.surface == Surface.CROWN for one in near.palette]
    assert not np.array(inner)[near.materials].any()


def test_evergreen_stands_stay_green_and_all_stands_keep_their_places():
    for kind in SPECIES:
        summer, autumn = (
            stand_levels((kind,), np.random.default_rng(2), season)
            for season in (Season.SUMMER, Season.AUTUMN)
        )
        for one, other in zip(summer, autumn, strict=True):
            assert (one.positions == other.positions).all()
        same = summer[0].palette == autumn[0].palette
        assert same == (kind.autumn is None)
    assert [kind.name for kind in SPECIES if kind.autumn is None] == ["palm", "spruce"]


def test_hedges_are_evergreen():
    assert set(DECIDUOUS) < set(PLANTS)
    assert "hedge" not in DECIDUOUS
