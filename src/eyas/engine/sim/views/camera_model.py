"""Pictures of trackers as a real camera gives them, from the radiances that the renderer draws."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.defocus import defocused
from eyas.engine.camera.development import Development
from eyas.engine.camera.dirt import Dirt
from eyas.engine.camera.glass import change_light
from eyas.engine.camera.imager import Spectrum
from eyas.engine.camera.lens import Lenses
from eyas.engine.camera.link import Link
from eyas.engine.camera.near_infrared import near_infrared
from eyas.engine.camera.shutter import Shutter
from eyas.engine.camera.tone import ToneCurve
from eyas.engine.core.variation import sample
from eyas.engine.render.outputs import picture_size
from eyas.engine.state.draw import Picture
from eyas.engine.state.lighting import Lighting


class CameraModel:
    """The cameras of N trackers where more is modelled of them than a pinhole.

    Attributes:
        development: Their sensors; None: they have none.

    Args:
        config: The settings.
        lighting: Light and air of the weather.
        count: N.
        lenses: Their lenses; None: they lose no light.
        shutter: Their shutters, which stay open as long as the sensors are exposed; None: an
            instant.
    """

    def __init__(
        self,
        config: CameraConfig,
        lighting: Lighting,
        count: int,
        lenses: Lenses | None = None,
        shutter: Shutter | None = None,
    ) -> None:
        sensor = config.sensor
        self._lenses = lenses if lenses is not None and lenses.change_light else None
        self._shutter = shutter if config.shutter.blur else None
        self._dirt: Dirt | None = None
        self._link: Link | None = None
        self._defocus = config.defocus if config.is_defocused else None
        self._blur = np.zeros(count)
        self._memory = np.empty((0, 3, 0, 0), np.float32)
        self._curve = ToneCurve(lighting.exposure)
        self._infrared = config.spectrum is Spectrum.NEAR_INFRARED
        self.development: Development | None = None
        if sensor is not None:
            self.development = Development(
                sensor, config.exposure, config.spectrum, lighting.luminance, count
            )
        if config.dirt is not None:
            falling = max(lighting.flakes, lighting.rain)
            self._dirt = Dirt(config.dirt, falling, count)
        if config.link is not None:
            self._link = Link(config.link, count)

    @classmethod
    def of(
        cls,
        config: CameraConfig,
        lighting: Lighting,
        count: int,
        lenses: Lenses | None = None,
        shutter: Shutter | None = None,
    ) -> "CameraModel | None":
        """Return the camera model of some settings; None: the renderer's pictures are shown."""
        return cls(config, lighting, count, lenses, shutter) if config.is_modelled else None

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        if self._defocus is not None:
            self._blur[tracker] = sample(self._defocus, rng)
        # Each part has a stream of its own: one more changes nothing in the others.
        parts = self.development, self._dirt, self._link
        for part, own in zip(parts, rng.spawn(len(parts)), strict=True):
            if part is not None:
                part.begin(tracker, own)

    def draw(
        self,
        # Draws the views of these trackers into the arrays of a picture
        draw: Callable[[Picture], None],
        trackers: NDArray[np.int32],  # The tracker of each of V views, shape (V,)
        step: NDArray[np.int64],  # Physics steps of each tracker since its reset, shape (N,)
        picture: Picture,  # V pictures, with colours
    ) -> None:
        """Draw the pictures of some trackers."""
        assert picture.rgb is not None
        if self.development is not None:
            self.development.expose(trackers, step)
            if self._shutter is not None:
                self._shutter.exposure[trackers] = self.development.exposure.time[trackers]
        light = self._memory_for(len(trackers), *picture_size(picture))
        seen = replace(picture, rgb=None, radiance=light)
        if self._infrared and seen.class_id is None:
            seen.class_id = np.empty((len(light), *light.shape[2:]), np.uint8)
        draw(seen)
        if self._infrared:
            assert seen.class_id is not None
            near_infrared(light, seen.class_id)
        if self._lenses is not None:
            light = change_light(light, trackers, self._lenses)
        if self._defocus is not None:
            light = defocused(light, self._blur[trackers] * light.shape[2])
        if self._dirt is not None:
            self._dirt.cover(light, trackers)
        if self.development is None:
            self._curve.develop(light, picture.rgb)
        else:
            self.development.develop(light, picture.rgb, trackers, step)
        self.send(trackers, step, picture.rgb)

    def _memory_for(self, views: int, height: int, width: int) -> NDArray[np.float32]:
        """Return memory for the light of pictures, mostly that of the last call."""
        if self._memory.shape[2:] != (height, width) or len(self._memory) < views:
            self._memory = np.empty((views, 3, height, width), np.float32)
        return self._memory[:views]

    def send(
        self, trackers: NDArray[np.int32], step: NDArray[np.int64], rgb: NDArray[np.uint8]
    ) -> None:
        """Change pictures to what their link makes of them, if they have one; see `draw`."""
        if self._link is not None:
            self._link.carry(rgb, trackers, step)
