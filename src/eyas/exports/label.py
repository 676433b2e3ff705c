"""The label of a frame: what `labels.jsonl` tells of it."""

from dataclasses import dataclass, field

from eyas.core.frames import rotate_back
from eyas.exports.frame import Frame, Subject
from eyas.exports.rounding import rounded, rounded_list
from eyas.exports.writer import Episode
from eyas.lanes import interpreted
from eyas.task.done import DoneReason

__all__ = ["FrameLabel", "OtherLabel", "SectionLabel", "label_of"]

_rotate_back = interpreted(rotate_back)


@dataclass(frozen=True, slots=True)
class SectionLabel:
    """A section of an articulated vehicle, with a 3D box of its own."""

    name: str
    """"truck" or "trailer"."""
    size: list[float | None]
    """Length, width, height [m]."""
    yaw: float | None
    """Heading, counter-clockwise from east [rad]."""
    corners: list[list[float | None]]
    """The corners of its 3D box, as in `FrameLabel.target_corners` [m]."""


@dataclass(frozen=True, slots=True)
class OtherLabel:
    """A moving object that is not the target; its fields are like those of the target."""

    id: int
    type: str
    class_id: int
    """`eyas.state.scene.ObjectClass`, as in the class pictures."""
    box: list[int]
    visible_fraction: float
    size: list[float | None]
    centre: list[float | None]
    velocity: list[float | None]
    yaw: float | None
    acceleration: list[float | None] = field(default_factory=list)
    yaw_rate: float | None = None
    travelled: float | None = None
    direction: int = 0
    corners: list[list[float | None]] = field(default_factory=list)
    """The corners of its 3D box, which has its `size` [m]."""
    words: str = ""
    """What it looks like, such as "a red car"; others may look the same."""
    sections: list[SectionLabel] = field(default_factory=list)
    posed_corners: list[list[float | None]] = field(default_factory=list)
    """As `FrameLabel.target_posed_corners` [m]."""


@dataclass(frozen=True, slots=True)
class FrameLabel:
    """The label of one frame. World frame, east-north-up; numbers that are not finite are None."""

    frame: int
    """Number of the frame in its episode, from 0; its picture is `NNNNNN.jpeg`."""
    time: float
    """Simulated time since the start of the run [s]."""
    step: int
    """Steps of 2 ms since the reset."""
    episode_time: float
    """Simulated time since the reset [s]."""
    target_box: list[int]
    """Extent of the target in the picture, hidden parts included, clipped to the picture: left,
    top, right, bottom [pixels], the last two exclusive; all 0 outside the picture."""
    visible_fraction: float
    """Visible pixels of the target over those that it would cover if nothing hid it, 0 to 1."""
    occluded: bool
    """Whether a part of the target inside the picture is hidden."""
    in_view: bool
    """Whether a part of the target, visible or hidden, is inside the picture."""
    tracker_position: list[float | None]
    """[m]"""
    tracker_velocity: list[float | None]
    """[m/s]"""
    tracker_orientation: list[float | None]
    """Body to world, quaternion w, x, y, z."""
    camera_position: list[float | None]
    """Optical centre [m]."""
    camera_rotation: list[list[float | None]]
    """Camera to world, three rows; columns are the camera's forward, left and up axes."""
    field_of_view: float | None
    """Horizontal field of view of the camera [rad]."""
    target_id: int
    """Number of the target in the id pictures; the same in all frames of an episode."""
    target_type: str
    """Name of the target's model."""
    target_size: list[float | None]
    """Length, width, height [m]."""
    target_position: list[float | None]
    """Reference point of the target on the road [m]."""
    target_centre: list[float | None]
    """Middle of the target's visible body, the point that is rewarded [m]."""
    target_velocity: list[float | None]
    """[m/s]"""
    target_yaw: float | None
    """Heading, counter-clockwise from east [rad]."""
    relative_position: list[float | None]
    """`target_centre` in the tracker's body frame: forward, left, up [m]."""
    reward: float | None
    """Reward at this time."""
    action: int
    """Number of the random action, 0 to 5; -1 when the target is followed exactly."""
    direction: int
    """Turn of the target: 0 stop, 1 straight, 2 left, 3 right."""
    done: bool
    """Whether the episode ends with this frame."""
    others: list[OtherLabel]
    """All other moving objects of which a pixel is visible, in the order of their ids."""
    target_acceleration: list[float | None] = field(default_factory=list)
    """[m/s^2]. This and the next are missing in older labels."""
    target_yaw_rate: float | None = None
    """Counter-clockwise [rad/s]."""
    target_travelled: float | None = None
    """Way since it entered the world [m]."""
    target_corners: list[list[float | None]] = field(default_factory=list)
    """Corners of its 3D box: four on the ground, counter-clockwise from the right of its tail, and
    those above them [m]. It contains the whole of a truck whose trailer swings, so it is then wider
    than `target_size`."""
    target_words: str = ""
    """The target in words, such as "a red SUV" or "a red SUV, turning left": nothing else in view
    shares them."""
    target_sections: list[SectionLabel] = field(default_factory=list)
    """A truck and its trailer; the file has the key for articulated vehicles only."""
    target_posed_corners: list[list[float | None]] = field(default_factory=list)
    """Corners of the box around the limbs of a person or robot at this moment, in the same order:
    arms and legs swing out of the box of `target_size` [m]; the file has the key for these only."""
    target_class_id: int = -1
    """`eyas.state.scene.ObjectClass` of the target, as in the class pictures. This and the next are
    missing in older labels."""
    width: int = 0
    """Width of the picture [pixels]."""
    height: int = 0
    """Height of the picture [pixels]."""
    intrinsics: list[list[float | None]] = field(default_factory=list)
    """Camera matrix, three rows: x right, y down, z forward, the centre of pixel (0, 0) at
    (0.5, 0.5) [pixels]."""


def label_of(frame: Frame, episode: Episode) -> FrameLabel:
    """Return the label of a frame of an episode."""
    tracker, camera, target = frame.tracker, frame.camera, frame.target
    offset = target.centre - tracker.position
    return FrameLabel(
        frame=frame.number,
        time=round(frame.time, 6),
        step=frame.step,
        episode_time=round(frame.episode_time, 6),
        target_box=target.box.tolist(),
        visible_fraction=round(target.visible_fraction, 6),
        occluded=target.seen_pixels < target.covered_pixels,
        in_view=target.covered_pixels > 0,
        tracker_position=rounded_list(tracker.position),
        tracker_velocity=rounded_list(tracker.velocity),
        tracker_orientation=rounded_list(tracker.orientation),
        camera_position=rounded_list(camera.position),
        camera_rotation=[rounded_list(row) for row in camera.rotation],
        field_of_view=rounded(camera.field_of_view),
        target_id=target.object_id,
        target_type=target.type,
        target_size=rounded_list(target.size),
        target_position=rounded_list(target.position),
        target_centre=rounded_list(target.centre),
        target_velocity=rounded_list(target.velocity),
        target_yaw=rounded(target.yaw),
        relative_position=rounded_list(_rotate_back(tracker.orientation, *offset)),
        reward=rounded(frame.reward),
        action=frame.action.number,
        direction=int(frame.direction),
        done=frame.reason is not DoneReason.NONE,
        others=[_other(subject) for subject in frame.others],
        target_acceleration=rounded_list(target.motion.acceleration),
        target_yaw_rate=rounded(target.motion.yaw_rate),
        target_travelled=rounded(target.motion.travelled),
        target_corners=[rounded_list(corner) for corner in target.corners],
        target_words=frame.target_words,
        target_sections=_sections(frame.target),
        target_posed_corners=_posed(frame.target),
        target_class_id=int(target.object_class),
        width=episode.width,
        height=episode.height,
        intrinsics=[rounded_list(row) for row in episode.intrinsics],
    )


def _other(subject: Subject) -> OtherLabel:
    return OtherLabel(
        id=subject.object_id,
        type=subject.type,
        class_id=int(subject.object_class),
        box=subject.box.tolist(),
        visible_fraction=round(subject.visible_fraction, 6),
        size=rounded_list(subject.size),
        centre=rounded_list(subject.centre),
        velocity=rounded_list(subject.velocity),
        yaw=rounded(subject.yaw),
        acceleration=rounded_list(subject.motion.acceleration),
        yaw_rate=rounded(subject.motion.yaw_rate),
        travelled=rounded(subject.motion.travelled),
        direction=int(subject.motion.direction),
        corners=[rounded_list(corner) for corner in subject.corners],
        words=subject.words,
        sections=_sections(subject),
        posed_corners=_posed(subject),
    )


def _posed(subject: Subject) -> list[list[float | None]]:
    corners = subject.posed_corners
    return [] if corners is None else [rounded_list(corner) for corner in corners]


def _sections(subject: Subject) -> list[SectionLabel]:
    return [
        SectionLabel(
            name=box.name,
            size=[rounded(side) for side in box.size],
            yaw=rounded(box.yaw),
            corners=[rounded_list(corner) for corner in box.corners],
        )
        for box in subject.section_boxes
    ]
