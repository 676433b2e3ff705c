"""The drone that trackers see of each other."""

import numpy as np
import pytest

from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, models_of
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.quadrotor import quadrotor_levels
from eyas.engine.targets.rig import Rigs

KIND = kind_index("Quadrotor")


@pytest.mark.parametrize("level", range(3))
def test_every_level_has_the_size_of_a_small_camera_drone(level):
    mesh = quadrotor_levels()[level]
    size = np.ptp(mesh.positions, axis=0)
    assert size == pytest.approx(MODELS[models_of(KIND)[0]].size, abs=0.01)
    middle = (mesh.positions.min(axis=0) + mesh.positions.max(axis=0)) / 2
    assert np.abs(middle).max() < 0.02
    assert np.allclose(mesh.positions[:, 1].max(), -mesh.positions[:, 1].min())
    # Rotor hubs, the corners of the usual measure of a drone, are the upper ends of the motors.
    hubs = mesh.positions[mesh.positions[:, 2] > 0.02]
    hubs = hubs[np.abs(np.hypot(hubs[:, 0], hubs[:, 1]) - 0.177) < 0.02]
    assert 0.33 < 2 * np.hypot(hubs[:, 0], hubs[:, 1]).mean() < 0.37


def test_levels_are_closed_and_become_coarser():
    triangles = [len(mesh.triangles) for mesh in quadrotor_levels()]
    assert triangles == sorted(triangles, reverse=True)
    assert triangles[0] < 800
    for mesh in quadrotor_levels():
        corners = mesh.positions[mesh.triangles].astype(np.float64)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        # A closed surface has no sum of normals; that it has a volume means they point outwards.
        assert np.abs(normal.sum(axis=0)).max() < 1e-4
        assert np.einsum("ti,ti->", corners[:, 0], normal) / 6.0 > 0.001


def test_an_actor_of_this_kind_stands_at_its_heading():
    assert KINDS[KIND].object_class is ObjectClass.ROBOT
    rigs = Rigs(np.full(2, KIND, np.int32))
    actors, out = ActorState.create(1, 2), rigs.draw_list(1)
    actors.position[0, 0], actors.yaw[0, 0], actors.present[0, 0] = (
        (3.0, 4.0, 5.0),
        0.5 * np.pi,
        True,
    )
    looks = Looks(np.full((1, 2), models_of(KIND)[0], np.int32), np.ones((1, 2, 3), np.float32))
    rigs.pose(actors, looks, out)
    assert out.part.tolist() == [[0, -1]]
    expected = [[0, -1, 0, 3], [1, 0, 0, 4], [0, 0, 1, 5.055]]
    assert out.pose[0, 0] == pytest.approx(np.array(expected, float), abs=1e-6)
