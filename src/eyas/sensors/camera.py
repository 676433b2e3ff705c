"""The camera: draws what N gimbals look at."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.render.kernels.bundles import Stage
from eyas.render.renderer import Renderer
from eyas.sensors.config import CameraConfig
from eyas.state.draw import DrawList, Picture, Views
from eyas.state.tracker import CameraPose

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
        self.vertical_field_of_view = 2 * math.atan(
            math.tan(config.field_of_view / 2) * config.height / config.width
        )
        self._renderer = renderer

    def read(
        self,
        pose: CameraPose,
        world: NDArray[np.int32],
        subject: NDArray[np.int32],
        light: NDArray[np.float32] | None,
        instant: NDArray[np.float64] | None,
        draw_list: DrawList,
        picture: Picture,
        until: Stage = Stage.SHADING,
    ) -> Views:
        """Draw into `picture`, and return the views that were drawn.

        Args:
            pose: V cameras.
            world: Which world of the draw list each sees, shape (V,).
            subject: Object id each is about, or -1, shape (V,).
            light: What each changes of the weather's light, see `Views`.
            instant: Time of what falls through the air [s], see `Views`.
            draw_list: The moving parts.
            picture: Where to, of any size; what is None is not drawn.
            until: Where to stop, see `Renderer.draw`.
        """
        views = Views(
            position=pose.position,
            rotation=pose.rotation,
            world=world,
            subject=subject,
            field_of_view=self.config.field_of_view,
            vertical_field_of_view=self.vertical_field_of_view,
            light=light,
            instant=instant,
        )
        self._renderer.draw(views, draw_list, picture, self.config.samples, until)
        return views
