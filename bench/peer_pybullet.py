"""pybullet's TinyRenderer, which gym-pybullet-drones draws with where there is no card: the same
triangles in one grey, without textures, fog and shadows, a picture at a time.
"""

import numpy as np
import pybullet
from city import Batch, City, projection

_MOST = 120_000  # Corners of a shape: pybullet takes no more than 131,072


class Peer:
    """Draws the views one after the other."""

    name = "pybullet, TinyRenderer (no textures, no shadows)"

    def __init__(self, city: City, side: int) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._add(city.static, np.eye(3, 4))
        for batch, poses in zip(city.parts, city.slots, strict=True):
            for pose in poses:
                self._add(batch, pose)
        self._side = side
        views, clips = city.views, projection(city.views, side, side)
        looks = np.tile(np.eye(4), (len(clips), 1, 1))
        axes = (-views.rotation[:, :, 1], views.rotation[:, :, 2], -views.rotation[:, :, 0])
        looks[:, :3, :3] = np.stack(axes, axis=1)
        looks[:, :3, 3] = -np.einsum("vij,vj->vi", looks[:, :3, :3], views.position)
        self._looks = [look.T.ravel().tolist() for look in looks]
        self._lens = (clips[0] @ np.linalg.inv(looks[0])).T.ravel().tolist()
        across = int(np.sqrt(len(looks)))
        self.rgb = np.zeros((across * side, across * side, 3), np.uint8)

    def _add(self, batch: Batch, pose: np.ndarray) -> None:
        """Add a body for each run of triangles that pybullet takes at once."""
        positions = batch.positions @ pose[:, :3].T + pose[:, 3]
        normals = batch.normals @ pose[:, :3].T
        for first in range(0, len(positions), _MOST):
            chosen = slice(first, first + _MOST)
            shape = pybullet.createVisualShape(
                pybullet.GEOM_MESH,
                vertices=positions[chosen].tolist(),
                indices=list(range(len(positions[chosen]))),
                normals=normals[chosen].tolist(),
                rgbaColor=[0.5, 0.5, 0.5, 1.0],
            )
            pybullet.createMultiBody(baseVisualShapeIndex=shape)

    def draw(self) -> None:
        """Draw all views into `rgb`, the first at its lower left."""
        side, across = self._side, len(self.rgb) // self._side
        for number, look in enumerate(self._looks):
            _, _, rgba, _, _ = pybullet.getCameraImage(
                side, side, look, self._lens, shadow=0, renderer=pybullet.ER_TINY_RENDERER,
                flags=pybullet.ER_NO_SEGMENTATION_MASK,
            )  # fmt: skip
            row, column = divmod(number, across)
            tile = np.asarray(rgba, np.uint8).reshape(side, side, 4)[::-1, :, :3]
            self.rgb[row * side :, column * side :][:side, :side] = tile
