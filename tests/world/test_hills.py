"""Hills: where they rise, and that their surface is the ground that the raster tells of."""

import numpy as np
import pytest

from eyas.state.terrain import ground_at
from eyas.world.build.materials import material
from eyas.world.land.hills import Hill, hilly, relief_mesh

HILLS = [Hill(20.0, -10.0, 60.0, 25.0), Hill(-60.0, 30.0, 40.0, 12.0)]
GROUND = hilly((300.0, 200.0), -0.1, HILLS, spacing=4.0)


def test_hills_rise_to_their_tops_and_nothing_else_rises():
    for hill in HILLS:
        top = ground_at(GROUND, hill.x, hill.y)
        assert top == pytest.approx(hill.height - 0.1, abs=0.02 * hill.height)
        assert ground_at(GROUND, hill.x - hill.radius / 2, hill.y) > 0.4 * hill.height
    assert ground_at(GROUND, 140.0, 90.0) == pytest.approx(-0.1)
    assert ground_at(GROUND, 100.0, -10.0) == pytest.approx(-0.1)


def test_where_hills_meet_the_higher_one_counts():
    both = hilly((100.0, 100.0), 0.0, [Hill(0, 0, 40, 10.0), Hill(0, 0, 40, 30.0)])
    assert both.relief.max() == 30.0


def test_the_raster_covers_the_floor():
    for size in ((300.0, 200.0), (97.0, 301.0), (3.0, 3.0)):
        ground = hilly(size, 0.0, [])
        reach = ground.spacing * (np.array(ground.relief.shape[::-1]) - 1)
        assert (reach >= np.array(size) - 1e-9).all()
        assert (ground.west, ground.south) == (-0.5 * size[0], -0.5 * size[1])


def test_the_surface_is_the_ground_and_faces_up():
    mesh = relief_mesh(GROUND, material("lawn"))
    for x, y, z in mesh.positions[::17].astype(float):
        assert ground_at(GROUND, x, y) == pytest.approx(z, abs=1e-3)
    corners = mesh.positions[mesh.triangles].astype(float)
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (face[:, 2] > 0).all()
    assert face[:, 2].sum() / 2 == pytest.approx(300.0 * 200.0)
    face /= np.linalg.norm(face, axis=1, keepdims=True)
    smooth = mesh.normals[mesh.triangles].mean(axis=1)
    assert (np.einsum("ti,ti->t", face, smooth) > 0.98).all()
