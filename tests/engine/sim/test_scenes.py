"""Geometry put together from what the cache keeps of a map and of each kind of movers."""

import numpy as np

from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.sim.scenes import load_geometry, load_scene, load_textures
from eyas.engine.targets.catalogue import KINDS, kind_index
from eyas.engine.targets.rig import part_library
from eyas.engine.world.weather import Season


def test_geometry_of_kept_packs_is_that_of_everything_at_once():
    kinds = kind_index("BB-8"), kind_index("Create")
    load_geometry("desert-bare", 0, Season.SUMMER, kinds[:1])
    kept = load_geometry("desert-bare", 0, Season.SUMMER, kinds)
    parts = part_library(tuple(KINDS[kind] for kind in kinds))
    made = build_geometry(load_scene("desert-bare", 0), parts, load_textures())
    for name, array in made._asdict().items():
        np.testing.assert_array_equal(getattr(kept, name), array, err_msg=name)
