"""How things that stand on a map sway in the wind, and room for it in their boxes."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import GROUP, Geometry
from eyas.engine.render.kernels.visibility.clusters import CLUSTER
from eyas.engine.render.kernels.wind import FARTHEST_LEAN
from eyas.engine.render.pack.boxes import columns_of, group_boxes, posed_boxes
from eyas.engine.state.mesh import Mesh, Surface
from eyas.engine.state.scene import Scene

_ONE_METRE = 1.3
"""Own frequency of a plant of 1 m [1/s]; it falls with the root of the height. So a tree of 16 m
sways at 0.33 Hz, and those of 10 to 25 m that were measured at 0.2 to 0.5 (de Langre, Annual Review
of Fluid Mechanics 40, 2008)."""


def calm() -> NDArray[np.float32]:
    """Return `Light.sway` in calm air."""
    return np.zeros((0, 2), np.float32)


def sway_of(scene: Scene, geometry: Geometry) -> NDArray[np.float32]:
    """Return how fast [1/s] and how far each fixture sways, 0 for those without leaves.

    They turn about their feet: a stand of many trees, which is wide, would rise and sink at its
    edges, so it sways less.

    Args:
        scene: Its fixtures.
        geometry: The same fixtures, in another order.
    """
    has_leaves = np.array([_has_leaves(levels[0]) for levels in scene.fixtures.levels], np.bool_)
    prototype = geometry.fixture_prototype
    box = geometry.box[prototype].astype(np.float64)
    scale = np.sqrt(np.square(geometry.fixture_pose[:, :, 0].astype(np.float64)).sum(axis=1))
    height = np.maximum(scale * box[:, 5], 0.1)
    half = scale * np.maximum(-box[:, :2], box[:, 3:5]).max(axis=1, initial=0.1)
    gain = np.minimum(1.0, 0.5 * height / half) * has_leaves[prototype]
    return np.stack([_ONE_METRE / np.sqrt(height), gain], axis=1).astype(np.float32)


def with_room(geometry: Geometry, sway: NDArray[np.float32]) -> Geometry:
    """Return geometry whose boxes hold all that fixtures that sway may reach."""
    prototype, pose = geometry.fixture_prototype, geometry.fixture_pose
    boxes = posed_boxes(geometry.box[prototype], pose)
    foot = np.tile(pose[:, :, 3], 2)
    reach = FARTHEST_LEAN * sway[:, 1] * np.abs(boxes - foot).max(axis=1, initial=0.0)
    boxes[:, :3] -= reach[:, None]
    boxes[:, 3:] += reach[:, None]
    return geometry._replace(
        fixture_box=columns_of(boxes, GROUP),
        fixture_group_box=columns_of(group_boxes(boxes), CLUSTER),
    )


def _has_leaves(mesh: Mesh) -> bool:
    used = {mesh.palette[k].surface for k in np.unique(mesh.materials).tolist()}
    return bool(used & {Surface.FOLIAGE, Surface.CROWN})
