"""Settings of the sensors."""

import re
from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.core.config import Config
from eyas.engine.core.own_code import NAMES_CODE
from eyas.engine.core.variation import Variation, bounds, within
from eyas.engine.sensors.camera.dirt import DirtConfig
from eyas.engine.sensors.camera.events import EventsConfig
from eyas.engine.sensors.camera.exposure import ExposureConfig
from eyas.engine.sensors.camera.imager import ImagerConfig, Spectrum
from eyas.engine.sensors.camera.lens import LensConfig
from eyas.engine.sensors.camera.link import LinkConfig
from eyas.engine.sensors.camera.models import MODELS, ModelName, laid_under, without
from eyas.engine.sensors.camera.shutter import ShutterConfig
from eyas.engine.sensors.camera.thermal import ThermalConfig
from eyas.engine.sensors.camera.vibration import VibrationConfig

__all__ = [
    "CameraConfig",
    "CameraErrors",
    "ColourLayout",
    "Colours",
    "FurtherCameraConfig",
    "FurtherSensorConfig",
    "LidarConfig",
    "MountConfig",
    "ReadingConfig",
    "SensorsConfig",
]

Share = Annotated[float, Field(ge=0, le=1)]
Metres = Annotated[float, Field(ge=-100, le=100)]
Angle = Annotated[float, Field(ge=-6.3, le=6.3)]
Deviation = Annotated[float, Field(ge=0, le=1e6)]


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
    """Horizontal [rad]; a variation is sampled anew for each tracker at each reset."""
    samples: Literal[1, 2, 4] = 1
    """Samples per pixel."""
    mount: MountConfig | None = None
    """Where it is fixed to the body, so that it tilts with it; None: the tracker carries it, on a
    drone by a gimbal."""
    model: ModelName | None = None
    """A camera by its data sheets, whose values take the place of defaults below; None: none."""
    spectrum: Spectrum = Spectrum.COLOUR
    """What light its sensor tells apart: `colour`, `grey`, `near-infrared`, of which the last two
    have a sensor with or without `imager`, or `thermal`, whose sensor is `thermal`."""
    thermal: ThermalConfig = ThermalConfig()
    """The sensor of a thermal camera."""
    imager: ImagerConfig | None = None
    """The sensor, which counts photons; None: pictures without noise, as bright as by day."""
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


class LidarConfig(Config):
    """The lidar, by default an RpLidarA2 as on the original's tracker."""

    enabled: bool = False
    """Whether the tracker has one; the original's `Lidar_Enable`."""
    points: Annotated[int, Field(ge=1, le=10_000)] = 400
    """Points of a turn; radar packets have five numbers for each."""
    frequency: Annotated[float, Field(gt=0, le=500)] = 12.0
    """Turns per second, its rate [Hz]."""
    mount: MountConfig | None = None
    """Where it is fixed to the body; None: where the original has it, 3.1 cm above the middle of a
    drone, or 10 cm behind that of a car."""
    min_range: Annotated[float, Field(ge=0, le=1e3)] = 0.2
    """Shortest distance that is measured [m]."""
    max_range: Annotated[float, Field(gt=0, le=1e3)] = 12.0
    """Longest distance that is measured [m]."""
    noise: Deviation = 0.01
    """Standard deviation of a distance [m]."""
    bias: Deviation = 0.0
    """Standard deviation of the constant error of all distances, sampled for each episode [m]."""
    delay_steps: Annotated[int, Field(ge=0, le=500)] = 0
    """Age of the newest point when it is told, in steps of 2 ms."""
    resolution: Annotated[float, Field(ge=0, le=10)] = 0.01
    """Distances are multiples of this [m]; 0: they are not rounded."""
    drop_out: Share = 0.0
    """Probability that a point that should be measured is missing."""

    @model_validator(mode="after")
    def _ranges_in_order(self) -> Self:
        if self.min_range >= self.max_range:
            raise ValueError(f"min_range must be below max_range, which is {self.max_range:g} m")
        return self


class ReadingConfig(Config):
    """Errors of one sensor; by default it reads the truth at each physics step. Those of the lidar
    have the same names (`LidarConfig`).
    """

    rate: Annotated[float, Field(gt=0, le=500)] = 500.0
    """Readings per second [Hz]; in between, the last one is told."""
    noise: Deviation = 0.0
    """Standard deviation of each number of a reading, in its unit."""
    bias: Deviation = 0.0
    """Standard deviation of the constant error that is sampled for each number and episode."""
    delay_steps: Annotated[int, Field(ge=0, le=500)] = 0
    """Age of a reading when it is told, in steps of 2 ms."""
    drop_out: Share = 0.0
    """Probability that a reading is missing, so that the last one is told again."""


class FurtherSensorConfig(ReadingConfig):
    """A sensor that a tracker has beside the original's, and its errors: `{"sensor": "compass",
    "noise": 0.0012}`, or its name alone.
    """

    named_by: ClassVar[str] = "sensor"
    sensor: Annotated[str, Field(min_length=1), NAMES_CODE]
    """`compass`, `barometer`, or one of your own, `package.module:attribute`."""
    settings: dict[str, Annotated[float, Field(ge=-1e12, le=1e12)]] = Field(default_factory=dict)
    """Values of the sensor's own settings."""

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, given: Any) -> Any:  # noqa: ANN401  # whatever is given
        return {cls.named_by: given} if isinstance(given, str) else given


class CameraErrors(ReadingConfig):
    """Errors of the camera; by default there is a picture of each physics step, without noise."""

    noise: Annotated[float, Field(ge=0, le=255)] = 0.0
    """Standard deviation of each channel of each pixel, of 255."""
    bias: Annotated[float, Field(ge=0, le=255)] = 0.0
    """Standard deviation of the constant error that is sampled for each channel and episode, of
    255."""


class SensorsConfig(Config):
    """Errors of the sensors, by default none, and further sensors."""

    gps_position: ReadingConfig = ReadingConfig()
    """GPS: position [m]."""
    gps_velocity: ReadingConfig = ReadingConfig()
    """GPS: velocity [m/s]."""
    accelerometer: ReadingConfig = ReadingConfig()
    """Felt acceleration [m/s^2]."""
    gyroscope: ReadingConfig = ReadingConfig()
    """Angular velocity [rad/s]."""
    imu: ReadingConfig = ReadingConfig()
    """Attitude: Euler angles [rad], and the same as a quaternion."""
    camera: CameraErrors = CameraErrors()
    """Pictures."""
    further: tuple[FurtherSensorConfig, ...] = ()
    """Sensors that trackers have besides, in the table `eyas.engine.sensors.table` or of your
    own.
    """
