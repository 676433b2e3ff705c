"""Roofs over footprints of any shape."""

import numpy as np
import pytest
import shapely

from eyas.engine.world.build.materials import material
from eyas.maps.buildings.roof_shapes import SHAPES, fullness, sloping_roof

COVERS = (material("roof_tiles"), material("concrete"))
BOX = shapely.box(0, 0, 20, 10)
ANGLE = shapely.box(0, 0, 20, 20) - shapely.box(8, 8, 20, 20)
YARD = shapely.box(0, 0, 40, 40) - shapely.box(14, 14, 26, 26)
TURNED = shapely.affinity.rotate(BOX, 31)


def corners(mesh):
    return mesh.positions[mesh.triangles].astype(np.float64)


def plan_area(mesh):
    """Area of what faces up, seen from above [m^2]."""
    c = corners(mesh)
    twice = np.cross(c[:, 1, :2] - c[:, 0, :2], c[:, 2, :2] - c[:, 0, :2])
    return twice[mesh.normals[mesh.triangles[:, 0], 2] > 0.01].sum() / 2


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # crosses of plane vectors
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize(
    "shape", [BOX, ANGLE, YARD, TURNED], ids=["box", "angle", "yard", "turned"]
)
def test_a_roof_covers_its_footprint_between_eaves_and_ridge(kind, shape):
    mesh = sloping_roof(shape, kind, 6.0, 3.0, COVERS)
    over = shapely.buffer(shape, 0.36, join_style="mitre")
    if not (kind == "dome" and shape.interiors):  # a dome has no courtyard
        assert shape.area * 0.98 < plan_area(mesh) < over.area * 1.02
    z = mesh.positions[:, 2]
    assert 5.3 < z.min() <= 6.01
    assert 8.0 < z.max() <= 9.2
    assert np.isfinite(mesh.positions).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-4)


def test_a_ridge_runs_along_or_across():
    for across, ridge in ((False, 0), (True, 1)):
        mesh = sloping_roof(BOX, "gabled", 6.0, 3.0, COVERS, across=across)
        top = mesh.positions[mesh.positions[:, 2] > 8.99]
        span = np.ptp(top, axis=0)
        assert span[ridge] > (20, 10)[ridge] - 0.1
        assert span[1 - ridge] < 0.1


def test_a_gable_has_a_wall_and_a_hip_has_none():
    gable, hip = (sloping_roof(BOX, kind, 6.0, 3.0, COVERS) for kind in ("gabled", "hipped"))
    upright = [abs(mesh.normals[:, 2]) < 0.01 for mesh in (gable, hip)]
    assert upright[0].any()
    assert not upright[1].any()


def test_slopes_face_outwards():
    mesh = sloping_roof(BOX, "pyramidal", 6.0, 3.0, COVERS)
    c = corners(mesh)
    up = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    assert (up[:, 2] > 0).all()


def test_fullness_tells_rectangles_from_other_shapes():
    assert fullness(TURNED) == pytest.approx(1.0)
    assert fullness(ANGLE) < 0.7
