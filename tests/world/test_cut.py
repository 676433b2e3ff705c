"""Relief is cut where a level passes zero."""

import numpy as np
import pytest
import shapely

from eyas.world.land.facets import relief
from eyas.world.land.rising import cut


@pytest.fixture(scope="module")
def ground():
    def heights(points):
        return np.maximum(20.0 - 0.5 * np.hypot(*points.T), 0.0)

    return relief(heights, (60.0, 80.0), (6.0, 12.0), shapely.Point(), np.random.default_rng(0))


def test_no_triangle_crosses_the_line_and_the_surface_stays_the_same(ground):
    level = 0.7 * ground.points[:, :1] + 0.4 * ground.points[:, 1:2] - 3.0
    made, levels = cut(ground, level, 0)
    assert len(made.triangles) > len(ground.triangles)
    signs = np.sign(levels[made.triangles, 0])
    # Cuts keep away from corners, so a level may pass zero just beside them.
    across = made.corners[(signs > 0).any(axis=1) & (signs < 0).any(axis=1)]
    assert len(across) == 0
    for each in (ground, made):
        a, b, c = np.moveaxis(each.corners, 1, 0)
        normal = np.cross(b - a, c - a)
        assert (normal[:, 2] > 0).all()
        each_volume = (normal[:, 2] / 2 * each.corners[..., 2].mean(axis=1)).sum()
        assert each_volume == pytest.approx(_volume(ground), rel=1e-3)


def _volume(ground):
    a, b, c = np.moveaxis(ground.corners, 1, 0)
    area = np.cross(b - a, c - a)[:, 2] / 2
    return (area * ground.corners[..., 2].mean(axis=1)).sum()


def test_the_cut_leaves_no_gap(ground):
    level = np.hypot(ground.points[:, :1] - 5.0, ground.points[:, 1:2]) - 17.0
    made, _ = cut(ground, level, 0)
    edges = np.sort(made.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    outer = np.sort(ground.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, before = np.unique(outer, axis=0, return_counts=True)
    assert count.max() == 2
    assert (count == 1).sum() == (before == 1).sum()


def test_what_is_on_one_side_is_not_cut(ground):
    made, levels = cut(ground, np.full((len(ground.points), 1), -1.0), 0)
    assert np.array_equal(made.triangles, ground.triangles)
    assert len(levels) == len(ground.points)
