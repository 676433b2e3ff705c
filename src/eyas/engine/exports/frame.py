"""A frame: all data that writers get about one picture of one tracker."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.optics.lens import BROWN, NO_LENS, Lens, camera_matrix, coefficients
from eyas.engine.exports.movement import (
    Movement,
    SectionBox,
    box_corners,
    posed_corners,
    section_boxes,
)
from eyas.engine.state.draw import MovingParts
from eyas.engine.state.motion import ActorView
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.kind import Section
from eyas.engine.task.direction import TargetDirection
from eyas.engine.task.done import DoneReason

Floats: TypeAlias = NDArray[np.float64]

Output = Literal[
    "rgb",
    "depth",
    "object_id",
    "class_id",
    "normal",
    "others",
    "words",
    "parts",
    "clean",
    "cameras",
    "events",
    "traffic",
]
"""Name of a field of `Frame`, or of its target, that costs time: a picture, the other moving
objects, the target in words, moving parts, pictures of other cameras, events, or all actors.
"""

OUTPUTS: tuple[Output, ...] = get_args(Output)  # All these names


@dataclass(frozen=True, slots=True)
class RecordedAction:
    """The action of a tracker."""

    number: int  # Number of the action if it is one of several, 0 to 5 for a random one; else -1
    command: Floats | None
    """Forward [m/s], left [m/s], up [m per 2 ms], yaw rate [rad/s], shape (4,); None when the
    target is followed exactly."""
    gimbal_rates: Floats | None = None
    """Rates of the camera's pitch, positive down, and yaw, to the left [rad/s], shape (2,); None
    where no policy turns it."""


@dataclass(frozen=True, slots=True)
class RecordedBody:
    """The body of a tracker. World frame, east-north-up, unless it says otherwise."""

    position: Floats  # Centre [m], shape (3,)
    velocity: Floats  # [m/s], shape (3,)
    acceleration: Floats  # [m/s^2], shape (3,)
    orientation: Floats  # Body to world, quaternion w, x, y, z, shape (4,)
    angular_velocity: Floats  # Body frame [rad/s], shape (3,)
    gimbal: Floats  # Roll, pitch, yaw of the gimbal's joints [rad], shape (3,)


@dataclass(frozen=True, slots=True)
class CameraPose:
    """Position, orientation and lens of the camera."""

    position: Floats  # Optical centre, world frame [m], shape (3,)
    rotation: Floats
    """Camera to world; columns are the camera's forward, left and up axes, shape (3, 3)."""
    field_of_view: float  # Horizontal [rad]
    width: int  # Width of the picture [pixels]
    height: int  # Height of the picture [pixels]
    lens: Lens = NO_LENS
    """The lens that bends the picture. With one, the field of view is that of a pinhole with the
    same focal length."""

    @property
    def intrinsics(self) -> Floats:
        """Camera matrix, see `Episode.intrinsics`."""
        return camera_matrix(self.lens, self.width, self.height, self.field_of_view)

    @property
    def distortion(self) -> list[float]:
        """OpenCV's coefficients of the lens: k1, k2, p1, p2, k3, or a fisheye's k1 to k4."""
        return coefficients(self.lens)

    @property
    def distortion_model(self) -> str:
        """Model of the coefficients: `brown` or `fisheye`; empty for a pinhole."""
        if self.lens.model == BROWN:
            return "brown" if any(self.distortion) else ""
        return "fisheye"


@dataclass(frozen=True, slots=True)
class CameraPicture:
    """A picture of a camera that a tracker has beside its own."""

    name: str  # Name in the setting `cameras`
    pose: CameraPose
    rgb: NDArray[np.uint8]  # Colours, shape (H, W, 3)


@dataclass(frozen=True, slots=True)
class Subject:
    """A moving or parked object and its place in the picture. World frame, east-north-up."""

    object_id: int  # Value in `Frame.object_id`; the same in all frames of an episode
    type: str  # Name of its model
    object_class: ObjectClass  # The number in `Frame.class_id`
    size: Floats  # Length, width, height [m], shape (3,)
    position: Floats  # Reference point on the road [m], shape (3,)
    centre: Floats  # Middle of its visible body, the point that is rewarded [m], shape (3,)
    velocity: Floats  # [m/s], shape (3,)
    yaw: float  # Heading, counter-clockwise from east [rad]
    motion: Movement
    box: NDArray[np.int32]
    """Extent in the picture, hidden parts included, clipped to the picture: left, top, right,
    bottom [pixels], the last two exclusive; all 0 outside the picture; shape (4,)."""
    visible_box: NDArray[np.int32]
    """Extent of the pixels that show it, as above; all 0 if none does; shape (4,)."""
    whole_box: Floats
    """Extent of all its vertices, not clipped to the picture: left, top, right, bottom [pixels].
    Those nearer to the camera than 8 cm along the optical axis, or behind it, are left out; all 0
    if all are, or if no writer wants `others`; shape (4,)."""
    seen_pixels: int  # Pixels that show it
    covered_pixels: int  # Pixels that would show it if nothing hid it; 0 outside the picture
    words: str = ""
    """Description of its looks, "a red car". The target's words are shared by nothing else in view;
    empty if no writer wants `words`."""
    sections: tuple[Section, ...] = ()
    """The sections of an articulated vehicle; empty for all others."""
    lamps: int = 0  # Lit lamps, a `Lamp`; 0: none, or lamps do not work
    parked: bool = False  # Whether it is part of the scene and never moves

    @property
    def visible_fraction(self) -> float:
        """Visible share of its pixels, 0 to 1; 0 outside the picture."""
        return self.seen_pixels / self.covered_pixels if self.covered_pixels else 0.0

    def truncated(self, camera: CameraPose) -> float:
        """Return the share of its whole box that is outside the picture, 0 to 1; 1 if it has
        none.
        """
        left, top, right, bottom = self.whole_box.tolist()
        whole = (right - left) * (bottom - top)
        across = min(right, camera.width) - max(left, 0.0)
        down = min(bottom, camera.height) - max(top, 0.0)
        inside = max(across, 0.0) * max(down, 0.0)
        return 1.0 - inside / whole if whole > 0.0 else 1.0

    @property
    def corners(self) -> Floats:
        """Corners of its 3D box, see `box_corners`."""
        return box_corners(self.centre, self.size, self.yaw, self.motion, self.sections)

    @property
    def posed_corners(self) -> Floats | None:
        """Corners of the box around its limbs at this moment, see `posed_corners`."""
        return posed_corners(self.centre, self.yaw, self.motion)

    @property
    def section_boxes(self) -> tuple[SectionBox, ...]:
        """The 3D boxes of its sections."""
        return section_boxes(self.sections, self.centre, self.yaw, self.motion)


@dataclass(frozen=True, slots=True)
class Frame:
    """One picture of one tracker with all its data. Numbers are not rounded.

    Its arrays are never changed, so writers may keep them. If pictures are late, time and state are
    those that the picture shows; action, reward and end are those of the present.
    """

    number: int
    """Number in its episode, from 0."""
    time: float
    """Simulated time since the start of the run [s]."""
    step: int
    """Steps of 2 ms since the reset."""
    tracker: RecordedBody
    camera: CameraPose
    target: Subject
    """The target of the tracker."""
    others: tuple[Subject, ...]
    """All other moving objects, and parked ones, of which a pixel is visible, in the order of their
    ids; empty if no writer wants them."""
    action: RecordedAction
    reward: float
    """Present reward."""
    direction: TargetDirection
    """The turn of the target."""
    reason: DoneReason
    """Why the episode ends with this frame; `NONE` if it does not."""
    rgb: NDArray[np.uint8] | None
    """sRGB, row 0 on top, shape (H, W, 3). This and the next three: None if no writer wants it."""
    depth: NDArray[np.float32] | None
    """Distance along the optical axis [m], infinity for the sky, shape (H, W)."""
    object_id: NDArray[np.int32] | None
    """Object of each pixel, `SKY_OBJECT` for the sky, shape (H, W)."""
    class_id: NDArray[np.uint8] | None
    """`ObjectClass` of each pixel's object, shape (H, W)."""
    normal: NDArray[np.uint8] | None = None
    """Surface normal of each pixel, see `Picture.normal`, shape (H, W, 3); None if no writer wants
    it."""
    lidar: Floats | None = None
    """Distances that the lidar has measured [m], infinity where nothing was within range, shape
    (points,); None: there is no lidar."""
    parts: MovingParts | None = None
    """The moving part that each pixel shows; None if no writer wants it."""
    clean: NDArray[np.uint8] | None = None
    """The colours as they would be without noise, blur, dirt and the like: the same instant, pose
    and lens, shape (H, W, 3); None if no writer wants them."""
    cameras: tuple[CameraPicture, ...] = ()
    """Pictures of the tracker's further cameras, in the order of the setting `cameras`; empty if no
    writer wants them."""
    sensors: Floats | None = None
    """Readings of GPS, accelerometer, gyroscope and IMU, with their errors, see
    `eyas.engine.task.packets.BASIC_FIELDS`, shape (19,); None: it is not known."""
    signals: Mapping[str, Floats] = field(default_factory=dict)
    """Readings of further sensors (`sensors.further`), with their errors, by the names of
    `Sensor.parts`, each of shape (width,)."""
    rotors: Floats | None = None
    """Rates that the tracker asks of its rotors, front right, front left, rear left, rear right
    [rad/s], shape (4,); None: it does not tell."""
    exposure: tuple[float, float] | None = None
    """Exposure time [s] and speed (ISO 12232) of the picture; None: its sensor is not modelled."""
    events: NDArray[np.void] | None = None
    """Events of the event camera since the last frame, in the order of time, of dtype
    `eyas.engine.camera.esim.EVENT`; times count from the reset. None if no writer wants
    it."""
    traffic: ActorView | None = None
    """All actors of the tracker's world, seen or not, at the instant that the picture shows; None
    if no writer wants it."""

    @property
    def episode_time(self) -> float:
        """Simulated time since the reset [s]."""
        return self.step * PHYSICS_STEP
