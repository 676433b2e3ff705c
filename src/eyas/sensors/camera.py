"""The camera: draws the views of N gimbals."""

import math

from eyas.render.renderer import Renderer
from eyas.sensors.config import CameraConfig
from eyas.state.draw import DrawList, DrawStage, Picture, Views

__all__ = ["Camera"]


class Camera:
    """A pinhole camera on each tracker.

    The view has the aspect ratio of the configured picture. Pictures with another aspect ratio show
    the same view distorted, like the original's observations: 320x240 resized to 84x84.

    Args:
        config: Size, field of view, samples.
        renderer: Draws the scene.
    """

    def __init__(self, config: CameraConfig, renderer: Renderer) -> None:
        self.config = config
        self.field_of_view = config.field_of_view
        self.vertical_field_of_view = 2 * math.atan(
            math.tan(config.field_of_view / 2) * config.height / config.width
        )
        self._renderer = renderer

    def read(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw into `picture`.

        Args:
            views: V cameras with the fields of view of this camera.
            draw_list: The moving parts.
            picture: Buffers to draw into, of any size; outputs that are None are not drawn.
            until: Last stage to run, see `Renderer.draw`.
        """
        self._renderer.draw(views, draw_list, picture, self.config.samples, until)
