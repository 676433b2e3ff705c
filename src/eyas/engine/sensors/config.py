"""Settings of the sensors."""

from typing import Annotated, Any, ClassVar, Self

from pydantic import Field, model_validator

from eyas.engine.camera.config import MountConfig
from eyas.engine.core.config import Config
from eyas.engine.core.named_code import NAMES_CODE

Share = Annotated[float, Field(ge=0, le=1)]
Deviation = Annotated[float, Field(ge=0, le=1e6)]


class LidarConfig(Config):
    """The lidar, by default an RpLidarA2 as on the original's tracker."""

    enabled: bool = False
    """Whether the tracker has one; the original's `Lidar_Enable`."""
    points: Annotated[int, Field(ge=1, le=10_000)] = 400
    """Points of a turn; radar packets have five numbers for each."""
    frequency: Annotated[float, Field(gt=0, le=500)] = 12.0
    """Turns per second, its rate [Hz]."""
    mount: MountConfig | None = None
    """Where it is fixed to the body [m], and how it is turned [rad], by yaw, then pitch (positive
    down), then roll. `null`: where the original has it, 3.1 cm above the middle of a drone, or 10
    cm behind that of a car."""
    min_range: Annotated[float, Field(ge=0, le=1e3)] = 0.2
    """Shortest distance that is measured [m]."""
    max_range: Annotated[float, Field(gt=0, le=1e3)] = 12.0
    """Longest distance that is measured [m]."""
    noise: Deviation = 0.01
    """Standard deviation of a distance [m]."""
    bias: Deviation = 0.0
    """Standard deviation of the constant error of all distances, sampled for each episode [m]."""
    delay_steps: Annotated[int, Field(ge=0, le=500)] = 0
    """Age of the newest point when it is delivered, in steps of 2 ms."""
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
    """Readings per second [Hz]; in between, the last one is repeated."""
    noise: Deviation = 0.0
    """Standard deviation of each number of a reading, in its unit."""
    bias: Deviation = 0.0
    """Standard deviation of the constant error that is sampled for each number and episode."""
    delay_steps: Annotated[int, Field(ge=0, le=500)] = 0
    """Age of a reading when it is delivered, in steps of 2 ms."""
    drop_out: Share = 0.0
    """Probability that a reading is missing, so that the last one is repeated."""


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
    """Further sensors of trackers: `compass`, `barometer`, or one of your own as
    `my_package.module:ATTRIBUTE`, see docs/sensors.md. Each entry is a name, or an object with
    the keys below."""
