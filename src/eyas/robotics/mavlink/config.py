"""Settings of vehicles that speak MAVLink."""

from typing import Annotated

from pydantic import Field

from eyas.engine.core.allowed import TextForm
from eyas.engine.core.config import Config
from eyas.engine.settings.section import Section


class HilConfig(Config):
    """Settings of `eyas serve --px4` and `--ardupilot`; also used: `mavlink.latitude`,
    `longitude`, `altitude`, `video`, `picture_rate` and `video_quality`.
    """

    thrust_to_weight: Annotated[float, Field(gt=1.0, le=20.0)] = 2.0
    """With `--px4` or `--ardupilot`: thrust of all rotors at full output over the drone's
    weight."""
    speed: Annotated[float, Field(ge=0.0, le=100.0)] = 1.0
    """Most simulated seconds in a second; 0: as many as autopilot and machine can."""


class MavlinkConfig(Section):
    """Settings of `eyas serve --mavlink`."""

    section = "mavlink"

    vehicles: Annotated[int, Field(ge=1, le=64)] = 1
    """Number of vehicles, in one world."""
    first_system: Annotated[int, Field(ge=1, le=190)] = 1
    """System id of the first vehicle; those of the others follow."""
    latitude: Annotated[float, Field(ge=-80, le=80)] = 47.397742
    """Latitude of the origin of the world [degrees]."""
    longitude: Annotated[float, Field(ge=-180, le=180)] = 8.545594
    """Longitude of the origin of the world [degrees]."""
    altitude: Annotated[float, Field(ge=-500, le=9000)] = 488.0
    """Height of the origin of the world above mean sea level [m]."""
    lockstep: bool = False
    """Whether time stands still until each vehicle in offboard mode has got another set point."""
    video: Annotated[str, Field(pattern=r"^(\S+:\d{1,5})?$"), TextForm("HOST:PORT, or empty")] = ""
    """Address `HOST:PORT` to which the first vehicle sends its pictures, as H.264 in RTP; each
    further vehicle takes a port that is higher by 2. Empty: no pictures are sent."""
    picture_rate: Annotated[float, Field(gt=0, le=100)] = 30.0
    """Pictures per second [Hz], and how often a camera measures the target that it tracks."""
    video_quality: Annotated[int, Field(ge=0, le=51)] = 28
    """Constant rate factor of H.264: higher is smaller and blurrier."""
    hil: HilConfig = HilConfig()
