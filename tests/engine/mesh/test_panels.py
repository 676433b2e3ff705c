"""Panels: where they are, and which way they face."""

import numpy as np
import pytest

from eyas.engine.mesh.panels import box_panels, cells, closed, fan, halves, mirrored

SQUARE = np.array([(0, 0, 2), (1, 0, 2), (1, 1, 2), (0, 1, 2)], float)


def areas(triangles):
    """Vector areas: they point to where the triangles face."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return np.cross(b - a, c - a) / 2


@pytest.mark.parametrize("middle", [None, (0.3, 0.6, 2.0)])
def test_a_fan_fills_its_ring(middle):
    np.testing.assert_allclose(areas(fan(SQUARE, middle)).sum(0), (0, 0, 1))


def test_cells_join_each_row_to_the_next():
    grid = np.stack(np.meshgrid(np.arange(4), [0.0], np.arange(3)), axis=-1)[0].swapaxes(0, 1)
    quads = cells(grid)
    assert quads.shape == (6, 4, 3)
    np.testing.assert_array_equal(quads[4], [(1, 0, 1), (2, 0, 1), (2, 0, 2), (1, 0, 2)])
    np.testing.assert_allclose(areas(halves(quads)).sum(0), (0, -6, 0))


def test_rings_are_closed_with_their_first_point():
    np.testing.assert_array_equal(closed([SQUARE])[0, [0, -1]], SQUARE[[0, 0]])


def test_the_faces_of_a_box_face_away_from_its_middle():
    panels = box_panels((1, 2, 3), (2, 4, 6), taper=0.2)
    faces = areas(halves(panels))
    middles = halves(panels).mean(axis=1) - (1.5, 3, 4.5)
    assert (np.einsum("ti,ti->t", faces, middles) > 0).all()
    np.testing.assert_allclose(faces.sum(0), 0, atol=1e-12)


def test_what_is_mirrored_still_faces_up():
    assert (areas(mirrored(fan(SQUARE)))[:, 2] > 0).all()
    assert mirrored(fan(SQUARE))[..., 1].min() == -1
