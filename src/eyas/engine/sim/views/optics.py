"""What is modelled of cameras: lenses, shutters, and what becomes of their light."""

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
from eyas.engine.camera.lens import LensSet
from eyas.engine.camera.link import Link
from eyas.engine.camera.near_infrared import near_infrared
from eyas.engine.camera.shutter import Shutter
from eyas.engine.camera.temperature import SurfaceTemperatures
from eyas.engine.camera.thermal import ThermalConfig, ThermalFrames, ThermalImager, slot_heat
from eyas.engine.camera.tone import ToneCurve
from eyas.engine.core.counter_rng import SEEDS
from eyas.engine.core.variation import sample
from eyas.engine.render.kernels.tent import filter_light, filter_pixels
from eyas.engine.render.outputs import picture_size
from eyas.engine.sim.assets import Assets
from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.scene import ACTOR_OBJECT

Stream = Callable[[str], np.random.Generator]  # Returns the random stream of a part, by its name

# Thermal pictures of trackers: from what the renderer says of each pixel, not from light.


class ThermalViews:
    """The thermal cameras of N trackers."""

    def __init__(
        self,
        config: ThermalConfig,  # The settings
        assets: Assets,  # Scene, light and renderer
        hour: float | None,  # Hour of the day; None: the weather's own
        count: int,  # N
    ) -> None:
        self._temperatures = SurfaceTemperatures(assets.lighting, hour)
        classes = assets.scene.object_class
        self._imager = ThermalImager(config, self._temperatures, classes)
        self._renderer = assets.renderer
        self._fog = float(assets.lighting.fog_density)
        self._seed = np.zeros(count, np.int64)

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        self._seed[tracker] = rng.integers(SEEDS)

    def draw(
        self,
        views: Views,  # V views
        movers: DrawList,  # The moving things
        trackers: NDArray[np.integer],  # The tracker of each view, shape (V,)
        step: NDArray[np.int64],  # Physics steps of each tracker since its reset, shape (N,)
        rgb: NDArray[np.uint8],  # Written, shape (V, H, W, 3)
    ) -> None:
        """Write the pictures of some trackers, grey."""
        slots = np.arange(movers.part.shape[1], dtype=np.int32)
        numbered = np.broadcast_to(ACTOR_OBJECT + slots, movers.part.shape)
        shown = Picture.create(
            len(rgb), *rgb.shape[1:3], rgb=False, depth=True, object_id=True, normal=True
        )
        numbers = replace(movers, object_id=np.ascontiguousarray(numbered))
        self._renderer.draw(views, numbers, shown)
        assert shown.object_id is not None
        assert shown.depth is not None
        assert shown.normal is not None
        fog = np.full(len(rgb), self._fog, np.float32)
        frames = ThermalFrames(
            object_id=shown.object_id,
            depth=shown.depth,
            normal=shown.normal,
            eye=views.position,
            rotation=views.rotation,
            ray=1.0 / views.focal(*picture_size(shown)),
            lens=np.zeros((0, 10)) if views.lens is None else views.lens,
            world=views.world,
            heat=slot_heat(movers, self._renderer.part_reach(), self._temperatures.air),
            fog=fog if views.light is None else views.light.fog_density,
            seed=self._seed[trackers],
            step=step[trackers],
        )
        self._imager.measure(frames, rgb)


# Pictures of trackers as a real camera gives them, from the radiances that the renderer draws.


class CameraModel:
    """The cameras of N trackers where more is modelled of them than a pinhole.

    Attributes:
        development: Their sensors; None: they have none.
    """

    def __init__(
        self,
        config: CameraConfig,  # The settings
        lighting: Lighting,  # Light and air of the weather
        count: int,  # N
        lenses: LensSet | None = None,  # Their lenses; None: they lose no light
        # Their shutters, which stay open as long as the sensors are exposed; None: an instant
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
        self._tent = config.tent
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
        lenses: LensSet | None = None,
        shutter: Shutter | None = None,
    ) -> "CameraModel | None":
        """Return the camera model of some settings; None: the renderer's pictures are shown."""
        return cls(config, lighting, count, lenses, shutter) if config.is_modelled else None

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        if self._defocus is not None:
            self._blur[tracker] = sample(self._defocus, rng)
        # Each part has a stream of its own: one more changes nothing in the others.
        parts, seed = (self.development, self._dirt, self._link), rng.bit_generator.seed_seq
        assert isinstance(seed, np.random.SeedSequence)
        for part, own in zip(parts, seed.spawn(len(parts)), strict=True):
            if part is not None:
                part.begin(tracker, np.random.Generator(np.random.PCG64(own)))

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
        if self._tent and self.development is not None:
            filter_light(light)
        if self._lenses is not None:
            light = change_light(light, trackers, self._lenses)
        if self._defocus is not None:
            light = defocused(light, self._blur[trackers] * light.shape[2])
        if self._dirt is not None:
            self._dirt.cover(light, trackers)
        if self.development is None:
            self._curve.develop(light, picture.rgb)
            if self._tent:  # bytes, as the renderer does
                filter_pixels(picture.rgb)
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


class Optics:
    """What is modelled of N cameras beyond pinholes.

    Attributes:
        lenses: None: they are pinholes that lose no light.
        shutter: None: all rows of a picture see one instant.
        model: What makes pictures of light; None: the renderer.
        thermal: What makes pictures of temperatures; None: they are made of light.
    """

    def __init__(
        self,
        config: CameraConfig,  # The settings
        assets: Assets,  # Scene, light and renderer
        hour: float | None,  # Hour of the day; None: the weather's own
        count: int,  # N
    ) -> None:
        lighting = assets.lighting
        self.lenses = LensSet.of(config.lens, count)
        self.shutter = Shutter.of(config.shutter, count)
        self.model = CameraModel.of(config, lighting, count, self.lenses, self.shutter)
        self.thermal: ThermalViews | None = None
        if config.spectrum is Spectrum.THERMAL:
            self.thermal = ThermalViews(config.thermal, assets, hour, count)
        self._begun: dict[int, Stream] = {}  # Streams of episodes that no picture has shown yet

    @property
    def bent(self) -> LensSet | None:
        """The lenses, if they bend pictures."""
        return self.lenses if self.lenses is not None and self.lenses.bend else None

    def begin(self, tracker: int, stream: Stream) -> None:
        """Begin an episode.

        Args:
            tracker: The tracker.
            stream: Returns the random stream of a part, by its name.
        """
        if self.lenses is not None and self.lenses.vary:
            self.lenses.begin(tracker, stream("lens"))
        self._begun[tracker] = stream

    def ready(self) -> None:
        """Sample what only pictures show of the episodes that have begun since the last call."""
        while self._begun:
            self._sample(*self._begun.popitem())

    def _sample(self, tracker: int, stream: Stream) -> None:
        if self.shutter is not None:
            self.shutter.begin(tracker, stream("shutter"))
        if self.model is not None:
            self.model.begin(tracker, stream("camera"))
        if self.thermal is not None:
            self.thermal.begin(tracker, stream("thermal"))
