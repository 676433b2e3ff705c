"""Settings of recordings."""

from typing import Annotated

from pydantic import AfterValidator, Field

from eyas.core.code_names import NAMES_CODE
from eyas.envs.config import ActionSpeeds

__all__ = ["VideoConfig"]


def _some(names: tuple[str, ...]) -> tuple[str, ...]:
    if not names:
        raise ValueError("a list with at least one writer name")
    return names


class VideoConfig(ActionSpeeds):
    """Settings of recordings; the speeds are those of random actions."""

    channels: Annotated[int, Field(ge=1, le=1024)] = 4
    """Number of trackers that record together in one world."""
    fps: Annotated[float, Field(gt=0, le=500)] = 25.0
    """Pictures per second of simulated time [Hz]."""
    start_time: Annotated[float, Field(ge=0, le=1e6)] = 1.0
    """Simulated time at which recording begins [s]."""
    total_time: Annotated[float, Field(gt=0, le=1e6)] = 12.0
    """Duration of the recording in simulated time [s]."""
    warm_up_steps: Annotated[int, Field(ge=0, le=5_000_000)] = 30
    """Steps of 2 ms after each reset that are not recorded."""
    target_direction: bool = False
    """Whether `mark.json` holds the target's direction instead of reward and action."""
    overlay: bool = False
    """Whether the pictures show the overlay: the ground that the camera sees, the area in which the
    target is rewarded, and a marker over the target; labels stay the same."""
    random_action: bool = False
    """True: seeded random actions; False: the target is followed exactly."""
    writers: Annotated[tuple[str, ...], AfterValidator(_some), NAMES_CODE] = (
        *("jpeg", "mp4", "labels", "mark"),
    )
    """Output formats: `jpeg`, `png`, `mp4`, `labels`, `mark`, `masks`, `classes`, `depth`,
    `arrays`, `flow`, `sensors`, `lidar`, or your own as `my_package.module:Class`."""
    jpeg_quality: Annotated[int, Field(ge=1, le=100)] = 95
    """Quality of the JPEG pictures; one of 320 x 240 takes some 36 kB at 95, and 93 kB at 100,
    which an `env_config.json` means."""
    depth_unit: Annotated[float, Field(ge=1e-4, le=10.0)] = 0.01
    """Unit of the numbers in `depth/NNNNNN.png` [m]; the largest is 65535."""
