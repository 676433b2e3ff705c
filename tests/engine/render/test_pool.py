"""Meshes that are packed together are packed as each alone."""

import numpy as np

from eyas.engine.render.pack import pool
from eyas.engine.render.pack.pool import Pool
from eyas.engine.state.mesh import Material, Mesh, Surface


def test_meshes_are_packed_alike_alone_and_with_others(monkeypatch):
    """Whatever their sizes: whole clusters, none, leaves only, and triangles in the same place."""
    rng = np.random.default_rng(0)
    counts = (1, 8, 0, 9, 64, 65, 700)
    meshes = [mesh_of(rng, count) for count in counts]
    meshes += [mesh_of(rng, 30, leaves=1.0), mesh_of(rng, 40, spread=0.0), mesh_of(rng, 3)]
    together = packed(meshes)
    monkeypatch.setattr(pool, "_AT_ONCE", 1)
    alone = packed(meshes)
    assert together.keys() == alone.keys()
    for name, array in together.items():
        np.testing.assert_array_equal(array, alone[name], name, strict=True)


def packed(meshes):
    made = Pool()
    for mesh in meshes:
        made.add(mesh)
    return made.packed() | {"palette": np.array([one.tint for one in made.palette])}


def mesh_of(rng, count, *, leaves=0.3, spread=5.0):
    """Return triangles that are equal in all but place, some of them of leaves."""
    shape = rng.normal(size=(3, 3))
    positions = (shape + rng.normal(0, spread, (count, 1, 3))).reshape(-1, 3)
    return Mesh(
        positions=positions.astype(np.float32),
        normals=np.tile(np.float32([0, 0, 1]), (3 * count, 1)),
        uvs=rng.uniform(0, 1, (3 * count, 2)).astype(np.float32),
        triangles=np.arange(3 * count, dtype=np.int32).reshape(-1, 3),
        materials=(rng.uniform(size=count) < leaves).astype(np.int32),
        palette=(Material(tint=tuple(rng.uniform(size=3))), Material(surface=Surface.FOLIAGE)),
    )
