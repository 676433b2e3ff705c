"""Settings of recordings."""

from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.core.named_code import NAMES_CODE
from eyas.engine.settings.env import ActionSpeeds

Metres = Annotated[float, Field(ge=-1e5, le=1e5)]
Turn = Annotated[float, Field(ge=-7, le=7)]
ShareAsked = Annotated[float, Field(ge=0, le=1)] | None


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
    total_time: Annotated[float, Field(gt=0, le=1e6)] = 6.0
    """Duration of the recording in simulated time [s], unless `episode_frames` is set."""
    warm_up_steps: Annotated[int, Field(ge=0, le=5_000_000)] = 30
    """Steps of 2 ms after each reset that are not recorded."""
    target_direction: bool = False
    """Whether `mark.json` holds the target's direction instead of reward and action."""
    overlay: bool = False
    """Whether the pictures show the overlay: the ground that the camera sees, the area in which the
    target is rewarded, and a marker over the target; labels stay the same."""
    flight: Annotated[str | None, NAMES_CODE] = None
    """Flight of the trackers. `exact`: they keep their place relative to the target, so that its
    box never moves; `random`: seeded random actions; a camera path, which is planned around each
    target: `follow`, `orbit`, `fly-by`, `rise`, `zoom`, `hover-and-pan`, `search`, or your own as
    `my_package.module:Class`; or a file with the flight of a real drone, in the forms of
    `custom.trajectory`. None: `follow`, or `exact` where no camera path can be flown, with
    live traffic and trackers that are not drones."""
    flight_at: tuple[Metres, Metres, Turn] | None = None
    """Where the first point of a flight from a file is put, x and y [m], and the angle by which it
    is turned about it [rad]; None: where the file says."""
    policy: Annotated[Annotated[str, Field(min_length=1)] | None, NAMES_CODE] = None
    """A policy that flies instead, as in `eyas evaluate --policy`; excludes `flight`."""
    in_view: ShareAsked = None
    """Camera paths: asked share of frames with the target in the picture, hidden or not; None: all,
    of `search` 0.7."""
    hidden: ShareAsked = None
    """Camera paths: asked share of frames in which half of the target or more is hidden; None: as
    few as may be."""
    cut: ShareAsked = None
    """Camera paths: asked share of frames in which the border of the picture cuts the target; None:
    as it comes."""
    small: ShareAsked = None
    """Camera paths: asked share of frames in which the target's box has fewer than 32 x 32 pixels;
    None: as it comes."""
    episode_frames: Annotated[int, Field(ge=1, le=1_000_000)] | None = None
    """Frames of each episode. The recording then has `episodes` of them for each tracker, and
    `total_time` and `done.total_steps` say nothing. None: episodes end by `done.total_steps`, and
    the recording after `total_time`."""
    episodes: Annotated[int, Field(ge=1, le=1_000_000)] = 1
    """Episodes of each tracker, if `episode_frames` is set."""
    writers: Annotated[tuple[str, ...], AfterValidator(_some), NAMES_CODE] = (
        "jpeg",
        "mp4",
        "labels",
        "mark",
    )
    """Output formats; where the extra `video` is not installed, the default has `webp` instead of
    `mp4`. `jpeg`, `mp4`, `webp`, `labels`, `mark`, `png`, `clean`, `cameras`, `masks`, `classes`,
    `depth`, `normals`, `arrays`, `flow`, `sensors`, `lidar`, `events`, `scene`, `openscenario`,
    `rosbag`, `rosbag-mcap`, or your own as `my_package.module:Class`; see docs/writers.md."""
    jpeg_quality: Annotated[int, Field(ge=1, le=100)] = 95
    """Quality of the JPEG pictures; one of 320 x 240 takes some 36 kB at 95, and 93 kB at 100,
    which an `env_config.json` means."""
    depth_unit: Annotated[float, Field(ge=1e-4, le=10.0)] = 0.01
    """Unit of the numbers in `depth/NNNNNN.png` [m]; the largest is 65535."""

    @model_validator(mode="after")
    def _one_pilot(self) -> Self:
        if self.flight is not None and self.policy is not None:
            raise ValueError(
                f"policy '{self.policy}' and flight '{self.flight}' exclude each other: set one "
                "of them to null"
            )
        return self
