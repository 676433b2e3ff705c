"""The camera: draws the views of N gimbals."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.pinhole import field_along
from eyas.render.renderer import Renderer
from eyas.sensors.config import CameraConfig
from eyas.state.draw import DrawList, DrawStage, Picture, Views

__all__ = ["Camera"]


class Camera:
    """A pinhole camera on each tracker.

    The view has the aspect ratio of the configured picture. Pictures with another aspect ratio show
    the same view distorted, like the original's observations: 320x240 resized to 84x84.

    Attributes:
        aspect: Height of the view over its width.

    Args:
        config: Size, field of view, samples.
        renderer: Draws the scene.
    """

    def __init__(self, config: CameraConfig, renderer: Renderer) -> None:
        self.config = config
        self.aspect = config.height / config.width
        self._renderer = renderer

    def vertical(self, fields: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the vertical field of view for each horizontal one [rad], shape (V,)."""
        return np.array([field_along(field, self.aspect) for field in fields.tolist()])

    def read(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw into `picture`.

        Args:
            views: V cameras, with the fields of view of their trackers.
            draw_list: The moving parts.
            picture: Buffers to draw into, of any size; outputs that are None are not drawn.
            until: Last stage to run, see `Renderer.draw`.
        """
        self._renderer.draw(views, draw_list, picture, self.config.samples, until)
