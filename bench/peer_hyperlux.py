"""HyperLux on the processor: the map in glTF, as `eyas maps export` writes it, at its finest level,
with its textures, without cars and shadows.

It traces rays, and is compiled for these settings when it is first used, with CMake and a C++
compiler, for which it downloads sources: HYPERLUX_BACKEND=GENERIC chooses the processor.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import hyperlux
import numpy as np
from city import City
from hyperlux.camera import RGB, CameraSpec

from eyas.engine.sim.config import SimConfig
from eyas.maps.formats.gltf.world import write_gltf

_AXES = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Turns our axes into HyperLux' of a file in glTF: x is there what looks along z in the file."""


class Peer:
    """Draws all views in one call."""

    name = "HyperLux on the processor (no cars, no shadows)"

    def __init__(self, city: City, side: int) -> None:
        count = len(city.views.position)
        spec = CameraSpec("drone", (RGB("rgba8"),))
        self._renderer = hyperlux.HyperLux(
            width=side, height=side, batch_size=count, cameras=(spec,), fidelity="high"
        )
        with TemporaryDirectory() as folder:
            path = Path(folder, "city.glb")
            write_gltf(SimConfig().world.map, 0, path, 0, lamps=False)
            self._scene = hyperlux.load_scene(str(path), fidelity="high")
        self._renderer.init(self._scene)
        self._renderer.set_cameras(_cameras(city))
        self._across, self._side = int(np.sqrt(count)), side

    def draw(self) -> None:
        """Draw all views into `rgb`, the first at its lower left."""
        self._renderer.render()
        tiles = self._renderer.outputs[RGB("rgba8")].read()[: self._across**2, ..., :3]
        rows = tiles.reshape(self._across, self._across, self._side, self._side, 3)
        size = self._across * self._side
        self.rgb = rows.swapaxes(1, 2).reshape(size, size, 3)


def _cameras(city: City) -> np.ndarray:
    """Return place, ray of the upper left corner, and its changes to the right and downwards, for
    each view, shape (N, 12).
    """
    views = city.views
    assert views.vertical_field_of_view is not None
    forward, left, up = (views.rotation[:, :, axis] for axis in range(3))
    left = left * np.tan(views.field_of_view / 2.0)
    up = up * np.tan(views.vertical_field_of_view / 2.0)
    rows = (views.position, forward + left + up, -2.0 * left, -2.0 * up)
    return np.concatenate([row @ _AXES.T for row in rows], axis=1).astype(np.float32)
