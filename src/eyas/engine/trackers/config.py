"""Settings of the tracker."""

from enum import StrEnum
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.core.config import Config
from eyas.engine.core.named_code import NAMES_CODE
from eyas.engine.core.variation import Variation, bounds, within


class TrackerKind(StrEnum):
    """Kinds of trackers."""

    DRONE = "drone"  # A quadrotor with a camera on a gimbal
    CAR = "car"  # An ideal robot that keeps its height over the ground


class Flight(StrEnum):
    """What a flown drone does where a rotor or its gimbal is at a limit."""

    MENDED = "mended"
    """Rotors that would have to pull down raise all four, which keeps the torque; the gimbal looks
    past straight down, and none of its joints swings round."""
    ORIGINAL = "original"
    """As in the original's code: the torque is not kept, and near straight down the joints of yaw
    and roll swing round."""


class AirframeName(StrEnum):
    """Airframes of the flown drone, by size of their propellers."""

    M100 = "m100"  # The original's: 3.0 kg, 13 inches.
    INCH_5 = "5-inch"  # A racer: 0.75 kg, 4.6 times its weight of thrust.
    INCH_10 = "10-inch"  # A development kit: 2.1 kg.
    INCH_20 = "20-inch"  # An industrial drone: 6.3 kg.


def _path(text: str) -> str:
    if ":" not in text:
        raise ValueError("'package.module:Class'")
    return text


Offset = Annotated[float, Field(ge=-2, le=2)]


class WindConfig(Config):
    """The wind, which acts on a flown drone that has a `drag_area`."""

    speed: Annotated[Variation, AfterValidator(within(0.0, 60.0))] = 0.0
    """Flown drone with `drag_area`: mean speed of the wind [m/s]."""
    direction: Annotated[Variation, AfterValidator(within(-6.3, 6.3))] = 0.0
    """Direction towards which it blows, counter-clockwise from east [rad]."""
    turbulence: Annotated[float, Field(ge=0, le=60)] = 0.0
    """Strength of gusts by Dryden's model: speed of the wind 6 m (20 ft) above the ground that
    makes them [m/s]; 7.7 is light, 15.4 moderate, 23 severe."""
    buildings: bool = False
    """Whether the mean wind goes round and over buildings; its speed is then that 10 m over open
    ground."""


class PayloadConfig(Config):
    """Payload of a flown drone, unknown to its controller."""

    mass: Annotated[float, Field(ge=0, le=20)] = 0.0
    """Flown drone: mass of a payload, unknown to its controller [kg]."""
    position: tuple[Offset, Offset, Offset] = (0.0, 0.0, -0.1)
    """Of its centre of mass: forward, left, up of the middle of the body [m]."""


class BatteryConfig(Config):
    """The battery of a flown drone."""

    enabled: bool = False
    """Flown drone: whether its battery sags and runs empty, which limits its thrust
    (docs/trackers.md)."""
    charge: Annotated[float, Field(gt=0, le=1)] = 1.0
    """Its charge at the start of an episode, of 1."""


class TrackerConfig(Config):
    """Kind of the tracker, and how it follows its commands."""

    kind: Annotated[TrackerKind | Annotated[str, AfterValidator(_path)], NAMES_CODE] = (
        TrackerKind.DRONE
    )
    """Kind of the tracker, or a class of your own, `package.module:Class`; see
    docs/trackers.md."""
    supervised: bool = True
    """True: the drone follows its commands exactly; False: a flight controller flies it, and it
    tilts."""
    airframe: AirframeName = AirframeName.M100
    """Body, rotors and controller of a flown drone; all but the original's have motors that need
    time, and drag."""
    flight: Flight = Flight.MENDED
    """What a flown drone does where a rotor or its gimbal is at a limit: `mended`, rotors keep
    the torque, and the gimbal looks past straight down; `original`: as in the original's code
    (docs/trackers.md). A file of the original means `original`."""
    off_centre: bool = False
    """Whether gimbal and lidar pull the centre of mass of a flown drone out of its middle, as in
    the original, whose files mean `true`."""
    judged: bool | None = None
    """Whether its view is rewarded, and limits of its body end the episode; if not, the reward is
    1. None: a drone's are, a car's not, as in the original."""
    inertial_time_constant: Annotated[float, Field(ge=0, le=10)] = 0.1
    """Time constant of the two low-passes through which accelerometer and gyroscope read the motion
    [s]; 0: the differences of 2 ms, which reach thousands of m/s^2. A flown drone's read the motion
    itself."""
    motor_time_constant: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Flown drone: time constant with which rotors change their speed [s]; `0`: the airframe's
    own, which of `m100` is at once, as in the original."""
    drag_area: Annotated[float, Field(ge=0, le=10)] = 0.0
    """Flown drone: drag coefficient times area, for the drag of the air [m²]; `0`: the airframe's
    own, of `m100` none, as in the original."""
    ground_contact: bool = False
    """Whether a flown drone lands on the ground; otherwise it passes through."""
    ground_effect: bool = False
    """Whether the rotors of a flown drone push more near the ground."""
    tells_rotors: bool = False
    """Flown drone: whether environments (`info["rotor_command"]`) and the writer `sensors` tell
    which rates it asks of its rotors [rad/s]."""
    payload: PayloadConfig = PayloadConfig()
    battery: BatteryConfig = BatteryConfig()
    wind: WindConfig = WindConfig()

    @property
    def original_name(self) -> str:
        """The original's name of such a tracker, in names of folders and files."""
        return "CAR" if self.kind is TrackerKind.CAR else "DRONE"

    @property
    def has_drag(self) -> bool:
        """Whether the air acts on a flown drone."""
        return self.drag_area > 0.0 or self.airframe is not AirframeName.M100

    @model_validator(mode="after")
    def _only_where_it_acts(self) -> Self:
        wind = self.wind
        calm = bounds(wind.speed) == (0.0, 0.0) and wind.turbulence == 0.0 and not wind.buildings
        if self.off_centre and self.airframe is not AirframeName.M100:
            raise ValueError("off_centre must be off unless the airframe is the original's, m100")
        if not calm and not self.has_drag:
            raise ValueError("drag_area must be above 0 with wind, which acts through drag only")
        given = {
            "motor_time_constant": self.motor_time_constant,
            "drag_area": self.drag_area,
            "ground_contact": self.ground_contact,
            "ground_effect": self.ground_effect,
            "airframe": self.airframe is not AirframeName.M100,
            "tells_rotors": self.tells_rotors,
            "wind.buildings": self.wind.buildings,
            "payload.mass": self.payload.mass,
            "battery.enabled": self.battery.enabled,
        }
        flown = self.kind is TrackerKind.DRONE and not self.supervised
        used = next((name for name, value in given.items() if value), None)
        if used and not flown and isinstance(self.kind, TrackerKind):
            raise ValueError(f"{used} must be off unless the drone is flown (supervised: false)")
        return self
