"""The bare layouts: the roads of a map, and nothing that hides or distracts."""

import numpy as np
import pytest
import shapely

from eyas.engine.sim.scenes import load_scene
from eyas.engine.world.maps import MAPS
from eyas.engine.world.roads.areas import road_area
from eyas.engine.world.weather import WEATHERS


@pytest.mark.parametrize("whole", ["village", "desert", "farmland"])
def test_a_bare_layout_has_the_roads_of_its_map_and_nothing_else(whole):
    recipe, bare = MAPS.get(f"{whole}-bare"), load_scene(f"{whole}-bare", 0)
    assert recipe.roads(5) == MAPS.get(whole).roads(5)
    assert recipe.shipped_traffic() == MAPS.get(whole).shipped_traffic()
    assert bare.name == recipe.name
    assert not any((recipe.pedestrians, recipe.strollers, recipe.waiting, recipe.cyclists))
    without = {"foggy", "night", "snow"}
    assert recipe.weathers == tuple(name for name in WEATHERS.built_in if name not in without)
    assert len(bare.fixtures.pose) == len(bare.lamps.position) == len(bare.colliders.prism_top) == 0
    assert bare.terrain.relief.size == 0
    assert bare.static.positions[:, 2].max() < 0.05
    # No hole in the ground, and none under another.
    flat = bare.static.triangles
    corners = bare.static.positions[flat].astype(np.float64)
    soil = np.array([texture in {"lawn", "sand", "soil"} for texture in _textures(bare)])
    inside = np.abs(corners[..., :2]).max(axis=(1, 2)) <= max(bare.size) / 2
    area = shapely.area(shapely.polygons(corners[soil & inside][..., :2])).sum()
    assert area == pytest.approx(np.prod(bare.size) - road_area(bare.network).area, rel=1e-3)


def _textures(scene):
    return [scene.static.palette[k].texture for k in scene.static.materials]
