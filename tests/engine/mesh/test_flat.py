import shapely

from eyas.engine.mesh.flat import flat_polygon
from eyas.engine.state.mesh import Material


def triangles(polygon):
    return len(flat_polygon(polygon, 0.0, Material(), 1.0).triangles)


def test_a_square_is_two_triangles_and_needles_are_none():
    assert triangles(shapely.box(0, 0, 1, 1)) == 2
    assert triangles(shapely.Polygon([(0, 0), (60, 0), (30, 1e-8)])) == 0
    assert triangles(shapely.Polygon([(0, 0), (60, 0), (30, 1e-3)])) == 1
