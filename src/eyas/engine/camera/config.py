"""Settings of cameras."""

import re
from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.camera.dirt import DirtConfig
from eyas.engine.camera.events import EventsConfig
from eyas.engine.camera.exposure import ExposureConfig
from eyas.engine.camera.imager import ImagerConfig, Spectrum
from eyas.engine.camera.lens import LensConfig
from eyas.engine.camera.link import LinkConfig
from eyas.engine.camera.models import MODELS, ModelName, laid_under, without
from eyas.engine.camera.shutter import ShutterConfig
from eyas.engine.camera.thermal import ThermalConfig
from eyas.engine.camera.vibration import VibrationConfig
from eyas.engine.core.config import Config
from eyas.engine.core.variation import Variation, bounds, within

Metres = Annotated[float, Field(ge=-100, le=100)]
Angle = Annotated[float, Field(ge=-6.3, le=6.3)]


class Colours(StrEnum):
    """Channels of a picture."""

    RGB = "rgb"
    GREY = "grey"


class ColourLayout(StrEnum):
    """Order of the axes of a picture."""

    HWC = "hwc"
    CHW = "chw"


class MountConfig(Config):
    """Where a sensor is fixed to the body, and how it is turned: by yaw, then pitch, then roll."""

    x: Metres = 0.0
    """Ahead of the body's middle [m]."""
    y: Metres = 0.0
    """Left of it [m]."""
    z: Metres = 0.0
    """Above it [m]."""
    roll: Angle = 0.0
    """[rad]"""
    pitch: Angle = 0.0
    """Positive down [rad]."""
    yaw: Angle = 0.0
    """Counter-clockwise [rad]."""


class CameraConfig(Config):
    """A camera; by default a pinhole camera without distortion, noise or blur."""

    width: Annotated[int, Field(ge=8, le=8192)] = 320
    """[pixels]"""
    height: Annotated[int, Field(ge=8, le=8192)] = 240
    """[pixels]"""
    field_of_view: Annotated[Variation, AfterValidator(within(0.05, 2.8))] = 0.7854
    """Horizontal [rad]; sampled for each tracker at each reset. Rewards, packets, labels and
    overlays use that of their tracker."""
    samples: Literal[1, 2, 4] = 1
    """Samples for each pixel: in its middle, one above the other, or two by two, for 1, 1.45 and
    2.3 times the time at 84x84."""
    pixel_filter: Literal["box", "tent"] | None = None
    """What a pixel is the mean of: its samples (`box`), or those of its neighbours, too, by a
    quarter from either side along rows and along columns (`tent`); null: `tent` where it has
    fewer than four samples. See what flickers (docs/camera/further.md)."""
    mount: MountConfig | None = None
    """Where it is fixed to the body, so that it tilts with it; `start.pitch` still says where the
    tracker starts. `null`: the gimbal carries it, or whatever the tracker has."""
    model: ModelName | None = None
    """A camera by its data sheets, see docs/camera/exposure.md: its values stand wherever a
    setting below has its default. `null`: none."""
    spectrum: Spectrum = Spectrum.COLOUR
    """What light its sensor sees: `colour`, `grey`, `near-infrared`, of which the last two
    have a sensor with or without `imager`, or `thermal`, whose sensor is `thermal`."""
    thermal: ThermalConfig = ThermalConfig()
    """The sensor of a thermal camera."""
    imager: ImagerConfig | None = None
    """The sensor, which counts photons; `{}` has the defaults. `null`: pictures without noise, as
    bright as their weather is drawn."""
    exposure: ExposureConfig = ExposureConfig()
    """How the sensor is exposed."""
    dirt: DirtConfig | None = None
    """What sticks to the glass in front; None: nothing."""
    link: LinkConfig | None = None
    """What carries its pictures; None: nothing is coded or lost."""
    lens: LensConfig = LensConfig()
    """How its lens bends, darkens and colours pictures."""
    defocus: Annotated[Variation, AfterValidator(within(0.0, 0.3))] = 0.0
    """Diameter of the disc that a point becomes out of focus, as a share of the picture's height;
    0: all is sharp. Sampled at each reset."""
    shutter: ShutterConfig = ShutterConfig()
    """Motion blur and rolling shutter."""
    vibration: VibrationConfig = VibrationConfig()
    """What a gimbal leaves of the shaking of its body."""
    events: EventsConfig = EventsConfig()
    """An event camera with the same lens."""

    @property
    def needs_velocities(self) -> bool:
        """Whether the velocities of cameras must be known."""
        return self.shutter.blur or self.shutter.rolls or self.events.enabled

    @property
    def tent(self) -> bool:
        """Whether pictures go through a tent filter."""
        return self.samples < 4 if self.pixel_filter is None else self.pixel_filter == "tent"

    @property
    def sensor(self) -> ImagerConfig | None:
        """The sensor, None if pictures are drawn without one."""
        if self.spectrum is Spectrum.THERMAL:
            return None
        if self.imager is None and self.spectrum is not Spectrum.COLOUR:
            return ImagerConfig()
        return self.imager

    @property
    def is_defocused(self) -> bool:
        """Whether it may be out of focus."""
        return bounds(self.defocus)[1] > 0.0

    @property
    def is_modelled(self) -> bool:
        """Whether more of it is modelled than a pinhole, bent by a lens or not."""
        parts = (self.sensor, self.dirt, self.link)
        blurred = self.shutter.blur or self.lens.changes_light or self.is_defocused
        return blurred or any(part is not None for part in parts)

    @model_validator(mode="before")
    @classmethod
    def _with_model(cls, values: Any) -> Any:  # noqa: ANN401  # whatever is given
        model = values.get("model") if isinstance(values, Mapping) else None
        under = MODELS.get(model) if isinstance(model, str) else None  # type: ignore[call-overload]
        return values if under is None else laid_under(cls, under, values)

    @model_validator(mode="after")
    def _thermal_alone(self) -> Self:
        if self.spectrum is not Spectrum.THERMAL:
            return self
        for name, set_ in (
            ("imager", self.imager is not None),
            ("lens.vignetting, lens.red and lens.blue", self.lens.changes_light),
            ("shutter", self.shutter.blur or self.shutter.rolls),
            ("dirt", self.dirt is not None),
        ):
            if set_:
                raise ValueError(f"{name} must be left out where spectrum is 'thermal'")
        return self

    def kept(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values that stay; those of a model go with it."""
        if self.model is None or changes.get("model", self.model) == self.model:
            return super().kept(changes)
        return without(self, MODELS[self.model])


def _camera_name(name: str) -> str:
    if not re.fullmatch(r"[a-z][a-z0-9_-]{0,31}", name):
        raise ValueError("must be a small letter, then up to 31 small letters, digits, '-' and '_'")
    return name


class FurtherCameraConfig(CameraConfig):
    """A camera that a tracker has beside its own, such as the other eye of a stereo pair:
    `{"name": "right", "mount": {"y": -0.12}}`. Its `mount` says where it is on what carries it.
    """

    name: Annotated[str, AfterValidator(_camera_name)]
    """By which it is known: lower-case letters, digits, hyphens and underscores."""
    on: Literal["camera", "body"] = "camera"
    """What carries it: the tracker's camera, with which it turns, or the tracker's body."""

    @model_validator(mode="after")
    def _no_events(self) -> Self:
        if self.events.enabled:
            raise ValueError("events: only a tracker's own camera has an event camera beside it")
        return self
