"""What is modelled of the cameras of one name: lenses, shutters, and what becomes of their light."""

from collections.abc import Callable

import numpy as np

from eyas.sensors.camera.lens import Lenses
from eyas.sensors.camera.shutter import Shutter
from eyas.sensors.config import CameraConfig
from eyas.sim.views.camera_model import CameraModel
from eyas.state.lighting import Lighting

__all__ = ["Optics"]


class Optics:
    """What is modelled of N cameras beyond pinholes.

    Attributes:
        lenses: None: they are pinholes that lose no light.
        shutter: None: all rows of a picture see one instant.
        model: What makes pictures of light; None: the renderer.

    Args:
        config: The settings.
        lighting: Light and air of the weather.
        count: N.
    """

    def __init__(self, config: CameraConfig, lighting: Lighting, count: int) -> None:
        self.lenses = Lenses.of(config.lens, count)
        self.shutter = Shutter.of(config.shutter, count)
        self.model = CameraModel.of(config, lighting, count, self.lenses, self.shutter)

    @property
    def bent(self) -> Lenses | None:
        """The lenses, if they bend pictures."""
        return self.lenses if self.lenses is not None and self.lenses.bend else None

    def begin(self, tracker: int, stream: Callable[[str], np.random.Generator]) -> None:
        """Begin an episode.

        Args:
            tracker: The tracker.
            stream: Returns the random stream of a part, by its name.
        """
        if self.lenses is not None and self.lenses.vary:
            self.lenses.begin(tracker, stream("lens"))
        if self.shutter is not None:
            self.shutter.begin(tracker, stream("shutter"))
        if self.model is not None:
            self.model.begin(tracker, stream("camera"))
