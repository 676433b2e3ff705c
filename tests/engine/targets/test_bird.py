"""Birds: their parts, the beat of their wings, and the box in which they fit."""

import numpy as np
import pytest

from eyas.engine.state.motion import ActorState
from eyas.engine.targets.bird import BIRD, BirdRig
from eyas.engine.targets.catalogue import KINDS, kind_index, models_of
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs

KIND = kind_index(BIRD.name)


def posed(travelled, yaw=0.0, yaw_rate=0.0, slope=0.0):
    """Return the points of a bird [m], relative to its reference point."""
    rigs = Rigs(np.array([KIND], np.int32))
    actors, out = ActorState.create(1, 1), rigs.draw_list(1)
    actors.present[:], actors.travelled[:], actors.yaw[:] = True, travelled, yaw
    actors.speed[:], actors.yaw_rate[:], actors.slope[:] = 11.0, yaw_rate, slope
    rigs.pose(actors, Looks(np.full((1, 1), models_of(KIND)[0]), np.ones((1, 1, 3))), out)
    points = []
    for part, pose in zip(out.part[0], out.pose[0], strict=True):
        mesh = BirdRig().part_levels()[part][0]
        points.append(mesh.positions @ pose[:, :3].T + pose[:, 3])
    return points


@pytest.mark.parametrize("part", range(3))
def test_parts_are_closed_or_two_sided_and_face_outwards(part):
    mesh = BirdRig().part_levels()[part][0]
    corners = mesh.positions[mesh.triangles].astype(float)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.abs(normal.sum(axis=0)).max() < 1e-4
    middle = corners.mean(axis=1) - corners.mean(axis=(0, 1))
    assert np.einsum("ti,ti->", middle, normal) > 0.0
    assert len(mesh.triangles) < 100


def test_wings_beat_together_and_stay_in_its_box():
    length, width, height = BIRD.models[0].size
    tips = []
    for travelled in np.arange(0.0, 40.0, 0.2):
        body, left, right = posed(travelled)
        np.testing.assert_allclose(left[:, 2].max(), right[:, 2].max(), atol=1e-5)
        points = np.concatenate([body, left, right])
        assert (np.abs(points[:, :2]) <= np.array([0.5 * length + 0.02, 0.5 * width])).all()
        assert points[:, 2].min() >= 0.0
        assert points[:, 2].max() <= height
        tips.append(left[np.argmax(left[:, 1]), 2] - 0.35)
    assert max(tips) > 0.2
    assert min(tips) < -0.15
    assert min(np.ptp(tips[k : k + 10]) for k in range(0, 190, 10)) < 0.2  # now and then it glides


def test_it_banks_into_its_turns():
    _, left, right = posed(2.0, yaw_rate=0.5)
    assert left[:, 2].mean() < right[:, 2].mean()


def test_it_is_no_target():
    assert BIRD.name not in {name.value for name in TargetName}
    assert KINDS[KIND].habit is None
