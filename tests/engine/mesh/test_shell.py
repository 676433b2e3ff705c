import numpy as np
import pytest

from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material

RED = Material(tint=(1.0, 0.0, 0.0))
BLUE = Material(tint=(0.0, 0.0, 1.0))


def volume(mesh):
    a, b, c = np.moveaxis(mesh.positions.astype(np.float64)[mesh.triangles], 1, 0)
    return np.einsum("ti,ti->", a, np.cross(b, c)) / 6


@pytest.mark.parametrize(
    ("add", "expected"),
    [
        (lambda s: s.box((1, 2, 3), (2, 4, 6), RED), 6.0),
        (lambda s: s.box((1, 2, 3), (2, 4, 6), RED, both_sides=True), 12.0),
        (lambda s: s.prism([(0, 0), (2, 0), (0, 1)], (1, 4), RED), 3.0),
        (lambda s: s.prism([(0, 0), (2, 0), (0, 1)], (1, 4), RED, both_sides=True), 6.0),
        (lambda s: s.tube([(0, 1, 0), (0, 1, 3)], (1, 1), RED, sides=64), 3 * np.pi),
        (lambda s: s.tube([(0, 1, 0), (0, 3, 0)], (1, 1), RED, sides=64), 2 * np.pi),
        (lambda s: s.ball((4, 5, 6), (1, 2, 3), RED, rows=32, sides=64), 8 * np.pi),
    ],
)
def test_solids_are_closed_and_wound_outwards(add, expected):
    shell = Shell()
    add(shell)
    assert volume(shell.mesh()) == pytest.approx(expected, rel=0.01)


def test_boxes_keep_hard_edges_and_balls_are_smooth():
    shell = Shell()
    shell.box((0, 0, 0), (1, 1, 1), RED)
    assert set(np.abs(shell.mesh().normals).max(axis=1)) == {1.0}
    assert len(shell.mesh().positions) == 24
    shell = Shell()
    shell.ball((0, 0, 0), (1, 1, 1), RED, rows=12, sides=16)
    mesh = shell.mesh()
    assert np.einsum("vi,vi->v", mesh.positions, mesh.normals).min() > 0.99


def test_an_edge_between_materials_is_hard():
    flat = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    bent = [(1, 0, 0), (2, 0, 0.3), (2, 1, 0.3), (1, 1, 0)]
    for second, points in ((RED, 6), (BLUE, 8)):
        shell = Shell()
        shell.quads(flat, RED)
        shell.quads(bent, second)
        assert len(shell.mesh().positions) == points


def test_panels_without_area_are_left_out():
    shell = Shell()
    shell.quads([(0, 0, 0), (1, 0, 0), (1, 0, 0), (0, 1, 0)], RED)
    assert len(shell.mesh().triangles) == 1
