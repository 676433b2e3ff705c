"""Pictures of trackers as a real camera gives them, from the radiances that the renderer draws."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.render.outputs import picture_size
from eyas.sensors.camera.tone import ToneCurve
from eyas.sensors.config import CameraConfig
from eyas.state.draw import Picture
from eyas.state.lighting import Lighting

__all__ = ["CameraModel"]


class CameraModel:
    """The cameras of N trackers where more is modelled of them than a pinhole.

    Args:
        config: The settings.
        lighting: Light and air of the weather.
        count: N.
    """

    def __init__(self, config: CameraConfig, lighting: Lighting, count: int) -> None:
        self._curve = ToneCurve(lighting.exposure)

    @classmethod
    def of(cls, config: CameraConfig, lighting: Lighting, count: int) -> "CameraModel | None":
        """Return the camera model of some settings; None: it is a pinhole camera without errors."""
        return cls(config, lighting, count) if config.is_modelled else None

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""

    def draw(
        self,
        draw: Callable[[Picture], None],
        trackers: NDArray[np.int32],
        step: NDArray[np.int64],
        picture: Picture,
    ) -> None:
        """Draw the pictures of some trackers.

        Args:
            draw: Draws the views of these trackers into the arrays of a picture.
            trackers: The tracker of each of V views, shape (V,).
            step: Physics steps of each tracker since its reset, shape (N,).
            picture: V pictures, with colours.
        """
        assert picture.rgb is not None
        light = np.empty((len(trackers), 3, *picture_size(picture)), np.float32)
        draw(replace(picture, rgb=None, radiance=light))
        self._curve.develop(light, picture.rgb)
