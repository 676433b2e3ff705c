"""Basic shapes."""

import numpy as np

from eyas.engine.mesh.solids import sphere
from eyas.engine.world.build.materials import material


def test_no_triangle_of_a_sphere_takes_the_texture_back_round_it():
    for subdivisions in (1, 2):
        mesh = sphere(subdivisions, material("plain"))
        off_the_poles = (np.abs(mesh.positions[mesh.triangles, 2]) < 0.999).all(axis=1)
        around = mesh.uvs[mesh.triangles, 0][off_the_poles]
        assert np.ptp(around, axis=1).max() < 1.5
        # Once round are six tiles: where it ends the texture goes on.
        assert 5.0 < np.ptp(around) < 9.0
