"""The camera: draws what N gimbals look at."""

import math

from eyas.render.renderer import Renderer
from eyas.sensors.config import CameraConfig
from eyas.state.draw import DrawList, DrawStage, Picture, Views

__all__ = ["Camera"]


class Camera:
    """A pinhole camera on each tracker.

    The view has the shape of the configured picture. Pictures of another shape squeeze that view,
    as the original's observations do: 320x240 resized to 84x84.

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
            views: V cameras with this one's fields of view.
            draw_list: The moving parts.
            picture: Where to, of any size; what is None is not drawn.
            until: Where to stop, see `Renderer.draw`.
        """
        self._renderer.draw(views, draw_list, picture, self.config.samples, until)
