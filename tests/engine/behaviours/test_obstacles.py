"""What is in the way, on a map of a few triangles."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.engine.state.scene import ObjectClass, Scene


@pytest.fixture(scope="module")
def obstacles() -> GroundObstacles:
    """A pond, a wall, a roof, and a slab in a square of 100 m."""
    things = {
        ObjectClass.WATER: [[10, 10, 0], [20, 10, 0], [20, 20, 0], [10, 20, 0]],
        ObjectClass.STRUCTURE: [[-20, -10, 0], [-20, 10, 0], [-20, 10, 2], [-20, -10, 2]],
        ObjectClass.BUILDING: [[-10, -30, 4], [10, -30, 4], [10, -20, 4], [-10, -20, 4]],
        ObjectClass.PAVEMENT: [[-10, 30, 0.15], [10, 30, 0.15], [10, 40, 0.15], [-10, 40, 0.15]],
    }
    shell = Shell()
    for corners in things.values():
        shell.quads(corners, Material())
    scene = replace(
        Scene.empty(),
        static=shell.mesh(),
        static_object=np.repeat(np.arange(4, dtype=np.int32), 2),
        object_class=np.array(list(things), np.int32),
    )
    return GroundObstacles(scene, roads=True)


def test_water_and_walls_are_in_the_way_but_not_roofs_and_pavements(obstacles):
    points = np.array([[15, 15], [15, 9.8], [-20.2, 5], [-20, 11], [0, -25], [0, 35], [0, 0]])
    blocked = obstacles.blocked(shapely.points(points.astype(float)), 0.3)
    assert blocked.tolist() == [True, True, True, False, False, False, False]


def test_one_goes_as_far_as_water_walls_and_the_edge_of_the_map(obstacles):
    start = np.array([[0.0, 15.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    reach = obstacles.reach(start, np.array([0.0, np.pi, 0.0, np.pi / 2]), 60.0, 0.5)
    np.testing.assert_allclose(reach, [9.5, 19.5, 44.5, 44.5], atol=0.02)
