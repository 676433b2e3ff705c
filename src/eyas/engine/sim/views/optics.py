"""What is modelled of cameras: lenses, shutters, and what becomes of their light."""

from collections.abc import Callable

import numpy as np

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.imager import Spectrum
from eyas.engine.camera.lens import Lenses
from eyas.engine.camera.shutter import Shutter
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.views.camera_model import CameraModel
from eyas.engine.sim.views.thermal_views import ThermalViews


class Optics:
    """What is modelled of N cameras beyond pinholes.

    Attributes:
        lenses: None: they are pinholes that lose no light.
        shutter: None: all rows of a picture see one instant.
        model: What makes pictures of light; None: the renderer.
        thermal: What makes pictures of temperatures; None: they are made of light.

    Args:
        config: The settings.
        assets: Scene, light and renderer.
        hour: Hour of the day; None: the weather's own.
        count: N.
    """

    def __init__(
        self, config: CameraConfig, assets: Assets, hour: float | None, count: int
    ) -> None:
        lighting = assets.lighting
        self.lenses = Lenses.of(config.lens, count)
        self.shutter = Shutter.of(config.shutter, count)
        self.model = CameraModel.of(config, lighting, count, self.lenses, self.shutter)
        self.thermal: ThermalViews | None = None
        if config.spectrum is Spectrum.THERMAL:
            self.thermal = ThermalViews(config.thermal, assets, hour, count)

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
        if self.thermal is not None:
            self.thermal.begin(tracker, stream("thermal"))
